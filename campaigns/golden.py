"""Thirty runs that name every choice, with all that they log: what a rebuilt house is held against.

    python campaigns/golden.py                 compare with campaigns/golden.npz, recorded before the rebuild
    python campaigns/golden.py --record        record anew (and say why in the commit)

Bit for bit on the machine that recorded them; other processors round differently in the last
digits, so the comparison says how far apart each run is, and fails beyond 1e-12 of a series'
largest number there and here alike.
"""

import argparse
import sys
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from importlib import import_module
from math import radians
from pathlib import Path
from typing import Any

import numpy as np

import laticauda as lc
from laticauda.models.planar import rows
from laticauda.models.planar.sample_format import column_of
from laticauda.models.spatial import rows as spatial_rows
from laticauda.robot import PectoralFin
from laticauda.scenarios import limit_case
from laticauda.water.fluid.laws import PolynomialDrag

STORE = Path(__file__).with_suffix(".npz")
TOLERANCE = 1e-12
EDGE_COLUMNS = {"planar": column_of(rows.EDGE_MEMORY), "spatial": spatial_rows.EDGE_MEMORY}
"""Where the state of an edge stands in the state vectors of the models."""
ARRAYS = (
    *(
        "time",
        "center_of_mass",
        "center_of_mass_velocity",
        "heading",
        "heading_rate",
        "link_angle",
        "joint_angle",
    ),
    *("joint_rate", "joint_angle_ref", "joint_torque", "work", "electrical_work"),
)
FIGURES = (
    "forward_velocity",
    "steady_velocity",
    "net_power",
    "mean_power",
    "cost_of_transport",
    "center_of_mass",
)

LATERAL = lc.lateral_undulation(
    amplitude=radians(30), frequency=radians(130), phase_shift=radians(40)
)
EEL = lc.eel_like(
    amplitude=radians(30), frequency=radians(130), phase_shift=radians(40), offset=0.05
)
ROLLING = replace(
    lc.lateral_undulation(amplitude=0.4, frequency=2.0, phase_shift=0.6),
    pitch=lc.Wave(amplitude=0.1, frequency=2.0, phase_shift=0.6, phase=1.5, offset=0.01),
)
DRAG = {"reference_speed": 0.7, "linear": True, "quadratic": True, "sway_friction": 0.4}


def water(form: str = "relative", **changes: Any) -> Any:
    """The paper's water, every option named."""
    return replace(lc.load_water("paper-lateral"), added_mass_form=form, **changes)


def with_drag(calm: Any, **numbers: Any) -> Any:
    """A water with other numbers of the polynomial drag."""
    return replace(calm, drag=PolynomialDrag(**numbers))


def custom(n: int) -> Any:
    """A gait with an envelope of its own."""
    return lc.custom_gait(
        envelope=lambda i, n: 0.3 + i / n,
        n_links=n,
        amplitude=0.4,
        frequency=2.0,
        phase_shift=0.7,
        offset=-0.02,
    )


def planar(
    robot: Any, gait: Any, where: Any, joints: str = "prescribed", **settings: Any
) -> lc.Trial:
    """A run of the planar model; nothing is left to a default that could change."""
    step = {"prescribed": 0.01, "pd": 0.002, "servo": 0.002}[joints]
    usual = {
        "dt": step,
        "offset_bandwidth": 10.0,
        "ramp": 1.0,
        "sample_interval": 0.25,
        "link_forces": True,
    }
    return lc.swim(
        robot, gait, 6.0, environment=where, model="planar", joints=joints, **(usual | settings)
    )


def spatial(
    robot: Any, gait: Any, where: Any, root: str, joints: str = "prescribed", **settings: Any
) -> lc.Trial:
    """The same in space."""
    usual = {
        "dt": 0.005,
        "offset_bandwidth": 10.0,
        "ramp": 1.0,
        "sample_interval": 0.25,
        "link_forces": True,
    }
    usual |= {"gravity": True, "root": root}
    return lc.swim(
        robot, gait, 4.0, environment=where, model="spatial", joints=joints, **(usual | settings)
    )


def following(guidance: Any, path: Any, robot: str, model: str = "planar") -> lc.Trial:
    """A path followed."""
    controller = lc.PathFollowing(
        gait=LATERAL,
        path=path,
        guidance=guidance,
        heading=lc.HeadingController(gain=0.4, max_offset=0.35),
    )
    body = lc.build_plant(
        lc.load_robot(robot),
        water(),
        model=model,
        joints="prescribed",
        dt=0.01,
        offset_bandwidth=4.0,
        ramp=1.0,
    )
    return lc.run(
        body,
        controller,
        8.0,
        start=lc.Start(center_of_mass=(0.0, 0.5), heading=0.2),
        sample_interval=0.25,
    )


def elastic(hinges: int = 3, *, driven: bool = False) -> Any:
    """Mamba with a fin that bends, and that its last joint may drive."""
    robot = lc.load_robot("mamba-fin")
    joint = robot.joints[0] if driven else None
    return replace(
        robot,
        caudal_fin=replace(robot.caudal_fin, n_hinges=hinges, flexural_rigidity=0.5, joint=joint),
    )


def scenarios() -> Mapping[str, Callable[[], Any]]:
    """The runs by name."""
    robot = {
        name: lc.load_robot(name)
        for name in (
            "mamba",
            "mamba-fin",
            "mamba-thruster",
            "mamba-modules",
            "mamba-modules-fin",
            "chain",
        )
    }
    edge = water("kirchhoff", trailing_edge="elongated", rotational="strip")
    plated = replace(
        robot["mamba"],
        pectoral_fins=(
            PectoralFin(
                link=7, area=0.004, lift_slope=3.0, stall_angle=0.4, x=0.02, y=0.05, angle=0.1
            ),
        ),
    )
    fin_wave = replace(LATERAL, fin=lc.Wave(amplitude=0.2, frequency=3.0, phase=0.4, offset=0.02))
    return {
        "mamba": lambda: planar(robot["mamba"], LATERAL, water()),
        "mamba eel pd": lambda: planar(
            robot["mamba"], EEL, lc.load_water("paper-eel"), "pd", ramp=0.0
        ),
        "mamba servo": lambda: planar(robot["mamba"], LATERAL, water(), "servo", ramp=0.0),
        "fin relative": lambda: planar(robot["mamba-fin"], LATERAL, water()),
        "fin kirchhoff strip": lambda: planar(
            robot["mamba-fin"], LATERAL, water("kirchhoff", rotational="strip")
        ),
        "fin classic": lambda: planar(robot["mamba-fin"], EEL, water("classic")),
        "fin trailing edge servo": lambda: planar(robot["mamba-fin"], LATERAL, edge, "servo"),
        "thruster": lambda: planar(
            robot["mamba-thruster"], LATERAL, lc.load_water("published-2015")
        ),
        "modules in the plane": lambda: planar(robot["mamba-modules"], LATERAL, water("kirchhoff")),
        "chain vortex": lambda: planar(robot["chain"], custom(10), lc.load_water("paper-vortex")),
        "current": lambda: planar(robot["mamba"], LATERAL, water(current=(0.05, -0.08))),
        "depth taper": lambda: planar(
            robot["mamba"], LATERAL, water(depth=0.12, friction_taper=0.3)
        ),
        "drag polynomial": lambda: planar(
            robot["mamba-fin"], LATERAL, with_drag(water("kirchhoff"), **DRAG)
        ),
        "pectoral fin": lambda: planar(plated, LATERAL, water()),
        "elastic fin": lambda: planar(elastic(), LATERAL, water("kirchhoff"), dt=0.002),
        "driven elastic fin pd": lambda: planar(
            elastic(driven=True), fin_wave, water("kirchhoff"), "pd"
        ),
        "crawl viscous": lambda: planar(robot["mamba"], LATERAL, lc.load_ground("viscous")),
        "crawl coulomb pd": lambda: planar(
            robot["mamba"], LATERAL, lc.load_ground("coulomb"), "pd", dt=0.0005
        ),
        "follow line": lambda: following(
            lc.LineOfSight(look_ahead_distance=0.18),
            lc.StraightLine(point=(0.0, 0.0), angle=0.1),
            "mamba",
        ),
        "follow spline integral": lambda: following(
            lc.IntegralLineOfSight(look_ahead_distance=0.3, integral_gain=0.02),
            lc.Spline(waypoints=((0.0, 0.0), (0.5, 0.0), (1.0, 0.4), (2.0, 0.4))),
            "mamba-fin",
        ),
        "spatial planar root": lambda: spatial(
            robot["mamba-fin"], LATERAL, water("kirchhoff"), "planar"
        ),
        "spatial free root": lambda: spatial(
            robot["mamba-modules"], ROLLING, water("kirchhoff", depth=0.6), "free"
        ),
        "spatial servo": lambda: spatial(robot["mamba"], LATERAL, water(), "free", "servo"),
        "spatial pd relative fin": lambda: spatial(
            robot["mamba-modules-fin"], EEL, water(), "free", "pd"
        ),
        "spatial drag polynomial": lambda: spatial(
            robot["mamba"], LATERAL, with_drag(water(), **DRAG), "free"
        ),
        "spatial elastic fin": lambda: spatial(
            elastic(), LATERAL, water("kirchhoff"), "planar", dt=0.002
        ),
        "spatial crawl": lambda: spatial(
            robot["mamba"], LATERAL, lc.load_ground("coulomb"), "free", "pd", dt=0.001
        ),
        "spatial follow": lambda: following(
            lc.LineOfSight(look_ahead_distance=0.18),
            lc.StraightLine(point=(0.0, 0.0), angle=0.0),
            "mamba",
            "spatial",
        ),
        "batch": lambda: batch("cpu", robot["mamba-fin"], 12),
        "cuda simulator": lambda: batch("cuda", elastic(1), 3),
    }


def batch(device: str, robot: Any, count: int) -> lc.Swims:
    """Trials side by side, prescribed joints and servos, one water that makes its trial diverge."""
    if device == "cuda":
        import_module("laticauda_cuda")
        body = robot.planar()
        robot = replace(body, modules=body.modules[:3], joints=body.joints[:2])
    gaits = [replace(EEL, amplitude=0.2 + 0.03 * i) for i in range(count)]
    waters = [water(normal_drag=1e7 if i == 1 else 1.0 + 0.1 * i) for i in range(count)]
    duration = 0.3 if device == "cuda" else 15.0
    settings = {
        "joints": "prescribed",
        "dt": 0.05,
        "offset_bandwidth": 10.0,
        "ramp": 1.0,
        "device": device,
    }
    with limit_case():
        return lc.swim_many(robot, gaits, duration, environments=waters, **settings)


def series(run: Any) -> Iterator[tuple[str, np.ndarray]]:
    """All that a run logged."""
    if isinstance(run, lc.Swims):
        for name in FIGURES:
            yield name, np.asarray(getattr(run, name))
        return
    for name in ARRAYS:
        value = getattr(run, name)
        if value is not None:
            yield name, value
    for kind, named in (
        ("link_force", run.link_force or {}),
        ("signals", run.signals),
        ("state", run.state),
    ):
        for name, value in named.items():
            logged = np.asarray(value)
            if kind == "state" and name in EDGE_COLUMNS:
                logged = without_edge(logged, EDGE_COLUMNS[name])
            yield f"{kind}.{name}", logged


def without_edge(state: np.ndarray, column: int) -> np.ndarray:
    """Return a state without that of an edge of finite span, which is 0 here and was none when the set was recorded."""
    if state[column] != 0.0:
        return state
    return np.delete(state, column)


def distance(there: np.ndarray, here: np.ndarray) -> float:
    """Largest difference as a share of the largest number; 0 only if all bits are the same."""
    if there.shape != here.shape:
        return np.inf
    if np.array_equal(there, here, equal_nan=True):
        return 0.0
    scale = np.nanmax(np.abs(there))
    return float(np.nanmax(np.abs(there - here)) / max(scale, 1e-300))


def main() -> int:
    """Record or compare."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "--record", action="store_true", help="write the file instead of comparing with it"
    )
    parser.add_argument("--only", default="", help="only runs whose name contains this")
    parser.add_argument("--store", type=Path, default=STORE, help="the file")
    chosen = parser.parse_args()
    found: dict[str, np.ndarray] = {}
    stored = {} if chosen.record else dict(np.load(chosen.store))
    worst = 0.0
    for name, make in scenarios().items():
        if chosen.only not in name:
            continue
        try:
            run = make()
        except ImportError as error:  # an extra, or laticauda-cuda
            print(f"{name:26} left out: {error}")
            continue
        mine = {f"{name}: {key}": value for key, value in series(run)}
        found |= mine
        if not chosen.record:
            apart = {
                key: distance(stored[key], mine[key]) if key in stored else np.inf for key in mine
            }
            lost = [key for key in stored if key.startswith(f"{name}: ") and key not in mine]
            most = max(apart, key=lambda key: apart[key])
            worst = max([worst, apart[most], *(np.inf for _ in lost)])
            same = sum(value == 0.0 for value in apart.values())
            print(
                f"{name:26} {same} of {len(apart)} series bit for bit; largest difference {apart[most]:.2g} in {most}"
            )
            for key in lost:
                print(f"{'':26} not there any more: {key}")
        else:
            status = (
                run.status
                if isinstance(run, lc.Trial)
                else f"{int(run.succeeded.sum())} of {len(run)} succeeded"
            )
            print(f"{name:26} {len(mine)} series, {status}")
    if chosen.record:
        np.savez_compressed(chosen.store, **found)
        print(f"{len(found)} series, {chosen.store.stat().st_size / 1e6:.2f} MB")
    return 0 if worst <= TOLERANCE else 1


if __name__ == "__main__":
    sys.exit(main())
