"""The log of one run, simulated or real: what everything that swims hands over, and everything that looks at it takes.

What is sampled stands in `contents`; the figures of the run are properties, defined in `metrics`.
"""

import math
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Literal, Self

import numpy as np

from laticauda.robot import Ground, Robot, Water
from laticauda.trial import formats, metrics
from laticauda.trial.arrays import Axes, FinJoints
from laticauda.trial.contents import Contents
from laticauda.trial.cycles import CycleMean, cycle_mean
from laticauda.trial.dataset import fields_of, to_dataset
from laticauda.trial.figures import figures

if TYPE_CHECKING:
    import xarray


class Trial(Contents):
    """The time-stamped log of one run, with its robot, its gait and how it ended: see `Contents`."""

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

    # ---- files and tables ----------------------------------------------------------------------------------------

    def summary(self) -> dict[str, object]:
        """All figures of the run with how it ended, ready for JSON, of a failed run too.

        Returns:
            In this order: `status`, `succeeded`, `robot`, `gait` and `environment` by name, `mean_power_kind`, every
            figure of `FIGURES` in SI units, None where it has no meaning for this run, and `not_available`: the reason
            for each None.
        """
        values, reasons = figures(self)
        return {
            "status": self.status,
            "succeeded": self.succeeded,
            "robot": self.robot.name,
            "gait": None if self.gait is None else self.gait.kind,
            "environment": self.environment.name,
            "mean_power_kind": self.mean_power_kind,
            **values,
            "not_available": reasons,
        }

    def save(self, path: str | Path) -> None:
        """Write the trial to a file, from which `load_trial` makes an equal one.

        The ending says the format, see `Format`; any other one means netCDF. A CSV file holds the time series only. An
        older file of that name is replaced, but not before the new one is complete.

        Args:
            path: The file.

        Raises:
            StorageFailed: If the file cannot be written; the message has its name and the reason.
            MissingExtra: If the format needs a package that is not installed.
        """
        formats.save(to_dataset(self), Path(path))

    def to_csv(self, path: str | Path) -> None:
        """Write the time series to a CSV file, one row per sample: `joint_angle_0 [rad]` is the tail-most joint's.

        Args:
            path: The file, whatever its ending; an older one of that name is replaced.

        Raises:
            StorageFailed: If the file cannot be written; the message has its name and the reason.
        """
        formats.save(to_dataset(self), Path(path), "csv")

    def to_dataset(self) -> "xarray.Dataset":
        """The trial as an xarray Dataset: dimensions, units and names as in its file."""
        return to_dataset(self)

    @classmethod
    def from_dataset(cls, dataset: "xarray.Dataset") -> Self:
        """The trial that `to_dataset` made a Dataset of, equal bit for bit.

        Args:
            dataset: As `to_dataset` made it, or as a format read it.

        Raises:
            KeyError: If a variable or an attribute is missing.
            ValueError: If what it says is no trial.
        """
        return cls(**fields_of(dataset))

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
