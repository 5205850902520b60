"""What a recording says about the whole operation, as a value and as the texts of its file.

Only classes that come with the package, or that this process knows, are ever built from a file.
"""

import json
from collections.abc import Mapping
from dataclasses import is_dataclass, replace
from typing import Any, TypeAlias, get_args

from laticauda import codec, estimation, interfaces, packaging, robot
from laticauda.dynamics.plant import Plant
from laticauda.errors import BadArgument, instance
from laticauda.fluid.laws import FunctionDrag
from laticauda.quantities import hints_of, option, quantity, value
from laticauda.scenarios import Experiment, run_from_toml, run_to_toml

HEADER = "operation"
FORMAT = "4"
"""That is read and written."""
Estimators: TypeAlias = estimation.Estimator | estimation.KinematicEstimator


@value
class Header:
    """What a recording says about the whole operation."""

    run: Experiment = option("what swims, in what, by which gait, if known; density and current count for figures")
    controller: interfaces.Controller[Any] | None = option("what decides the commands, for a replay", default=None)
    estimator: Estimators | None = option("where the robot is, for a replay; its plant is kept as `twin`", default=None)
    twin: Experiment | None = option("how the estimator's digital twin was made; None without one", default=None)
    supply_voltage: float | None = quantity("V", "V of (4); None without a power meter", gt=0.0, default=None)
    operation: str = option("the trial file as it was read", default="")

    def __post_init__(self) -> None:
        """Refuse what cannot be written, and keep of a plant how it was made."""
        instance("controller", self.controller, interfaces.Controller, type(None))
        if not (self.controller is None or is_dataclass(self.controller)):
            raise BadArgument("controller", f"must be a value, got {type(self.controller).__name__}")
        if isinstance(self.estimator, estimation.Estimator) and self.estimator.plant is not None:
            object.__setattr__(self, "twin", _record_of(self.estimator.plant))
            object.__setattr__(self, "estimator", replace(self.estimator, plant=None))

    def texts(self) -> dict[str, str]:
        """The header as texts by name: runs as TOML, all else but texts as JSON."""
        own = {name: _text(getattr(self, name), hint) for name, hint in hints_of(Header).items()}
        return {"format": FORMAT, "version": packaging.__version__, **own}


def header_from_texts(texts: Mapping[str, str]) -> Header:
    """The header that `Header.texts` made texts of; it equals that one.

    Args:
        texts: Of `FORMAT`.

    Raises:
        KeyError: If one is missing.
        BadKey: If one is not as it may be.
        ValueError: Likewise.
    """
    return Header(**{name: _value(name, texts[name], hint) for name, hint in hints_of(Header).items()})


def _text(value: Any, hint: Any) -> str:
    if isinstance(value, Experiment):
        return run_to_toml(value)
    return value if isinstance(value, str) else json.dumps(codec.encode(value, hint))


def _value(name: str, text: str, hint: Any) -> Any:
    if hint is str:
        return text
    is_run = Experiment in (hint, *get_args(hint)) and text != "null"
    return run_from_toml(text) if is_run else codec.decode(hint, json.loads(text), name)


def _record_of(plant: Plant[Any]) -> Experiment:
    """How a plant was made, as a recording keeps it."""
    if isinstance(robot.law_of(plant.environment), FunctionDrag) or getattr(plant.settings, "scene", None) is not None:
        raise BadArgument("plant", "must have a law that is a class, and no scene, to be recorded")
    return Experiment(robot=plant.robot, environment=plant.environment, model=plant.settings)
