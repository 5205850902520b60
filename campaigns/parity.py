"""Do the closed form and MuJoCo with water agree, and how does the difference fall with the step?

Question: is the spatial model (planar root, no gravity) within 0.3 % of the distance at 0.5 ms, and
within 0.1 % after Richardson extrapolation, for every case and every drive? Path: largest distance
between the two paths over the distance traveled in 30 s, the best rotation about the start taken
out. The planar run has a quarter of the smallest step.

    python campaigns/parity.py [FIGURE]    run all, write parity.csv and print the worst of the cases; draw the figure

The tests run slices of it, in tests/models/spatial/test_parity.py and tests/models/spatial/test_fin.py, and the
paper's claim that both models agree is judged by its answer, in tests/paper/test_claims.py.

Last answer (2 shared cores, 2026-11-30), the worst of lateral, eel-like, turning, fin and current:
    prescribed  0.0500 s   path 5.8e-05   Richardson -         heading 4.9e-04 rad
    prescribed  0.0250 s   path 3.1e-06   Richardson 6.5e-07   heading 3.0e-05 rad
    prescribed  0.0125 s   path 1.8e-07   Richardson 1.8e-08   heading 1.8e-06 rad
    prescribed  0.0063 s   path 1.1e-08   Richardson 7.1e-09   heading 1.3e-07 rad
    prescribed  0.0031 s   path 6.8e-09   Richardson 6.9e-09   heading 4.3e-08 rad
    prescribed  0.0010 s   path 6.9e-09   Richardson -         heading 3.6e-08 rad
    prescribed  0.0005 s   path 6.9e-09   Richardson 6.9e-09   heading 3.6e-08 rad
    pd          0.0080 s   path 3.3e-06   Richardson -         heading 1.6e-06 rad
    pd          0.0040 s   path 7.0e-07   Richardson 3.3e-07   heading 3.8e-07 rad
    pd          0.0020 s   path 1.4e-07   Richardson 6.3e-08   heading 8.2e-08 rad
    pd          0.0010 s   path 2.7e-08   Richardson 1.0e-08   heading 1.6e-08 rad
    pd          0.0005 s   path 4.7e-09   Richardson 1.6e-09   heading 2.8e-09 rad
    servo       0.0080 s   path 5.4e-06   Richardson -         heading 9.5e-06 rad
    servo       0.0040 s   path 1.7e-06   Richardson 1.4e-06   heading 3.3e-06 rad
    servo       0.0020 s   path 2.1e-07   Richardson 2.6e-07   heading 7.2e-07 rad
    servo       0.0010 s   path 2.4e-08   Richardson 3.7e-08   heading 1.8e-07 rad
    servo       0.0005 s   path 1.1e-08   Richardson 1.1e-08   heading 3.3e-08 rad
"""

import csv
import math
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, fields, replace
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes

import laticauda as lc
from laticauda.scenarios import Scenario, model_of
from laticauda.show.figures import new_figure, save_figure, style

STORE = Path(__file__).with_suffix(".csv")
STEPS = {
    "prescribed": (0.05, 0.025, 0.0125, 0.00625, 0.003125, 0.001, 0.0005),
    "pd": (0.008, 0.004, 0.002, 0.001, 0.0005),
    "servo": (0.008, 0.004, 0.002, 0.001, 0.0005),
}
"""Of the spatial model, by the joints' drive [s]."""
ORDERS = {"prescribed": 4, "pd": 3, "servo": 3}
"""Of the spatial model's integrators in the step, by the joints' drive."""
SLOPES = {"prescribed": 4, "pd": 3}
"""Drawn; servo's would lie on that of pd."""
MARKERS = "osD"


@dataclass(frozen=True, kw_only=True)
class Parity:
    """How far apart the models are in one case at one step of the spatial one."""

    case: str
    """Which of `CASES`."""
    joints: str
    """prescribed, pd or servo."""
    dt: float
    """Step of the spatial model [s]."""
    path: float
    """Largest distance between the paths after the best rotation about the start, over the distance traveled [-]."""
    rotation: float
    """That rotation [rad]."""
    heading: float
    """Largest difference in heading [rad]."""
    richardson: float | None
    """As `path`, for the path extrapolated from this step and twice it; None if that was not run before [-]."""


def cases() -> dict[str, Scenario]:
    """Lateral undulation, eel-like motion, a turn, the fin, a current."""
    water = lc.load_water("paper-lateral")
    lateral = lc.lateral_undulation(amplitude_deg=30.0, frequency_deg_s=130.0, phase_shift_deg=40.0)
    eel = lc.eel_like(amplitude_deg=48.0, frequency_deg_s=110.0, phase_shift_deg=40.0)
    usual = Scenario(robot=lc.load_robot("mamba"), motion=lateral, environment=water)
    return {
        "lateral": usual,
        "eel-like": replace(usual, motion=eel, environment=lc.load_water("paper-eel")),
        "turning": replace(usual, motion=replace(lateral, offset=math.radians(5))),
        "fin": replace(usual, robot=lc.load_robot("mamba-fin")),
        "current": replace(usual, environment=replace(water, current=(0.05, -0.08))),
    }


CASES = cases()


def parity(
    scenario: Scenario,
    joints: str,
    steps: Sequence[float],
    *,
    case: str = "",
    duration: float = 30.0,
    reference_step: float | None = None,
) -> Iterator[Parity]:
    """Compare the models at several steps of the spatial one, from large to small [s]; a row per step.

    The planar model has `reference_step` [s]; None takes a quarter of the smallest of `steps`.
    """
    fine = min(steps) / 4.0 if reference_step is None else reference_step
    closed, space = (model_of(name, joints=joints) for name in ("planar", "spatial"))
    planar = lc.swim(replace(scenario, model=replace(closed, dt=fine), duration=duration))
    traveled = planar.path_speed * duration
    before: lc.Trial | None = None
    for dt in steps:
        model = model_of(space, dt=dt, root="planar", gravity=False)
        spatial = lc.swim(replace(scenario, model=model, duration=duration))
        path = spatial.center_of_mass[:, :2]
        gap, rotation = apart(path, planar.center_of_mass)
        richardson = None
        if before is not None and math.isclose(float(before.settings["dt"] or 0.0), 2.0 * dt):
            better = path + (path - before.center_of_mass[:, :2]) / (2.0 ** ORDERS[joints] - 1.0)
            richardson = apart(better, planar.center_of_mass)[0] / traveled
        heading = float(np.max(np.abs(spatial.heading - planar.heading)))
        differences = {
            "path": gap / traveled,
            "rotation": rotation,
            "heading": heading,
            "richardson": richardson,
        }
        yield Parity(case=case, joints=joints, dt=dt, **differences)
        before = spatial


def apart(path: np.ndarray, other: np.ndarray) -> tuple[float, float]:
    """Largest distance between two paths after the best rotation of the first about their start, and that rotation."""
    a, b = path - path[0], other - other[0]
    rotation = math.atan2(
        float(np.sum(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])), float(np.sum(a * b))
    )
    c, s = math.cos(rotation), math.sin(rotation)
    turned = a @ np.array([[c, s], [-s, c]])
    return float(np.max(np.linalg.norm(turned - b, axis=1))), rotation


def stored() -> list[Parity]:
    """The last answer."""
    with STORE.open(newline="") as file:
        rows = [
            {
                name: text if name in ("case", "joints") else number(text)
                for name, text in row.items()
            }
            for row in csv.DictReader(file)
        ]
    return [Parity(**row) for row in rows]


def number(text: str) -> float | None:
    return float(text) if text else None


def worst(rows: Sequence[Parity], figure: str) -> dict[str, dict[float, float]]:
    """The largest of a figure over the cases, by joints and step; steps without any are left out."""
    found: dict[str, dict[float, float]] = {joints: {} for joints in STEPS}
    for row in rows:
        if (value := getattr(row, figure)) is not None:
            found[row.joints][row.dt] = max(value, found[row.joints].get(row.dt, 0.0))
    return found


def main() -> None:
    """Run all, keep it, and print the worst; with a file's name as argument, draw the picture of the docs into it."""
    rows: list[Parity] = []
    for joints, steps in STEPS.items():
        for case, scenario in CASES.items():
            rows += parity(scenario, joints, steps, case=case)
            print(f"{joints} {case}", file=sys.stderr, flush=True)
    with STORE.open("w", newline="") as file:
        writer = csv.DictWriter(file, [one.name for one in fields(Parity)], lineterminator="\n")
        writer.writeheader()
        writer.writerows(
            {
                name: f"{v:.3g}" if isinstance(v, float) and name != "dt" else v
                for name, v in asdict(row).items()
            }
            for row in rows
        )
    path, richardson, heading = (worst(rows, name) for name in ("path", "richardson", "heading"))
    for joints, steps in STEPS.items():
        for dt in steps:
            better = f"{richardson[joints][dt]:.1e}" if dt in richardson[joints] else "-"
            print(
                f"    {joints:<12}{dt:.4f} s   path {path[joints][dt]:.1e}   Richardson {better:<10}"
                f"heading {heading[joints][dt]:.1e} rad"
            )
    if len(sys.argv) > 1:
        draw(rows, sys.argv[1])


def draw(rows: Sequence[Parity], path: str) -> None:
    """The worst case at every step."""
    figure = new_figure(style.DOUBLE_COLUMN, 2.9)
    left, right = figure.subplots(1, 2)
    for ax, name, label in (
        (left, "path", "path: largest difference / distance [-]"),
        (right, "heading", "heading: largest difference [rad]"),
    ):
        bounds = [(3e-3, "0.3 %")] if name == "path" else []
        convergence(worst(rows, name), ax, ylabel=label, orders=SLOPES, bounds=bounds)
    style.add_legend(left, loc="lower right")
    save_figure(figure, path)


def convergence(
    curves: Mapping[str, Mapping[float, float]],
    ax: Axes,
    *,
    ylabel: str,
    orders: Mapping[str, int],
    bounds: Sequence[tuple[float, str]] = (),
) -> None:
    """Differences over the step, both logarithmic.

    Args:
        curves: At most three: by what the legend says, the difference by step [s].
        ax: Where to draw.
        ylabel: What the difference is, with its unit.
        orders: With which power of the step curves should fall: a short line of this slope is drawn
            beside each [-].
        bounds: Levels that the differences have to stay below, with what they are called.
    """
    for (label, curve), (color, dashes), marker in zip(
        curves.items(), style.LINES, MARKERS, strict=False
    ):
        style_of = {"color": color, "linewidth": style.LINE, "marker": marker, "markersize": 3.5}
        steps, differences = 1e3 * np.array([*curve]), [*curve.values()]
        ax.loglog(steps, differences, linestyle=dashes, label=label, **style_of)
        if label in orders:
            _slope(curve, orders[label], ax)
    for level, name in bounds:
        ax.axhline(level, color=style.GRAY, linewidth=style.THIN)
        at_right: Any = {"xycoords": ("axes fraction", "data"), "ha": "right"}
        style.add_note(ax, name, (0.98, level), (0, 1.5), va="bottom", **at_right)
    style.style_axes(ax, xlabel="time step of the spatial model [ms]", ylabel=ylabel)
    ax.minorticks_off()
    low, high = ax.get_xlim()
    ticks = [t for t in (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0) if low <= t <= high]
    ax.set_xticks(ticks, [f"{t:g}" for t in ticks])


def _slope(curve: Mapping[float, float], order: int, ax: Axes) -> None:
    """The slope of the curve's order, below its largest steps."""
    dt = max(curve) * np.array([1.0, 0.5])
    level = 0.3 * curve[max(curve)] * (dt / dt[0]) ** order
    ax.loglog(1e3 * dt, level, color=style.GRAY, linewidth=style.THIN)
    style.add_note(
        ax, f"order {order}", (float(1e3 * dt[1]), float(level[1])), (2, -3), ha="left", va="top"
    )


if __name__ == "__main__":
    main()
