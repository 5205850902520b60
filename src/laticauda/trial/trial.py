"""The log of one run, simulated or real: what everything that swims hands over, and everything that looks at it takes.

It holds what was sampled and under which settings; the figures of the run are properties, defined in `metrics`.
"""

import dataclasses
import datetime
import math
from collections.abc import Mapping
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np

from laticauda.gaits import Gait
from laticauda.robot import Ground, Robot, Water
from laticauda.trial import contents, metrics
from laticauda.trial.contents import AnyArray, Axes, FinJoints, Forces, Joints, Links, Plane, Samples, Setting, Work
from laticauda.trial.cycles import CycleMean, cycle_mean

if TYPE_CHECKING:
    import xarray

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
class Trial:
    """The time-stamped log of one run, with its robot, its gait and how it ended.

    Time is the first axis of every array; links and joints are numbered tail first; all arrays are float64, finite
    and read-only. A log in the plane has one column per link of `robot.planar()`, a log in space (three columns in
    `center_of_mass`) one per module of `robot`. Nothing about a trial can be changed: `dataclasses.replace` makes
    another one.

    Raises:
        ValueError: If an array has the wrong shape, holds something else than finite numbers, or time does not
            increase.
    """

    time: Samples
    """When each sample was taken [s], strictly increasing."""
    center_of_mass: Plane
    """Position of the center of mass, with the fin's mass, world axes [m]."""
    center_of_mass_velocity: Plane
    """Its velocity, world axes [m/s]."""
    heading: Samples
    """Mean angle of the body's links (6), unwrapped, without the fin [rad]."""
    heading_rate: Samples
    """Its rate [rad/s]."""
    link_angle: Links
    """Angle of each link to the world x axis, counter-clockwise [rad]."""
    joint_angle: Joints
    """Angle of each joint, head side minus tail side [rad]."""
    joint_rate: Joints
    """Its rate [rad/s]."""
    joint_angle_ref: Joints
    """What the joint was asked for [rad]."""
    joint_torque: Joints
    """Torque of each joint's drive; its power is torque times rate [N m]."""
    work: Work
    """Work of the joints so far: of sum |u phi'|, of sum u phi', of sum max(u phi', 0) [J]."""
    electrical_work: Samples | None = None
    """Electrical work so far, above idle, by a power model or a power meter; None where there is none [J]."""
    link_force: Mapping[str, Forces] | None = None
    """Force on each link by component (drag, added_mass, effector), world axes; None if not asked for [N]."""
    signals: Mapping[str, Samples] = dataclasses.field(default_factory=dict[str, Samples])
    """What a controller had in mind, held between control instants (`control` says which), and what else a plant logs:
    the spatial one `orientation_w` to `orientation_z` of module 0, a quaternion; often empty [SI]."""
    robot: Robot
    """What swam."""
    gait: Gait | None = None
    """What the joints were asked for; None where no gait was."""
    environment: Water | Ground
    """What it swam or crawled in."""
    settings: Mapping[str, Setting] = dataclasses.field(default_factory=dict[str, Setting])
    """How the run was made: model, joints, dt [s], offset_bandwidth [rad/s], ramp [s] and the like."""
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
        contents.instance("robot", self.robot, Robot)
        contents.instance("gait", self.gait, Gait, type(None))
        contents.instance("environment", self.environment, Water, Ground)
        contents.instance("succeeded", self.succeeded, bool)
        for name in ("version", "created", "status"):
            contents.instance(name, getattr(self, name), str)
        for name, value in self._clean().items():
            object.__setattr__(self, name, value)
        object.__setattr__(self, "not_measured", contents.names("not_measured", self.not_measured, NOT_NEEDED))

    def _clean(self) -> dict[str, object]:
        """Arrays and mappings as they are kept."""
        time = contents.times("time", self.time)
        n = time.size
        center_of_mass = contents.floats("center_of_mass", self.center_of_mass, (n, None))
        n_axes = center_of_mass.shape[1]
        if n_axes not in (2, 3):
            raise ValueError(f"`center_of_mass` must have 2 or 3 columns, got {n_axes}.")
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
        clean |= {name: contents.floats(name, getattr(self, name), shape) for name, shape in shapes.items()}
        clean["link_force"] = contents.forces(self.link_force, (n, n_links, n_axes))
        clean["signals"] = contents.signals(self.signals, n)
        settings, state = contents.mapping("settings", self.settings), contents.mapping("state", self.state)
        clean["settings"] = {key: contents.setting(key, value) for key, value in settings.items()}
        clean["state"] = {key: contents.state_array(key, value) for key, value in state.items()}
        return clean

    # ---- figures: definitions in `metrics` -----------------------------------------------------------------------

    @property
    def duration(self) -> float:
        """Length of the log [s]."""
        return metrics.duration(self.time)

    @property
    def period(self) -> float | None:
        """Period of the gait, 2 pi / frequency [s]; None without a gait, or if it stands still."""
        return 2.0 * math.pi / self.gait.frequency if self.gait is not None and self.gait.frequency > 0.0 else None

    @property
    def forward_velocity(self) -> float:
        """Straight-line displacement / time over the whole run (5) [m/s]."""
        return metrics.forward_velocity(self.time, self.center_of_mass)

    @cached_property
    def steady_velocity(self) -> float:
        """The same over whole gait cycles after the first third of the run and 10 s [m/s]."""
        return metrics.steady_velocity(self.time, self.center_of_mass, self.center_of_mass_velocity, self.period)

    @cached_property
    def path_speed(self) -> float:
        """Length of the center of mass's path / time [m/s]."""
        return metrics.path_speed(self.time, self.center_of_mass)

    @property
    def speed_through_water(self) -> float:
        """As `forward_velocity`, relative to the water: the current is taken off [m/s]."""
        return float(np.linalg.norm(self._velocity_through_water))

    @property
    def mechanical_power(self) -> float:
        """Mean of sum |u phi'| over the run [W]."""
        self.need("a mechanical power", "work")
        return metrics.mean_power(self.time, self.work[:, 0])

    @property
    def net_power(self) -> float:
        """Mean of sum u phi': braking joints give their power back [W]."""
        self.need("a mechanical power", "work")
        return metrics.mean_power(self.time, self.work[:, 1])

    @property
    def positive_power(self) -> float:
        """Mean of sum max(u phi', 0): braking joints cost nothing [W]."""
        self.need("a mechanical power", "work")
        return metrics.mean_power(self.time, self.work[:, 2])

    @property
    def electrical_power(self) -> float:
        """Mean electrical power above idle (4) [W].

        Raises:
            ValueError: If the run has no power model.
        """
        if self.electrical_work is None:
            raise ValueError("The trial must have an `electrical_work` for an electrical power: it has no power model.")
        return metrics.mean_power(self.time, self.electrical_work)

    @property
    def total_power(self) -> float:
        """`electrical_power` with what the robot draws at rest, `robot.idle_power` (Mamba: V I_0 = 41.3 W) [W].

        Raises:
            ValueError: If the run has no power model.
        """
        return self.electrical_power + self.robot.idle_power

    @property
    def mean_power(self) -> float:
        """The electrical power, or the mechanical one if there is no power model: see `mean_power_kind` [W]."""
        return self.mechanical_power if self.electrical_work is None else self.electrical_power

    @property
    def mean_power_kind(self) -> Literal["mechanical", "electrical"]:
        """Which power `mean_power` is."""
        return "mechanical" if self.electrical_work is None else "electrical"

    @property
    def cost_of_transport(self) -> float:
        """`mean_power` / (W v) with W the weight of the displaced water, on ground the robot's own [-].

        Raises:
            ValueError: If the robot did not move.
        """
        weight = metrics.carried_weight(self.robot, self.environment)
        return metrics.cost_of_transport(self.mean_power, weight, self.forward_velocity)

    @property
    def joules_per_meter(self) -> float:
        """`mean_power` / `forward_velocity` [J/m].

        Raises:
            ValueError: If the robot did not move.
        """
        return metrics.joules_per_meter(self.mean_power, self.forward_velocity)

    @cached_property
    def quasi_propulsive_efficiency(self) -> float:
        """Towing power of the straight robot at its speed through the water / mechanical power [-].

        Raises:
            ValueError: On ground, or if the joints did no work.
        """
        speed = self.speed_through_water
        drag = metrics.towing_drag(self._chain, self._water("a towing drag"), speed)
        return metrics.quasi_propulsive_efficiency(drag, speed, self.mechanical_power)

    @property
    def linear_drag_share(self) -> float:
        """Share of the linear term in the axial drag at the robot's speed through the water [-].

        Raises:
            ValueError: On ground, or in water without drag.
        """
        return metrics.linear_drag_share(self._water("a share of the linear drag"), self.speed_through_water)

    @cached_property
    def heading_cycle_mean(self) -> CycleMean:
        """Heading averaged over the gait cycle around each moment: times [s] and values [rad].

        Raises:
            ValueError: If there is no gait, or the run is shorter than one cycle.
        """
        self.need("a mean heading", "heading")
        return cycle_mean(self.time, self.heading, self.heading_rate, self._known_period)

    @cached_property
    def course(self) -> float:
        """Direction of travel over the steady part, from the world x axis [rad].

        Raises:
            ValueError: If the run is too short, or the robot stands still.
        """
        return metrics.course(self.time, self.center_of_mass, self.center_of_mass_velocity, self.period)

    @cached_property
    def sideslip(self) -> float:
        """Course minus heading over the steady part, as cycle means; positive: it drifts to its left [rad].

        Raises:
            ValueError: If there is no gait, the run is too short, or the robot stands still.
        """
        self.need("a sideslip", "heading")
        path = self.time, self.center_of_mass, self.center_of_mass_velocity
        return metrics.sideslip(*path, self.heading, self.heading_rate, self._known_period)

    @cached_property
    def turning_rate(self) -> float:
        """Slope of `heading_cycle_mean` over the steady part; positive to the left [rad/s].

        Raises:
            ValueError: If there is no gait, or the run is too short.
        """
        self.need("a turning rate", "heading")
        return metrics.turning_rate(self.time, self.heading, self.heading_rate, self._known_period)

    @cached_property
    def strouhal_number(self) -> float:
        """Strouhal number f A / U of the trailing edge over the steady part [-].

        Raises:
            ValueError: If there is no gait, the run is too short, or the robot stands still.
        """
        self.need("a Strouhal number", "link_angle")
        path = self.time, self.center_of_mass, self.center_of_mass_velocity
        return metrics.strouhal_number(*path, self.link_angle, self._chain, self._known_period, self.fin_angle)

    @property
    def fin_angle(self) -> FinJoints:
        """Angles of the joints of a fin that is driven or bends, from its root on; 0 where it lacks them [rad]."""
        return self._of_fin("fin_angle")

    @property
    def fin_rate(self) -> FinJoints:
        """Their rates [rad/s]."""
        return self._of_fin("fin_rate")

    def _of_fin(self, name: str) -> np.ndarray:
        fin = self.robot.caudal_fin
        joints = range(0 if fin.joint is not None else 1, fin.n_hinges + 1) if fin is not None else ()
        nothing = np.zeros(self.time.size)
        return np.array([self.signals.get(f"{name}_{k}", nothing) for k in joints]).reshape(-1, self.time.size).T

    # ---- files and tables: late imports keep the libraries behind them out of a plain run -------------------------

    def summary(self) -> dict[str, object]:
        """All figures with how the run ended, in the order of a table, ready for JSON; see `summary.summary`."""
        from laticauda.trial.summary import summary

        return summary(self)

    def save(self, path: str | Path) -> None:
        """Write the trial to the file `path`, for `load_trial`; its ending says the format, see `files.save_trial`."""
        from laticauda.trial.files import save_trial

        save_trial(self, path)

    def to_csv(self, path: str | Path) -> None:
        """Write the time series to the CSV file `path`, for a spreadsheet; see `files.write_csv`."""
        from laticauda.trial.files import write_csv

        write_csv(self, path)

    def to_dataset(self) -> "xarray.Dataset":
        """The trial as an xarray Dataset: dimensions, units and names as in its file."""
        from laticauda.trial.files import to_dataset

        return to_dataset(self)

    def equals(self, other: object) -> bool:
        """Whether `other` is a trial that holds the same, bit for bit: every array, setting and text."""
        if not isinstance(other, Trial):
            return False
        names = (field.name for field in dataclasses.fields(self))
        return all(contents.same(getattr(self, name), getattr(other, name)) for name in names)

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

    def __repr__(self) -> str:
        """On one line: who swam what for how long, and how it ended."""
        gait = "no gait" if self.gait is None else self.gait.kind
        span = f"{self.time[-1] - self.time[0]:g} s in {self.time.size} samples"
        return f"<Trial of {self.robot.name}: {gait}, {span}; {self.status}>"

    # ---- inside --------------------------------------------------------------------------------------------------

    @cached_property
    def _chain(self) -> Robot:
        """The robot whose links the columns of `link_angle` are."""
        return self.robot if self.center_of_mass.shape[1] == 3 else self.robot.planar()

    @property
    def _known_period(self) -> float:
        if self.period is None:
            raise ValueError("The trial must have a gait that moves for a figure over whole gait cycles.")
        return self.period

    @property
    def _velocity_through_water(self) -> Axes:
        velocity = metrics.mean_velocity(self.time, self.center_of_mass)
        if isinstance(self.environment, Water):
            velocity[:2] -= self.environment.current
        return velocity

    def _water(self, figure: str) -> Water:
        if isinstance(self.environment, Ground):
            raise ValueError(f"The environment must be water for {figure}; on ground there is none.")
        return self.environment
