"""`swim`: from a robot and a gait to a trial, with the defaults of the paper."""

import functools

from laticauda.errors import instance
from laticauda.gaits import Gait
from laticauda.interfaces import Command, OpenLoop, Start
from laticauda.robot import Environment, Robot, load_water
from laticauda.simulate.plants import FluidLaw, plant
from laticauda.simulate.runner import Progress, run
from laticauda.trial import Trial


def default_water(gait: Gait) -> str:
    """Name of the paper's coefficient set for `gait`: it identified one for each kind."""
    return "paper-eel" if gait.kind == "eel_like" else "paper-lateral"


preset_water = functools.cache(load_water)


def swim(
    robot: Robot,
    gait: Gait,
    duration: float = 30.0,
    *,
    environment: Environment | None = None,
    model: str = "planar",
    joints: str = "prescribed",
    dt: float | None = None,
    offset_bandwidth: float = 10.0,
    ramp: float | None = None,
    fluid_law: FluidLaw | None = None,
    root: str | None = None,
    gravity: bool | None = None,
    start: Start | None = None,
    sample_interval: float = 0.05,
    link_forces: bool = False,
    throw: bool = False,
    progress: Progress | None = None,
) -> Trial:
    """Let a robot swim a gait, from straight and at rest.

    Args:
        robot: What swims (`load_robot`).
        gait: What the joints are asked for (`lateral_undulation`, `eel_like`, `custom_gait`).
        duration: [s].
        environment: Water or ground; None takes the paper's coefficients for the gait.
        model: See `laticauda.simulate.plant`.
        joints: See `laticauda.simulate.plant`.
        dt: See `laticauda.simulate.plant` [s].
        offset_bandwidth: See `laticauda.simulate.plant` [rad/s].
        ramp: See `laticauda.simulate.plant` [s].
        fluid_law: See `laticauda.simulate.plant`.
        root: See `laticauda.simulate.plant`.
        gravity: See `laticauda.simulate.plant`.
        start: See `laticauda.simulate.run`.
        sample_interval: See `laticauda.simulate.run` [s].
        link_forces: See `laticauda.simulate.run`.
        throw: See `laticauda.simulate.run`.
        progress: See `laticauda.simulate.run`.

    Returns:
        The trial; a run that blows up is one too, and its `status` says when and what to try.

    Raises:
        ValueError: If an argument is out of its range.
        SimulationFailed: If the run blows up and `throw` is set.

    Example:
        >>> import laticauda as lc
        >>> gait = lc.lateral_undulation(amplitude=0.5236, frequency=2.2689, phase_shift=0.6981)
        >>> trial = lc.swim(lc.load_robot("mamba"), gait, duration=30.0)
        >>> round(trial.forward_velocity, 3)
        0.148
    """
    instance("gait", gait, Gait)
    body = plant(
        robot,
        environment or preset_water(default_water(gait)),
        model=model,
        joints=joints,
        dt=dt,
        offset_bandwidth=offset_bandwidth,
        ramp=ramp,
        fluid_law=fluid_law,
        root=root,
        gravity=gravity,
    )
    return run(
        body,
        OpenLoop(command=Command(gait=gait)),
        duration,
        start=start,
        sample_interval=sample_interval,
        link_forces=link_forces,
        throw=throw,
        progress=progress,
    )
