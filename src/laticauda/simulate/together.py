"""Several robots in one scene, each with its own gait or controller: one run, and a trial of each."""

import math
from collections.abc import Mapping, Sequence
from typing import Any, cast

from laticauda.errors import BadArgument, instance
from laticauda.interfaces import Command, Start
from laticauda.packaging import __version__
from laticauda.scenarios import Scenario, Spatial
from laticauda.series import Log, concatenated
from laticauda.simulate import plants, runner
from laticauda.trial import Trial


def swim_together(scenarios: Sequence[Scenario], *, progress: runner.Progress | None = None) -> list[Trial]:
    """Run several robots in one scene.

    They have one environment, one scene (`open` is one with nothing else in it), one duration and sample interval;
    robots, gaits, controllers, joint laws and starts are their own. Bodies of the second robot have `robot_1_` before
    their names, and so on, so that they may all be the same.

    Args:
        scenarios: One for each robot, of the spatial model.
        progress: Called now and then with the time reached [s].

    Returns:
        A trial for each; contacts with other robots are among its contact forces. Rays see no other robots.

    Raises:
        ValueError: If they cannot be in one scene, or robots begin in one another.

    Example:
        >>> import laticauda as lc
        >>> gait = lc.lateral_undulation(amplitude=0.5, frequency=2.0, phase_shift=0.7)
        >>> def one(y):
        ...     start = lc.Start(center_of_mass=(0.0, y))
        ...     return lc.scenario("mamba", gait, 1.0, model="spatial", scene="open", start=start)
        >>> [len(trial.time) for trial in lc.swim_together([one(0.0), one(0.5)])]
        [21, 21]
    """
    from laticauda.spatial.together import Together

    instance("scenarios", scenarios, Sequence)
    for i, one in enumerate(scenarios):
        instance(f"scenarios[{i}].model", one.model, Spatial)
        if cast(Spatial, one.model).scene is None or one.model.loop_delay:
            raise BadArgument(f"scenarios[{i}].model", "must have a `scene`, as `open`, and no `loop_delay`")
        one.controller.check(one.robot)
    pairs = [(one, cast(Any, plants.plant(one))) for one in scenarios]
    for name in ("environment", "duration", "sample_interval", "scene", "gravity", "root"):
        if len({repr(getattr(one, name, getattr(body.settings, name, 0))) for one, body in pairs}) != 1:
            raise BadArgument(name, "must be the same for all robots in one scene")
    paces = {one.controller.interval for one in scenarios} - {math.inf}
    if len(paces) > 1:
        raise BadArgument("interval", "must be the same for all controllers in one scene")
    duration, sample_interval = scenarios[0].duration, scenarios[0].sample_interval
    runner.check_size(duration, sample_interval)
    controllers = [one.controller for one in scenarios]
    together = Together([body for _, body in pairs])
    commands = [Command(gait=controller.gait) for controller in controllers]
    each = together.init([cast(Start, one.start) for one in scenarios], commands)
    minds: list[Any] = [controller.init() for controller in controllers]
    logs: list[list[Log]] = []
    signals: list[list[Mapping[str, float]]] = []
    failure: str | None = None
    for share, count, done in runner.stretches(duration, sample_interval, min([math.inf, *paces])):
        for k, controller in enumerate(controllers):
            if not logs or math.isfinite(controller.interval):
                minds[k], commands[k] = controller.step(minds[k], together.plants[k].observe(each[k]))
        signals.append([controller.signals(mind) for controller, mind in zip(controllers, minds, strict=True)])
        each, found, failure = together.march(each, commands, share, share / count)
        logs.append([log.at(slice(1, None)) if logs else log for log in found])
        if failure is not None:
            break
        if progress is not None:
            progress(done)
    trials: list[Trial] = []
    for k, one in enumerate(scenarios):
        parts = [log[k] for log in logs]
        log, said = concatenated(parts), runner.held([each[k] for each in signals], [part.time.size for part in parts])
        series: dict[str, Any] = {**vars(log), "signals": {**said, **log.signals}}
        status = failure or "The run reached its end."
        trials.append(Trial(**series, scenario=one, version=__version__, status=status, succeeded=failure is None))
    return trials
