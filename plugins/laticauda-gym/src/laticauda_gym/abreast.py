"""Several robots that swim abreast: their task, and the scene that they share."""

# pyright: reportPrivateUsage=false

import math
from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np
from jaxtyping import Float

from laticauda.models.spatial import School, Together
from laticauda.scenarios import Scenario, Spatial
from laticauda.values import BadArgument, option, quantity, value_class
from laticauda_gym.swimming import Numbers, Range, Sight, Step, in_body_axes, ranges, swimmer
from laticauda_gym.tasks import BESIDE_THE_PATH, Steered, check_ends, log_square

OPEN = Spatial(scene="open")  # pyright: ignore[reportArgumentType]  # its name becomes the scene


class OneScene(School):
    """Robots of one plant that share a scene and can touch one another. Arguments as for the base class."""

    usual_threads = 1

    def _allocate(self, n_threads: int) -> Sequence[range]:
        shares = super()._allocate(1)
        self._together = Together(self._plants)
        return shares

    def _restart(
        self,
        indices: np.ndarray,
        center_of_mass: np.ndarray,
        heading: np.ndarray,
        currents: Any,
    ) -> None:
        super()._restart(indices, center_of_mass, heading, currents)
        # These know the water of this episode.
        self._together.plants = self._plants
        self._together.check(self._states)

    def _swim(self, gaits: np.ndarray, duration: float) -> np.ndarray:
        commands = self.commands_of(gaits)
        advance = self._together.march(self._states, commands, duration, duration)
        self._states = advance.states
        return np.full(self.n, advance.failure is None)


@value_class
class Abreast(Steered):
    """Swim abreast along lines that lie side by side, without touching, in a current that is not observed.

        r = (x(t + h) - x(t)) / v_1 - h (ln(1 + (e/e_1)^2) + ln(1 + (d/d_1)^2) + P/P_1 + T)

    e is the distance from the robot's own line, d is its lead over the mean of all robots, and T is
    `touch_cost` while it touches something. The actions are the offset that steering adds, and the
    frequency.

    Raises:
        ValueError: If a field is out of its range, an offset could take a joint beyond its limit,
            or there is no scene.
    """

    scenario: Scenario = option(
        "Robot, gait, water, duration; episodes set start and current",
        default_factory=partial(swimmer, model=OPEN),
    )
    frequencies: tuple[float, float] = quantity(
        "rad/s", "Action range", ge=0.0, default=(0.0, math.radians(130.0))
    )
    spacing: float = quantity("m", "Distance between lines", gt=0.0, default=0.8)
    max_cross_track_error: float = quantity(
        "m", "At the start, to either side of the line", ge=0.0, default=0.1
    )
    max_lead: float = quantity("m", "At the start, ahead or behind", ge=0.0, default=0.5)
    max_heading: float = quantity(
        "rad", "At the start, to either side", ge=0.0, default=math.radians(10.0)
    )
    cross_track_tolerance: float = quantity("m", "e_1", gt=0.0, default=0.1)
    lead_tolerance: float = quantity("m", "d_1", gt=0.0, default=0.2)
    speed_unit: float = quantity(
        "m/s", "v_1, speed along the line that earns 1 per second", gt=0.0, default=0.1
    )
    touch_cost: float = quantity(
        "1/s", "T, cost while a robot touches something", ge=0.0, default=10.0
    )

    def __post_init__(self) -> None:
        """Check that the fields fit together."""
        super().__post_init__()
        check_ends(self, "frequencies")
        model = self.scenario.model
        if not isinstance(model, Spatial) or model.scene is None:
            raise BadArgument(
                "scenario.model",
                "must be a `Spatial` with a `scene`, e.g. `open`, for robots that meet",
            )

    @property
    def actions(self) -> tuple[Range, ...]:
        """Offset and frequency."""
        return super().actions + ranges(frequency=self.frequencies)

    @property
    def shared(self) -> tuple[Range, ...]:
        """Quantities drawn once for all robots: the current, or the drawn parameters of the water's flow."""
        return super().draws

    @property
    def draws(self) -> tuple[Range, ...]:
        """Start of a robot relative to the start of its line, and the quantities of the water."""
        x, y, heading = self.max_lead, self.max_cross_track_error, self.max_heading
        return ranges(x=(-x, x), y=(-y, y), heading=(-heading, heading)) + self.shared

    def origins(self, n: int) -> Float[np.ndarray, "n 2"]:
        """Return the origins of the lines, from right to left, centered on the x axis [m].

        Args:
            n: Number of robots, each with a line of its own.
        """
        return np.stack((np.zeros(n), self.spacing * (np.arange(n) - 0.5 * (n - 1))), axis=1)

    @property
    def sights(self) -> tuple[Sight, ...]:
        """Position and heading relative to the robot's own line, velocity; lead; nearest other robot; gait."""
        return (
            Sight(name="cross_track_error", of=self._error),
            *BESIDE_THE_PATH[1:],
            Sight(name="lead", of=_lead),
            Sight(name="nearest_along", of=lambda step: _nearest(step)[0]),
            Sight(name="nearest_across", of=lambda step: _nearest(step)[1]),
            Sight(name="touches", of=_touches),
            *super().sights,
            Sight(name="frequency", of=lambda step: step.after.frequency, unit=self.frequencies[1]),
        )

    def reward(self, step: Step) -> Numbers:
        """Progress along the line in `step`, minus the costs of distance from it, lead, power and contact."""
        error = log_square(self._error(step), self.cross_track_tolerance)
        lead = log_square(_lead(step), self.lead_tolerance)
        progress = (step.after.x - step.before.x) / self.speed_unit
        cost = error + lead + step.power / self.power_unit + self.touch_cost * _touches(step)
        return progress - step.interval * cost

    def _error(self, step: Step) -> Numbers:
        return step.after.y - self.origins(len(step.after.y))[:, 1]


def _lead(step: Step) -> Numbers:
    """Lead of each robot over the mean of all, along the lines [m]."""
    return step.after.x - step.after.x.mean()


def _nearest(step: Step) -> tuple[Numbers, Numbers]:
    """Center of mass of the nearest other robot, along each robot's own heading and to the left of it [m]."""
    x = step.after.x - step.after.x[:, np.newaxis]
    y = step.after.y - step.after.y[:, np.newaxis]
    distance = np.hypot(x, y)
    np.fill_diagonal(distance, np.inf)
    robots = np.arange(len(x))
    nearest = distance.argmin(axis=1)
    return in_body_axes(step.after, x[robots, nearest], y[robots, nearest])


def _touches(step: Step) -> Numbers:
    """1 for a robot with a contact force on it at the end of the step, else 0."""
    observations = step.after.observations
    return np.array([float(np.any(observation.contact_force)) for observation in observations])
