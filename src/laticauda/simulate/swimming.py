"""`swim`: from a scenario to its trial."""

from pathlib import Path
from typing import Unpack, cast

from laticauda.robot import Robot
from laticauda.scenarios import Changes, Experiment, Motion, Scenario, scenario
from laticauda.simulate.plants import plant
from laticauda.simulate.runner import Progress, run
from laticauda.trial import Trial


def swim(
    robot: Scenario | Experiment | Robot | str | Path,
    gait: Motion | None = None,
    duration: float = 30.0,
    *,
    link_forces: bool = False,
    throw: bool = False,
    progress: Progress | None = None,
    **changes: Unpack[Changes],
) -> Trial:
    """Run a scenario; or let a robot swim a gait, from straight and at rest.

    Args:
        robot: The scenario, of a trial too (`Trial.scenario`); or what swims (`load_robot`), with its gait.
        gait: What the joints are asked for (`lateral_undulation`, `eel_like`, `custom_gait`), or a controller; left
            out with a scenario.
        duration: With a robot [s].
        link_forces: See `laticauda.simulate.run`.
        throw: See `laticauda.simulate.run`.
        progress: See `laticauda.simulate.run`.
        changes: With a robot, what else differs from the defaults, `environment`, `model`, `joints`, `dt` and the
            like, see `laticauda.scenarios.Changes`.

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
    if isinstance(robot, Scenario | Experiment):
        body, chosen = plant(robot), cast(Scenario, robot)
    else:
        chosen = scenario(robot, cast(Motion, gait), duration, **changes)
        body = plant(chosen)
    return run(
        body,
        chosen.controller,
        chosen.duration,
        start=chosen.start,
        sample_interval=chosen.sample_interval,
        link_forces=link_forces,
        throw=throw,
        progress=progress,
    )
