"""The log of one run, simulated or real: the output of everything that swims, and the input of every analysis.

The sampled data are defined in `contents`; the figures of the run are declared here and computed in
`metrics`.
"""

from collections.abc import Callable, Mapping
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, Self, overload

import numpy as np

from laticauda.trials import contents, cycles, edge, metrics, moving_water, side_pressure
from laticauda.trials.dataset import fields_of, save, to_dataset
from laticauda.trials.feasibility import Feasibility, judge_feasibility, make_peak_figure
from laticauda.trials.load_figures import LOAD_FIGURES, make_load_figure
from laticauda.values import BadArgument, RunFailed, Suggesting, display_unit, html_table

if TYPE_CHECKING:
    import xarray
    from matplotlib import animation, axes, figure


MEANT = {
    "current": ("environment.current",),
    "dt": ("scenario.model.dt",),
    "efficiency": ("cost_of_transport", "quasi_propulsive_efficiency"),
    "energy": ("work", "joules_per_meter"),
    "error": ("status",),
    "export": ("save",),
    "incidence": ("edge_incidence",),
    "fluid": ("environment",),
    "from_file": ("laticauda.load_trial",),
    "joint_angles": ("joint_angle",),
    "lateral_force": ("joint_force", "peak_shear_force"),
    "load": ("laticauda.load_trial",),
    "params": ("scenario",),
    "path": ("center_of_mass", "plot_path"),
    "path_length": ("path_speed",),
    "pos": ("center_of_mass",),
    "position": ("center_of_mass",),
    "positions": ("center_of_mass",),
    "power": ("mean_power", "mechanical_power", "electrical_power"),
    "problems": ("feasibility.problems",),
    "read": ("laticauda.load_trial",),
    "result": ("summary",),
    "results": ("summary",),
    "show": ("plot", "animate"),
    "speed": ("forward_velocity", "steady_velocity"),
    "strouhal": ("strouhal_number",),
    "success": ("succeeded",),
    "t": ("time",),
    "times": ("time",),
    "to_csv": ('save, as in trial.save("run.csv")',),
    "to_dataframe": ("to_dataset().to_dataframe()",),
    "torque": ("joint_torque", "peak_joint_torque"),
    "torques": ("joint_torque", "peak_joint_torque"),
    "trajectory": ("center_of_mass", "plot_path"),
    "v": ("forward_velocity", "center_of_mass_velocity"),
    "velocities": ("center_of_mass_velocity",),
    "velocity": ("forward_velocity", "center_of_mass_velocity"),
    "video": ("animate",),
    "water": ("environment",),
    "x": ("center_of_mass",),
    "y": ("center_of_mass",),
    "yaw": ("heading",),
}
"""Names of a trial by names that people try in vain; a name that is merely mistyped needs no entry."""


class Figure:
    """One figure of a run: a property of `Trial`, computed once, that tables show with its unit and title.

    Args:
        unit: Unit of the figure; "" for a pure number.
        title: Title, in a few words.
        of: Function that computes the figure of a trial; it raises a ValueError that states why
            there is none.

    Access to a figure that is not finite raises an error, and so does access to any figure of a run
    that failed: numbers of a motion that blew up look like others. The time series of such a run stay
    readable.
    """

    def __init__(self, unit: str, title: str, of: Callable[[Any], float]) -> None:
        self.name = ""
        self.unit, self.title, self._of = unit, title, of
        self.__doc__ = f"{title[0].upper()}{title[1:]} [{unit or '-'}]."

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    @overload
    def __get__(self, trial: None, owner: type) -> Self: ...
    @overload
    def __get__(self, trial: contents.Contents, owner: type) -> float: ...
    def __get__(self, trial: contents.Contents | None, owner: type) -> Self | float:
        if trial is None:
            return self
        if not trial.succeeded:
            raise RunFailed(trial.status)
        with np.errstate(all="ignore"):
            value = float(self._of(trial))
        if not np.isfinite(value):
            rule = "must be a finite number"
            raise BadArgument(self.name, f"{rule}, but this run's samples give {value}")
        vars(trial)[self.name] = value  # from now on, access finds it there
        return value


class Trial(Suggesting, contents.Contents):
    """The time-stamped log of one run, with its robot, its gait and how it ended: see `Contents`.

    A run that failed (`succeeded` is False) has no figures: each raises `RunFailed`, with the sentence of
    its `status`. Its time series hold what was computed or recorded until then.
    """

    _meant = MEANT

    # ---- figures: unit, title, definition; in the order of a table -------------------------------

    duration = Figure("s", "duration", lambda t: metrics.log_duration(t.time))
    forward_velocity = Figure(
        "m/s",
        "forward velocity, straight line over the whole run",
        lambda t: metrics.forward_velocity(t.time, t.center_of_mass),
    )
    """Straight-line displacement over ground / time over the whole run (5): a current is part of it [m/s]."""
    steady_velocity = Figure(
        "m/s",
        "steady velocity, over whole gait cycles after the transient",
        metrics.steady_velocity,
    )
    """`forward_velocity` over whole gait cycles after the first third of the run and 10 s [m/s]."""
    path_speed = Figure(
        "m/s", "path length over time", lambda t: metrics.path_speed(t.time, t.center_of_mass)
    )
    """Length of the center of mass's path / time [m/s]."""
    speed_through_water = Figure(
        "m/s",
        "speed through the water, straight line over the whole run",
        metrics.speed_through_water,
    )
    """`forward_velocity` relative to the water where the robot was: currents, and the drift of waves, are subtracted
    [m/s]; raises an error on ground."""
    steady_speed_through_water = Figure(
        "m/s",
        "steady speed through the water, over whole gait cycles after the transient",
        metrics.steady_speed_through_water,
    )
    """`steady_velocity` relative to the water where the robot was [m/s]; raises an error on ground."""
    mean_power = Figure(
        "W",
        "mean power, mechanical unless there is a power model",
        lambda t: t.mechanical_power if t.electrical_work is None else t.electrical_power,
    )
    """The electrical power, or the mechanical power if there is no power model: see `mean_power_kind` [W]."""
    mechanical_power = Figure(
        "W", "mechanical power, mean of sum |u phi'|", lambda t: metrics.work_power(t, 0)
    )
    net_power = Figure("W", "mechanical power, net", lambda t: metrics.work_power(t, 1))
    """Mean of sum u phi': braking joints return their power [W]."""
    positive_power = Figure(
        "W", "mechanical power, positive work only", lambda t: metrics.work_power(t, 2)
    )
    """Mean of sum max(u phi', 0): braking joints cost nothing [W]."""
    electrical_power = Figure("W", "electrical power above idle", metrics.electrical_power)
    """Mean electrical power above idle (4) [W]; raises an error if the run has no power model."""
    total_power = Figure(
        "W", "electrical power with idle", lambda t: t.electrical_power + t.robot.idle_power
    )
    """`electrical_power` plus what the robot draws at rest, `robot.idle_power` (Mamba: V I_0 = 41.3 W) [W]."""
    cost_of_transport = Figure(
        "",
        "cost of transport: mean power / (weight * speed)",
        lambda t: metrics.cost_of_transport(
            t.mean_power,
            metrics.carried_weight(t.robot, t.environment),
            metrics.transport_speed(t),
        ),
    )
    """`mean_power` / (W v) with W the weight of the displaced water and v the speed through it, on ground the robot's
    own weight and its speed [-]; raises an error if the robot did not move."""
    joules_per_meter = Figure(
        "J/m",
        "energy per meter, from mean power",
        lambda t: metrics.joules_per_meter(t.mean_power, metrics.transport_speed(t)),
    )
    """`mean_power` / `speed_through_water`, on ground `forward_velocity` [J/m]; raises an error if the robot did not
    move."""
    quasi_propulsive_efficiency = Figure(
        "",
        "towing power of the straight robot / mechanical power",
        metrics.quasi_propulsive_efficiency,
    )
    """Towing power of the straight robot at its speed through the water / mechanical power [-]; raises an error on
    ground, or if the joints did no work."""
    linear_drag_share = Figure("", "share of the linear term in the axial drag", metrics.drag_share)
    """Share of the linear term in the axial drag at the robot's speed through the water [-]; raises an error on ground,
    or in water without drag."""
    course = Figure("rad", "direction of travel, steady part", metrics.course)
    """Direction of travel over the steady part, from the world x axis [rad]; raises an error if the run is too short or
    the robot stands still."""
    sideslip = Figure("rad", "course minus heading, steady part", metrics.sideslip)
    """Course minus heading over the steady part, as cycle means; positive: the robot drifts to its left [rad]."""
    turning_rate = Figure("rad/s", "slope of the heading's cycle mean", metrics.turning_rate)
    """Slope of `heading_cycle_mean` over the steady part; positive to the left [rad/s]."""
    strouhal_number = Figure("", "Strouhal number of the trailing edge", metrics.strouhal_number)
    """Strouhal number f A / U of the trailing edge over the steady part, with U through the water [-]."""
    edge_incidence = Figure("rad", "largest incidence of the trailing edge", edge.edge_incidence)
    """Largest angle between the flow and the plate that ends in the trailing edge, after the first third of the run
    [rad]; see `laticauda.trials.describe_edge`."""

    peak_joint_angle = Figure(
        "rad", "largest joint angle, first cycle left out", make_peak_figure("peak_joint_angle")
    )
    """Largest |phi| of a joint; this and the next three figures exclude the first gait cycle [rad]."""
    peak_joint_rate = Figure("rad/s", "largest joint rate", make_peak_figure("peak_joint_rate"))
    """Largest |phi'| of a joint [rad/s]."""
    peak_joint_torque = Figure("N m", "largest joint torque", make_peak_figure("peak_joint_torque"))
    """Largest |u| of a joint [N m]."""
    utilization = Figure(
        "",
        "largest share used of joints, actuators and room between links",
        make_peak_figure("utilization"),
    )
    """Largest used share of a joint's limit, of an actuator's speed or duty, or of the room between links; above 1 the
    robot cannot do it: see `feasibility` [-]."""

    # ---- figures of a run with `link_forces` -----------------------------------------------------

    peak_bending_moment = Figure(
        "N m",
        "largest bending moment in a joint, first cycle left out",
        make_load_figure("peak_bending_moment"),
    )
    """Largest moment in a joint about the axes across the link on its tail side; this and the next five figures exclude
    the first gait cycle [N m]."""
    rms_bending_moment = Figure(
        "N m", "rms of the bending moment in a joint", make_load_figure("rms_bending_moment")
    )
    """Root mean square of the same, in the joint where that is largest [N m]."""
    peak_shear_force = Figure(
        "N", "largest shear force in a joint", make_load_figure("peak_shear_force")
    )
    """Largest force in a joint across the link on its tail side: lateral, in space also vertical [N]."""
    rms_shear_force = Figure(
        "N", "rms of the shear force in a joint", make_load_figure("rms_shear_force")
    )
    """Root mean square of the same, in the joint where that is largest [N]."""
    peak_axial_force = Figure(
        "N", "largest axial force in a joint", make_load_figure("peak_axial_force")
    )
    """Largest force in a joint along the link on its tail side, pressure or tension [N]."""
    rms_axial_force = Figure(
        "N", "rms of the axial force in a joint", make_load_figure("rms_axial_force")
    )
    """Root mean square of the same, in the joint where that is largest [N]."""

    @cached_property
    def feasibility(self) -> Feasibility:
        """What the run demands of joints and actuators, what they offer, and why the robot cannot do it, if so."""
        return judge_feasibility(self.chain, self, self.period, self.not_measured)

    @cached_property
    def pressure_difference(self) -> side_pressure.OfLinks:
        """Mean pressure on the right side of every link less that on its left, with `link_forces` only [Pa].

        It is the water's force across the link over the area of a side: drag and added mass, the
        fin's with the tail link's.
        """
        return side_pressure.pressure_difference(self)

    @property
    def mean_power_kind(self) -> Literal["mechanical", "electrical"]:
        """Kind of power that `mean_power` is."""
        if self.electrical_work is None:
            return "mechanical"
        return "electrical"

    @cached_property
    def heading_cycle_mean(self) -> cycles.CycleMean:
        """Heading averaged over the gait cycle around each moment: times [s] and values [rad].

        Raises:
            ValueError: If there is no gait, or the run is shorter than one cycle.
        """
        return metrics.heading_mean(self)

    def figures(self) -> tuple[dict[str, float | None], dict[str, str]]:
        """Return all figures of `FIGURES` by name, None if meaningless for this run, and the reasons, by name.

        Those of a run that failed are all None. With `link_forces`, those of what joints carry follow.
        """
        values: dict[str, float | None] = {}
        reasons: dict[str, str] = {}
        for figure in _figures_of(self):
            try:
                values[figure.name] = getattr(self, figure.name)
            except ValueError as reason:
                values[figure.name] = None
                reasons[figure.name] = str(reason)
        return values, reasons

    # ---- pictures --------------------------------------------------------------------------------

    def plot(self) -> "figure.Figure":
        """Plot the run in one figure: path, speed, joint angles and torques; or, if it followed a path, how well.

        A notebook displays it; `trial.plot().savefig("run.png")` writes a file.
        """
        from laticauda.show.figures import sheet

        return sheet(self)

    def plot_path(self, ax: "axes.Axes | None" = None) -> "axes.Axes":
        """Plot the path of the center of mass with the body drawn along it.

        Args:
            ax: Axes to draw in; None: a new figure, available as `figure` of the returned axes.
        """
        from laticauda.show.figures import path_strip

        return path_strip(self, ax)

    def animate(
        self, *, speed: float = 1.0, frames_per_second: float = 15.0
    ) -> "animation.FuncAnimation":
        """Animate the run, seen from above.

        A notebook displays it; `trial.animate().save("run.gif")` writes a file, as do .webp, and
        .mp4 with ffmpeg.

        Args:
            speed: Playback speed relative to real time [-].
            frames_per_second: Frame rate of the film [1/s].
        """
        from laticauda.show.figures import swim_film

        return swim_film(self, speed=speed, frames_per_second=frames_per_second)

    # ---- files and tables ------------------------------------------------------------------------

    def summary(self) -> dict[str, object]:
        """Return all figures of the run and how it ended, ready for JSON; also for a failed run.

        Returns:
            In this order: `status`, `succeeded`, `robot`, `gait` and `environment` by name,
            `mean_power_kind`, every figure of `FIGURES` in SI units, None where it has no meaning
            for this run, with `link_forces` those of what joints carry, and `not_available`: the
            reason for each None.
        """
        values, reasons = self.figures()
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
        """Write the trial to a file, from which `load_trial` restores an equal one.

        The extension sets the format, see `Format`; a name without one means netCDF. A CSV file,
        which Excel opens, holds the time series only. An older file of the same name is replaced,
        but not before the new one is complete.

        Args:
            path: The file.

        Raises:
            ValueError: If no format has the extension.
            StorageFailed: If the file cannot be written; the message gives its name and the reason.
            MissingExtra: If the format needs a package that is not installed.
        """
        save(to_dataset(self), Path(path))

    def to_dataset(self) -> "xarray.Dataset":
        """Convert the trial to an xarray Dataset, with dimensions, units and names as in its file."""
        return to_dataset(self)

    @classmethod
    def measured(cls, series: Mapping[str, Any], **more: Any) -> Self:
        """Build a trial from measured series; `not_measured` lists the others; work may come from torques and rates.

        Args:
            series: The arrays by name; omitted, or None, where nothing was measured.
            more: All other fields.

        Raises:
            ValueError: If the series do not form a valid trial.
        """
        arrays = {name: values for name, values in series.items() if values is not None}
        if "work" not in arrays and "joint_torque" in arrays and "joint_rate" in arrays:
            arrays["work"] = metrics.joint_work(
                arrays["time"], arrays["joint_torque"], arrays["joint_rate"]
            )
        n_samples, n_axes = np.shape(arrays["center_of_mass"])
        shapes = contents.shapes_of(more["scenario"].robot, n_samples, n_axes)
        missing = tuple(name for name in contents.NOT_NEEDED if name not in arrays)
        for name in missing:
            arrays[name] = np.zeros(shapes[name])
        return cls(**arrays, not_measured=missing, **more)

    @classmethod
    def from_dataset(cls, dataset: "xarray.Dataset") -> Self:
        """Restore the trial from which `to_dataset` made a Dataset, equal bit for bit.

        Args:
            dataset: The Dataset as made by `to_dataset`, or as read by a format.

        Raises:
            KeyError: If a variable or an attribute is missing.
            ValueError: If the content is not a trial.
        """
        return cls(**fields_of(dataset))

    def __repr__(self) -> str:
        """Return one line: who swam what for how long, and how it ended."""
        gait = "no gait" if self.gait is None else self.gait.kind
        log = f"{self.time[-1] - self.time[0]:g} s in {self.time.size} samples"
        if self.succeeded and self.time.size > 1:
            log += f", {self.forward_velocity:.3g} m/s"
        status = self.status
        if not self.succeeded:
            status = f"FAILED: {status}"
        elif self.feasibility.problems:
            status += f" The robot cannot do it: {self.feasibility.problems[0]}."
        return f"<Trial of {self.robot.name}: {gait}, {log}; {status}>"

    def _repr_html_(self) -> str:
        from laticauda.show.figures import picture_in_html

        values, _ = self.figures()
        rows: list[tuple[str, str]] = []
        if not self.succeeded:
            rows.append(("FAILED", self.status))
        for figure in shown_figures(self):
            value = values[figure.name]
            if value is not None:
                unit = display_unit(figure.unit)
                rows.append((figure.title, f"{unit.from_si(value):.4g} {unit.name}".rstrip()))
        picture = picture_in_html(self.plot_path(), repr(self)[1:-1])
        return f"{picture}{html_table(repr(self)[1:-1], rows)}"


def shown_figures(*trials: Trial) -> list[Figure]:
    """Return the figures that tables of some trials show.

    Those through the water only if it moves in one of them, and those of what joints carry only if one
    has loads.

    Args:
        trials: Any trials.
    """
    figures = _figures_of(*trials)
    is_moving = any(moving_water.water_moves(trial.environment) for trial in trials)
    if is_moving:
        return figures
    return [figure for figure in figures if figure.name not in moving_water.THROUGH_WATER]


def _figures_of(*trials: Trial) -> list[Figure]:
    """Return the figures that some trials have; those of what joints carry if one has loads."""
    if any(trial.joint_force is not None for trial in trials):
        return [*FIGURES, *_OF_LOADS]
    return list(FIGURES)


_ALL = tuple(value for value in vars(Trial).values() if isinstance(value, Figure))
FIGURES = tuple(figure for figure in _ALL if figure.name not in LOAD_FIGURES)
"""All figures of any trial, in the order of a table."""
_OF_LOADS = tuple(figure for figure in _ALL if figure.name in LOAD_FIGURES)
"""Those of a trial that was run with `link_forces`."""
