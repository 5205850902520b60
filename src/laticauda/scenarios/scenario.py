"""A scenario: everything that decides a run."""

from collections.abc import Mapping
from typing import Any

from laticauda.errors import instance
from laticauda.extensions import name_of
from laticauda.gaits import Gait
from laticauda.interfaces import Command, Controller, OpenLoop, Resumed, Start
from laticauda.quantities import option, quantity, value
from laticauda.robot import Environment, Robot
from laticauda.scenarios.models import Model, Planar, settings_of


@value
class Scenario:
    """Everything that decides a run: the same scenario always gives the same trial (`laticauda.swim`).

    `dataclasses.replace` makes another one; what it does not replace stays the same object.

    Raises:
        ValueError: If a field is out of its range.
    """

    robot: Robot = option("What swims")
    motion: Gait | Controller[Any] = option("What the joints are asked for: a gait, or a controller that steers one")
    environment: Environment = option("The water it swims in or the ground it crawls on")
    model: Model = option("By which model", default=Planar())
    start: Start | Resumed = option("Where it begins: straight, or where another run ended", default=Start())
    duration: float = quantity("s", "Of the run", default=30.0, gt=0.0)
    sample_interval: float = quantity(
        "s",
        "Between two samples of the log; adjusted so that it divides the time between two control instants, and the "
        "duration",
        default=0.05,
        gt=0.0,
    )

    def __post_init__(self) -> None:
        """Check what its type does not tell."""
        instance("motion", self.motion, Gait, Controller)

    @property
    def gait(self) -> Gait:
        """The gait, or the one that the controller starts with."""
        return self.motion if isinstance(self.motion, Gait) else self.motion.gait

    @property
    def controller(self) -> Controller[Any]:
        """The controller; for a gait one that holds it."""
        return OpenLoop(command=Command(gait=self.motion)) if isinstance(self.motion, Gait) else self.motion

    @property
    def settings(self) -> Mapping[str, str | float | bool | None]:
        """What the controller and the model are, in texts and numbers, for people."""
        found: dict[str, Any] = {}
        if not isinstance(self.motion, Gait):
            steered: Any = self.motion
            found["controller"] = name_of(self.motion.__class__)
            for name in getattr(steered, "__dataclass_fields__", ()):
                one: Any = getattr(steered, name)
                if name != "gait":
                    found[name] = one if isinstance(one, str | float | int) else repr(one)
        return {**found, **settings_of(self.model)}
