"""What is in a trial: arrays, what swam and how, how it ended."""

import dataclasses
import datetime
from collections.abc import Mapping

from laticauda.errors import BadArgument, flag, instance, text
from laticauda.gaits import Gait
from laticauda.interfaces import Log
from laticauda.robot import Ground, Robot, Water
from laticauda.scenarios import Experiment, Scenario
from laticauda.trial import arrays
from laticauda.trial.arrays import AnyArray, Setting

FORCE_COMPONENTS = ("drag", "added_mass", "effector")
WORK_KINDS = ("absolute", "net", "positive")
NOT_NEEDED = (
    "heading",
    "heading_rate",
    "link_angle",
    "joint_angle",
    "joint_rate",
    "joint_angle_ref",
    "joint_torque",
    "work",
)
"""What a measured trial may lack; where the robot was is what every trial has."""


def _now() -> str:
    return datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds")


@dataclasses.dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Contents(Log):
    """What a trial holds, a log and what made it, checked; `Trial` adds what follows from it.

    All arrays are float64, finite and read-only. A log in the plane has one column per link of `robot.planar()`, a log
    in space (three columns in `center_of_mass`) one per module of `robot`. Nothing about a trial can be changed:
    `dataclasses.replace` makes another one.

    Raises:
        ValueError: If an array has the wrong shape, holds something else than finite numbers, or time does not
            increase.
    """

    scenario: Scenario | Experiment
    """What swam, how, where and by which model: `laticauda.swim` makes the same trial of a scenario again. An
    experiment says what is known of a run that was measured, or steered by hand."""
    version: str
    """Version of laticauda that made the run."""
    created: str = dataclasses.field(default_factory=_now)
    """When it was made: date and time of day with its zone, ISO 8601."""
    status: str = "The run reached its end."
    """How the run ended: a sentence, with advice where it failed."""
    succeeded: bool = True
    """Whether the run reached its end."""
    not_measured: tuple[str, ...] = ()
    """Arrays that nobody measured, see `NOT_NEEDED`: they hold zeros, and figures that need them refuse."""
    state: Mapping[str, AnyArray] = dataclasses.field(default_factory=dict[str, AnyArray])
    """The plant's final state, from which the run can go on; empty where there is none."""

    def __post_init__(self) -> None:
        """Check everything and freeze every array, once."""
        instance("scenario", self.scenario, Scenario, Experiment)
        flag("succeeded", self.succeeded)
        for name in ("version", "created", "status"):
            text(name, getattr(self, name))
        for name, value in self._clean().items():
            object.__setattr__(self, name, value)
        object.__setattr__(self, "not_measured", arrays.names("not_measured", self.not_measured, NOT_NEEDED))

    @property
    def robot(self) -> Robot:
        """What swam."""
        return self.scenario.robot

    @property
    def gait(self) -> Gait | None:
        """What the joints were asked for, at first where it was steered; None where no gait was."""
        return self.scenario.gait

    @property
    def environment(self) -> Water | Ground:
        """What it swam or crawled in."""
        return self.scenario.environment

    @property
    def settings(self) -> Mapping[str, Setting]:
        """How the run was made, in texts and numbers: controller and model, or what is known of an experiment."""
        return self.scenario.settings

    def _clean(self) -> dict[str, object]:
        """Arrays and mappings as they are kept."""
        time = arrays.times("time", self.time)
        n = time.size
        center_of_mass = arrays.floats("center_of_mass", self.center_of_mass, (n, None))
        n_axes = center_of_mass.shape[1]
        if n_axes not in (2, 3):
            raise BadArgument("center_of_mass", f"must have 2 or 3 columns, got {n_axes}")
        n_links = (self.robot if n_axes == 3 else self.robot.planar()).n_links

        shapes: dict[str, tuple[int, ...]] = {
            "center_of_mass_velocity": (n, n_axes),
            "heading": (n,),
            "heading_rate": (n,),
            "link_angle": (n, n_links),
            "joint_angle": (n, n_links - 1),
            "joint_rate": (n, n_links - 1),
            "joint_angle_ref": (n, n_links - 1),
            "joint_torque": (n, n_links - 1),
            "work": (n, len(WORK_KINDS)),
        }
        if self.electrical_work is not None:
            shapes["electrical_work"] = (n,)
        clean: dict[str, object] = {"time": time, "center_of_mass": center_of_mass}
        clean |= {name: arrays.floats(name, getattr(self, name), shape) for name, shape in shapes.items()}
        clean["link_force"] = arrays.forces(self.link_force, (n, n_links, n_axes))
        clean["signals"] = arrays.signals(self.signals, n)
        state = arrays.mapping("state", self.state)
        clean["state"] = {key: arrays.state_array(key, value) for key, value in state.items()}
        return clean

    def equals(self, other: object) -> bool:
        """Whether `other` is a trial that holds the same, bit for bit: every array, setting and text."""
        if not isinstance(other, Contents):
            return False
        names = (field.name for field in dataclasses.fields(self))
        return all(arrays.same(getattr(self, name), getattr(other, name)) for name in names)

    def need(self, purpose: str, *names: str) -> None:
        """Refuse a measured trial that lacks something.

        Args:
            purpose: What it is needed for, in words.
            names: Of arrays, as in `not_measured`.

        Raises:
            ValueError: If one of them was not measured.
        """
        for name in names:
            if name in self.not_measured:
                raise ValueError(f"The trial must have a measured `{name}` for {purpose}, and it has none.")
