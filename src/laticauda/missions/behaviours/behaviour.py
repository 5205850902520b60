"""What a behaviour is: it steers during a phase of a mission, and says when it is done or has failed."""

from typing import Any, Generic, Literal, TypeAlias, TypeVar

from laticauda.missions.estimate import Estimate
from laticauda.missions.steering import Steering
from laticauda.values import Extensible

State = TypeVar("State")
Outcome: TypeAlias = Literal["done", "failed"]
"""How a behaviour ends by itself."""


class Behaviour(Extensible, Generic[State], group="behaviours"):
    """Base of behaviours. They know estimates only; their state is a value.

    A behaviour of one's own is a subclass with `begin`, `steer` and, if it ends by itself, `outcome`.
    """

    def begin(self, estimate: Estimate) -> State:
        """Return the state when its phase begins.

        Args:
            estimate: What the robot believes.
        """
        raise NotImplementedError

    def steer(self, state: State, estimate: Estimate) -> tuple[State, Steering]:
        """Return the next state, and what it wants until the next control instant.

        Args:
            state: State after the last control instant, or from `begin`.
            estimate: What the robot believes.
        """
        raise NotImplementedError

    def outcome(self, state: State, estimate: Estimate) -> Outcome | None:
        """Return whether it is done or has failed; None while it goes on.

        Args:
            state: State returned by `steer`.
            estimate: What the robot believes.
        """
        del state, estimate
        return None


AnyBehaviour: TypeAlias = Behaviour[Any]
