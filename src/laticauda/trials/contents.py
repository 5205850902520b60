"""Contents of a trial: its arrays, what swam and how, and how the run ended."""

import dataclasses
from collections.abc import Mapping
from datetime import UTC, datetime

import numpy as np

from laticauda.motion import gaits
from laticauda.robot import Ground, Robot, Water
from laticauda.scenarios import Experiment, Scenario
from laticauda.trials import arrays
from laticauda.trials.arrays import AnyArray, FinJoints, Setting
from laticauda.values import BadArgument, check_flag, check_instance, check_text, series

REACHED_END = "The run reached its end."
"""Status of a run that succeeded."""
FORCE_COMPONENTS = ("drag", "added_mass", "effector")
_NEEDED = ("time", "center_of_mass", "center_of_mass_velocity", *series.OPTIONAL_SERIES)
NOT_NEEDED = tuple(name for name in series.SERIES if name not in _NEEDED)
"""Arrays that a measured trial may lack; the position of the robot is in every trial."""


def shapes_of(robot: Robot, n_samples: int, n_axes: int) -> dict[str, tuple[int, ...]]:
    """Return the shapes of the arrays of a trial by name.

    Args:
        robot: The robot that swims.
        n_samples: Number of samples.
        n_axes: 2 in the plane, 3 in space.
    """
    chain = robot if n_axes == 3 else robot.planar()
    length_of = {
        "time": n_samples,
        "axis": n_axes,
        "link": chain.n_links,
        "joint": chain.n_links - 1,
        "direction": len(series.DIRECTIONS),
        "3": 3,
    }
    shapes: dict[str, tuple[int, ...]] = {}
    for name, description in series.SERIES.items():
        shapes[name] = tuple(length_of[dimension] for dimension in description.dimensions)
    return shapes


def _moment_now() -> str:
    return datetime.now(UTC).isoformat(timespec="seconds")


@dataclasses.dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Contents(series.Log):
    """What a trial holds, a log and its origin, validated; `Trial` adds what is derived from it.

    All arrays are float64, finite and read-only. A log in the plane has one column per link of
    `robot.planar()`, a log in space (three columns in `center_of_mass`) one per module of `robot`.
    A trial is immutable: use `dataclasses.replace` to make a modified copy.

    Raises:
        ValueError: If an array has the wrong shape, holds anything other than finite numbers, or
            time does not increase.
    """

    scenario: Scenario | Experiment
    """What swam, how, where and by which model: given a scenario, `laticauda.swim` reproduces the trial. An experiment
    states what is known of a run that was measured, or steered by hand."""
    version: str
    """Version of laticauda that made the run."""
    created: str = dataclasses.field(default_factory=_moment_now)
    """Creation date and time of day with time zone, ISO 8601."""
    status: str = REACHED_END
    """How the run ended: a sentence, with advice if it failed."""
    succeeded: bool = True
    """Whether the run reached its end."""
    not_measured: tuple[str, ...] = ()
    """Arrays that were not measured, see `NOT_NEEDED`: they hold zeros, and figures that need them raise an error."""
    state: Mapping[str, AnyArray] = dataclasses.field(default_factory=dict[str, AnyArray])
    """The plant's final state, from which the run can be continued; empty if there is none."""

    def __post_init__(self) -> None:
        """Validate everything and freeze every array, once."""
        check_instance("scenario", self.scenario, Scenario, Experiment)
        check_flag("succeeded", self.succeeded)
        for name in ("version", "created", "status"):
            check_text(name, getattr(self, name))
        for name, value in self._clean().items():
            object.__setattr__(self, name, value)
        not_measured = arrays.choose_names("not_measured", self.not_measured, NOT_NEEDED)
        object.__setattr__(self, "not_measured", not_measured)

    @property
    def robot(self) -> Robot:
        """The robot that swam."""
        return self.scenario.robot

    @property
    def gait(self) -> gaits.Gait | None:
        """The commanded gait, for a steered run the initial one; None if there was no gait."""
        return self.scenario.gait

    @property
    def environment(self) -> Water | Ground:
        """The environment in which the robot swam or crawled."""
        return self.scenario.environment

    @property
    def settings(self) -> Mapping[str, Setting]:
        """Settings of the run as texts and numbers: controller and model, or what is known of an experiment."""
        return self.scenario.settings

    @property
    def period(self) -> float | None:
        """Period of the gait, 2 pi / frequency [s]; None without a gait, or if the gait stands still."""
        if self.gait is None or self.gait.frequency <= 0.0:
            return None
        return 2.0 * np.pi / self.gait.frequency

    @property
    def chain(self) -> Robot:
        """The robot whose links correspond to the columns of `link_angle`."""
        if self.center_of_mass.shape[1] == 3:
            return self.robot
        return self.robot.planar()

    @property
    def fin_angle(self) -> FinJoints:
        """Angles of the joints of a driven or flexible fin, from its root on; 0 if the signals lack them [rad]."""
        return self._of_fin("fin_angle")

    @property
    def fin_rate(self) -> FinJoints:
        """Rates of the same fin joints [rad/s]."""
        return self._of_fin("fin_rate")

    def _of_fin(self, name: str) -> FinJoints:
        n_samples = self.time.size
        zeros = np.zeros(n_samples)
        series = [self.signals.get(f"{name}_{joint}", zeros) for joint in self.robot.fin_joints]
        return np.array(series).reshape(-1, n_samples).T

    def _clean(self) -> dict[str, object]:
        """Return the arrays and mappings as they are stored."""
        clean: dict[str, object] = {"time": arrays.check_times("time", self.time)}
        center = arrays.check_floats("center_of_mass", self.center_of_mass, (len(self.time), None))
        n_axes = center.shape[1]
        if n_axes not in (2, 3):
            raise BadArgument("center_of_mass", f"must have 2 or 3 columns, got {n_axes}")
        shapes = shapes_of(self.robot, len(self.time), n_axes)
        for name, shape in shapes.items():
            values = getattr(self, name)
            if name != "time" and values is not None:
                clean[name] = arrays.check_floats(name, values, shape)
        if self.link_force is not None:
            shape = (*shapes["link_angle"], n_axes)
            clean["link_force"] = arrays.check_each("link_force", self.link_force, shape)
        # A sensor tells nothing where there is no echo, or before its first reading.
        model = self.scenario.model
        names_of_readings: tuple[str, ...] = ()
        if model is not None:
            names_of_readings = model.names_of_readings
        clean["signals"] = arrays.check_each(
            "signals", self.signals, (len(self.time),), may_lack=names_of_readings
        )
        state = arrays.check_mapping("state", self.state)
        clean["state"] = {
            name: arrays.check_state_array(name, values) for name, values in state.items()
        }
        return clean

    def equals(self, other: object) -> bool:
        """Return whether `other` is a trial with the same contents, bit for bit: every array, setting and text."""
        if not isinstance(other, Contents):
            return False
        for field in dataclasses.fields(self):
            if not arrays.are_same(getattr(self, field.name), getattr(other, field.name)):
                return False
        return True

    def need(self, purpose: str, *names: str) -> None:
        """Reject a measured trial that lacks required arrays.

        Args:
            purpose: What they are needed for, in words.
            names: Names of the arrays, as in `not_measured`.

        Raises:
            ValueError: If one of them was not measured.
        """
        for name in names:
            if name in self.not_measured:
                raise ValueError(
                    f"The trial must have a measured `{name}` for {purpose}, and it has none."
                )
