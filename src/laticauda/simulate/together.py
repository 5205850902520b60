"""Several robots in one scene, each with its own gait or controller: one run, and a trial of each."""

import math
from collections.abc import Sequence
from typing import Any, cast

from laticauda.errors import BadArgument, instance
from laticauda.scenarios import Scenario, Spatial
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
        if cast(Spatial, one.model).scene is None:
            raise BadArgument(f"scenarios[{i}].model", "must have a `scene`, as `open`")
    bodies = [cast(Any, plants.plant(one)) for one in scenarios]
    for name in ("environment", "duration", "sample_interval", "scene", "gravity", "root"):
        of_all = zip(scenarios, bodies, strict=True)
        if len({repr(getattr(one, name, getattr(body.settings, name, 0))) for one, body in of_all}) != 1:
            raise BadArgument(name, "must be the same for all robots in one scene")
    if len({one.controller.interval for one in scenarios} - {math.inf}) > 1:
        raise BadArgument("interval", "must be the same for all controllers in one scene")
    together = Together(bodies)
    return runner.run_all(scenarios, bodies, together.march, check=together.check, progress=progress)
