"""Numbers and plots of a run."""

import math
from typing import Any

import numpy as np

from laticauda.show.cockpit.live import Live, read_tilt
from laticauda.show.cockpit.pages import time_scale
from laticauda.show.cockpit.simulation import TICK, find_measured
from laticauda.show.reports.chapter import in_digits
from laticauda.trials import metrics
from laticauda.trials.feasibility import judge_feasibility

STEP = 4  # every STEP-th sample is drawn
COLORS = ("#56B4E9", "#E69F00", "#8ADB9B")
PLOTS = {
    "Speed [m/s]": {
        "speed": "speed",
    },
    "Power [W]": {
        "power": "power",
    },
    "Cross-track error [m]": {
        "cross_track_error": "error",
    },
    "Heading [deg]": {
        "heading": "heading",
    },
    "Depth [m], in space": {
        "depth": "depth",
    },
    "Pitch and roll [deg], in space": {
        "pitch": "pitch",
        "roll": "roll",
    },
    "Joint angles [deg]": {
        "joint_tail": "tail",
        "joint_middle": "middle",
        "joint_head": "head",
    },
}
"""Lines of each plot, by its title with unit: column of `Live.plots` and name."""
HEIGHT = 165  # [px]
FIGURES = ("forward_velocity", "cycle_velocity", "mean_power", "cost_of_transport")
RECENT = 800  # latest samples, over which joints and actuators are checked


def read_figures(live: Live) -> dict[str, Any]:
    """Return the figures of a `live` run since the scenario was last changed, by name; nan if not yet available.

    The elapsed `time` [s], the forward velocity (5), that over the last gait cycle [m/s], the mean
    power, electrical with servos or a power model [W], the resulting cost of transport [-],
    cross-track error [m], heading [rad], and `joints`: recent demands on the joints and their
    actuators, and why the robot cannot meet them, if so.

    Args:
        live: The run.
    """
    record, now = live.record()
    time, place, scenario, robot = record.time, record.center_of_mass, now.scenario, now.plant.robot
    elapsed, found = (
        float(time[-1] - time[0]),
        dict[str, Any](dict.fromkeys(FIGURES, math.nan), joints="-"),
    )
    if elapsed > 0.0:
        velocity = metrics.forward_velocity(time, place)
        work = record.work[:, 0] if record.electrical_work is None else record.electrical_work
        power = metrics.mean_power(time, work)
        found |= {"forward_velocity": velocity, "mean_power": power}
        if velocity > 1e-6:
            weight = metrics.carried_weight(robot, scenario.environment)
            found["cost_of_transport"] = metrics.cost_of_transport(power, weight, velocity)
        cycle = (
            2.0 * math.pi / scenario.gait.frequency if scenario.gait.frequency > 0.0 else math.inf
        )
        if TICK <= cycle < elapsed:
            n = round(cycle / TICK)
            found["cycle_velocity"] = float(
                np.linalg.norm(place[-1] - place[-1 - n]) / (time[-1] - time[-1 - n])
            )
        lately = judge_feasibility(
            robot, record.at(slice(-RECENT, None)), cycle if math.isfinite(cycle) else None
        )
        found["joints"] = (
            f"cannot: {'; '.join(lately.problems)}" if lately.problems else lately.words
        )
    heading = float(live.latest().heading)
    return {
        "time": elapsed,
        "cross_track_error": now.cross_track_error,
        "heading": heading,
        **found,
    }


def numbers_text(live: Live) -> str:
    """Return the figures next to those of the paper, as Markdown."""
    failure = live.simulation.failure
    if failure is not None:
        return f"**{failure}** Change a setting, or reset."
    now, tank = read_figures(live), find_measured(live.scenario)
    kind = "mechanical" if live.latest().electrical_work is None else "electrical"
    rows = [
        ("forward velocity (5)", _number(now["forward_velocity"], "m/s", 3)),
        ("over the last gait cycle", _number(now["cycle_velocity"], "m/s", 3)),
        (f"mean power, {kind}", _number(now["mean_power"], "W", 1)),
        ("cost of transport", _number(now["cost_of_transport"], "", 2)),
        ("cross-track error", _number(now["cross_track_error"], "m", 3)),
        ("heading", _number(math.degrees(now["heading"]), "deg", 1)),
    ]
    for name, value in read_tilt(live.latest()).items():
        if math.isfinite(value):
            rows.append(
                (
                    name,
                    _number(value, "m" if name == "depth" else "deg", 2 if name == "depth" else 1),
                )
            )
    lines = [f"| since the last change | {now['time']:.1f} s |", "|:--|--:|"]
    lines += [f"| {name} | **{value}** |" for name, value in rows]
    lines += [f"| joints | {now['joints']} |"]
    if tank is not None:
        speed = (
            "not available" if tank.forward_velocity is None else f"{tank.forward_velocity:.3f} m/s"
        )
        power = "not available" if tank.mean_power is None else f"{tank.mean_power:.1f} W"
        lines += [
            f"| measured in the paper | {speed} |",
            f"| in 30 s from rest, electrical | {power} |",
        ]
    return "\n".join(lines)


def _number(value: float, unit: str, digits: int) -> str:
    return (
        f"{in_digits(value, f'.{digits}f')} {unit}".strip()
        if math.isfinite(value)
        else "\N{EN DASH}"
    )


class Plots:
    """All plots, over the simulated time in seconds.

    Args:
        gui: GUI of the page's server.
    """

    def __init__(self, gui: Any) -> None:
        axis = {"stroke": "#c8d2d8", "grid": {"stroke": "#3a4750", "width": 1}}
        self._handles: list[Any] = []
        for title, lines in PLOTS.items():
            series = [
                {"label": name, "stroke": color, "width": 1.5}
                for name, color in zip(lines.values(), COLORS)  # noqa: B905
            ]
            self._handles.append(
                gui.add_uplot(
                    (np.zeros(1),) * (1 + len(lines)),
                    ({"label": "time [s]"}, *series),
                    title=title,
                    scales=time_scale(),
                    axes=(axis, axis),
                    height=HEIGHT,
                )
            )

    def show(self, live: Live) -> None:
        """Draw the available data."""
        columns = live.plots(step=STEP)
        if not columns:
            return
        for handle, lines in zip(self._handles, PLOTS.values(), strict=True):
            handle.data = (columns["time"], *(columns[name] for name in lines))
