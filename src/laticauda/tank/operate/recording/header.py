"""Header of a recording: what is known about the whole operation when it begins."""

import json
from collections.abc import Mapping
from dataclasses import is_dataclass, replace
from typing import Any, TypeAlias, get_args

from laticauda import robot
from laticauda.control import estimation
from laticauda.models.dynamics import Plant
from laticauda.motion.joints import JointLaw, Servo
from laticauda.scenarios import Experiment, interfaces, run_from_toml, run_to_toml
from laticauda.values import (
    BadArgument,
    check_instance,
    codec,
    hints_of,
    option,
    packaging,
    quantity,
    value_class,
)
from laticauda.water.fluid import FunctionDrag

HEADER = "operation"
"""Name of the header among the metadata of a recording."""
FORMAT = "4"
"""Format that is read and written."""
Estimators: TypeAlias = estimation.Estimator | estimation.KinematicEstimator


@value_class
class Header:
    """Header of a recording, about the whole operation."""

    run: Experiment = option(
        "robot, water and gait, if known; density and current are used for figures"
    )
    controller: interfaces.Controller[Any] | None = option(
        "the controller, for a replay", default=None
    )
    estimator: Estimators | None = option(
        "state estimator, for a replay; its plant is kept as `twin`", default=None
    )
    twin: Experiment | None = option(
        "how the estimator's digital twin was built; None: without one", default=None
    )
    supply_voltage: float | None = quantity(
        "V", "V of (4); None without a power meter", gt=0.0, default=None
    )
    learning: estimation.Learning | None = option(
        "what a digital twin learned; None: nothing", default=None
    )
    operation: str = option("the trial file as it was read", default="")
    joints: JointLaw | None = option(
        "law of the joints, by which the run is judged; None: servos, as in all older recordings",
        default=None,
    )

    @property
    def joint_law(self) -> JointLaw:
        """The law of the joints."""
        return self.joints or Servo()

    def __post_init__(self) -> None:
        """Reject what cannot be written, and replace a plant with how it was made."""
        check_instance("controller", self.controller, interfaces.Controller, type(None))
        if self.controller is not None and not is_dataclass(self.controller):
            raise BadArgument(
                "controller", f"must be a dataclass, got {type(self.controller).__name__}"
            )
        if isinstance(self.estimator, estimation.Estimator) and self.estimator.plant is not None:
            object.__setattr__(self, "twin", _describe_plant(self.estimator.plant))
            object.__setattr__(self, "estimator", replace(self.estimator, plant=None))

    def texts(self) -> dict[str, str]:
        """Return the header as texts: runs as TOML, texts unchanged, everything else as JSON."""
        texts = {"format": FORMAT, "version": packaging.__version__}
        for name, hint in hints_of(Header).items():
            texts[name] = _encode_field(getattr(self, name), hint)
        return texts


def header_from_texts(texts: Mapping[str, str]) -> Header:
    """Return the header that `Header.texts` converted, equal to the original.

    Args:
        texts: Texts in the format `FORMAT`; older ones have no `learning`, and no `joints`.

    Raises:
        KeyError: If a text is missing.
        BadKey: If a text is invalid.
        ValueError: If a text is invalid.
    """
    complete_texts = {"learning": "null", "joints": "null", **texts}
    fields = {
        name: _decode_field(name, complete_texts[name], hint)
        for name, hint in hints_of(Header).items()
    }
    return Header(**fields)


def _encode_field(value: Any, hint: Any) -> str:
    if isinstance(value, Experiment):
        return run_to_toml(value)
    if isinstance(value, str):
        return value
    return json.dumps(codec.encode(value, hint))


def _decode_field(name: str, text: str, hint: Any) -> Any:
    if hint is str:
        return text
    may_be_run = Experiment in (hint, *get_args(hint))
    if may_be_run and text != "null":
        return run_from_toml(text)
    return codec.decode(hint, json.loads(text), name)


def _describe_plant(plant: Plant[Any]) -> Experiment:
    """Return how a plant was made, in the form that a recording keeps."""
    has_function_as_law = isinstance(robot.law_of(plant.environment), FunctionDrag)
    has_scene = getattr(plant.settings, "scene", None) is not None
    if has_function_as_law or has_scene:
        raise BadArgument(
            "plant", "must have a fluid law that is a class, and no scene, to be recorded"
        )
    return Experiment(robot=plant.robot, environment=plant.environment, model=plant.settings)
