"""The numbers on the page, and the same run as a command line and as Python."""

import math

from laticauda.cockpit.live import Live


def figures_text(live: Live) -> str:
    """The figures of the run since the setting was last changed, beside what was measured, as Markdown."""
    now, world = live.numbers(), live.world
    if world.failure is not None:
        return f"**{world.failure}** Change something, or reset."
    measured = live.setting.measured()
    kind = "electrical" if "electrical_work" in live.latest() else "mechanical"
    rows = [
        ("forward velocity (5)", _number(now.forward_velocity, "m/s", 3)),
        ("over the last gait cycle", _number(now.cycle_velocity, "m/s", 3)),
        (f"mean power, {kind}", _number(now.mean_power, "W", 1)),
        ("cost of transport", _number(now.cost_of_transport, "", 2)),
        ("cross-track error", _number(now.cross_track_error, "m", 3)),
        ("heading", _number(math.degrees(now.heading), "deg", 1)),
    ]
    lines = [f"| since the last change | {now.time:.1f} s |", "|:--|--:|"]
    lines += [f"| {name} | **{value}** |" for name, value in rows]
    if measured is not None:
        speed = "not available" if measured.forward_velocity is None else f"{measured.forward_velocity:.3f} m/s"
        power = "not available" if measured.mean_power is None else f"{measured.mean_power:.1f} W"
        lines += [
            f"| measured in {measured.source} | {speed} |",
            f"| in {measured.duration:g} s from rest, electrical | {power} |",
        ]
    return "\n".join(lines)


def _number(value: float, unit: str, digits: int) -> str:
    return "–" if not math.isfinite(value) else f"{round(value, digits) + 0.0:.{digits}f} {unit}".strip()  # noqa: RUF001
