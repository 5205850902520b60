"""Runs as files of older versions have them: robot, gait and environment, and settings by name."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from laticauda.actuation.laws import JointLaw
from laticauda.gaits import Gait
from laticauda.interfaces import Start
from laticauda.robot import Environment, Ground, Robot, from_toml
from laticauda.scenarios.experiment import Experiment
from laticauda.scenarios.models import MODELS, Model
from laticauda.scenarios.scenario import Scenario


def run_of_settings(
    robot: Robot,
    gait: Gait | None,
    environment: Environment,
    settings: Mapping[str, Any],
    log: Mapping[str, np.ndarray],
) -> Scenario | Experiment:
    """The scenario of a trial that an older version made; an experiment, if its settings do not say all.

    A controller was stored in words only, and the state from which a run went on was not stored at all.

    Args:
        robot: What swam.
        gait: What the joints were asked for.
        environment: Where.
        settings: Of the trial.
        log: Its series by name.
    """
    left = {name: one for name, one in settings.items() if one is not None}
    left.pop("parameters", None)
    model = _model(left)
    time: Any = log["time"]
    if model is None or gait is None or left or time[0] != 0.0 or time.size < 2:
        return Experiment(robot=robot, gait=gait, environment=environment, model=model, notes=left)
    x, y = (float(one) for one in log["center_of_mass"][0][:2])
    heading = float(log["heading"][0])
    u, v = (float(one) for one in log["center_of_mass_velocity"][0][:2])
    start = Start(center_of_mass=(x, y), heading=heading, velocity=u * math.cos(heading) + v * math.sin(heading))
    duration = float(time[-1])
    return Scenario(
        robot=robot,
        motion=gait,
        environment=environment,
        model=model,
        start=start,
        duration=duration,
        sample_interval=duration / (time.size - 1),
    )


def _model(settings: dict[str, Any]) -> Model | None:
    """The model, whose settings are taken out; None if it is none of ours."""
    kind, joints = MODELS.get(str(settings.get("model"))), str(settings.get("joints"))
    if kind is None or joints not in JointLaw.names() or settings.get("fluid_law", "built-in") != "built-in":
        return None
    settings.pop("ground", None)
    if "shore" in settings:
        settings["shore"] = from_toml(settings["shore"], Ground)
    for name in ("model", "joints", "fluid_law"):
        settings.pop(name, None)
    own = {name: settings.pop(name) for name in kind.__dataclass_fields__ if name in settings}
    return kind(**own, joints=JointLaw.named(joints)())
