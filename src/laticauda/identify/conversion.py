"""Trials and tows as measurements: `from_trial` and `from_tow`."""

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

import laticauda as lc
from laticauda.identify.measurements import Measurement
from laticauda.identify.series import SERIES, series_of_trial
from laticauda.identify.towing import LOADS, Tow
from laticauda.models.simulate import UNITS
from laticauda.robot import Environment, Robot, Water
from laticauda.values import (
    BadArgument,
    RunFailed,
    check_choice,
    check_instance,
    check_whole_number,
)

STRAIGHT = lc.Gait(amplitude=0.0, frequency=1.0, phase_shift=0.5)
"""Gait without joint motion; without an amplitude, frequency and phase shift mean nothing."""
FORCE_SIGMA = 0.05
"""Noise of a force in a tow [N]."""
FORCE_SHARE = 0.02
"""Noise of a force in a tow, as a fraction of it [-]."""
MISALIGNMENT = math.radians(0.5)
"""Noise of the angle of a tow [rad]."""


def from_trial(
    trial: lc.Trial,
    *,
    name: str,
    figures: Mapping[str, float] | None = None,
    series: Mapping[str, float] | None = None,
    every: int = 1,
    group: str = "",
    free_start: bool = True,
) -> Measurement:
    """Convert a trial, simulated or recorded, to a measurement.

    The trial must begin straight, about where it says, and at rest. A gait without amplitude is a
    coast-down, which begins with the speed that it has.

    Args:
        trial: Trial that has a gait.
        name: Name in tables and messages.
        figures: Names of figures, and the standard deviation of the noise of each in its own unit.
        series: Names of series, with the same; of a path in space, its x and y.
        every: Stride between the samples of the series that are used. Samples so close that they
            share their noise add no information, and a fit that uses them all is overconfident.
        group: Group of measurements that are left out together; "": those of its gait, with or
            without fin.
        free_start: Whether its start is unknown to a fit, if a path or a heading is used; False:
            the start is exact.
            The first sample is as noisy as all others: if taken as exact, it shifts them.

    Raises:
        ValueError: If the trial has no gait, or an argument is out of its range.
        RunFailed: If the trial is of a run that failed: its numbers say nothing about the robot.
    """
    check_instance("trial", trial, lc.Trial)
    if not trial.succeeded:
        raise RunFailed(trial.status)
    if trial.gait is None:
        raise BadArgument("trial", "must have a gait to be identified from, got one without")
    stride = check_whole_number("every", every, 1)
    measured_figures: dict[str, Any] = {}
    for figure, sigma in (figures or {}).items():
        check_choice("figures", figure, tuple(UNITS))
        measured_figures[figure] = (_figure_of(trial, figure), sigma)
    measured_series: dict[str, Any] = {}
    for series_name, sigma in (series or {}).items():
        check_choice("series", series_name, tuple(SERIES))
        measured_series[series_name] = (series_of_trial(trial, series_name)[::stride], sigma)
    time = None
    if measured_series:
        time = trial.time[::stride] - trial.time[0]
    scenario = lc.Scenario(
        robot=trial.robot,
        motion=trial.gait,
        environment=trial.environment,
        start=_start_of(trial, trial.gait),
        duration=trial.duration,
        model=_model_of(trial),
    )
    return Measurement(
        name=name,
        scenario=scenario,
        group=group,
        free_start=free_start,
        figures=measured_figures,
        time=time,
        series=measured_series,
    )


def _figure_of(trial: lc.Trial, figure: str) -> Any:
    """Return a figure of a trial; x, y and heading are those at its end."""
    if figure == "x":
        return trial.center_of_mass[-1, 0]
    if figure == "y":
        return trial.center_of_mass[-1, 1]
    if figure == "heading":
        return trial.heading[-1]
    return getattr(trial, figure, None)


def _model_of(trial: lc.Trial) -> lc.Planar:
    """Return the usual model, with the smooth start of a simulated trial if that was not the usual one.

    The smooth start belongs to what the joints were told, as the gait does; the joints' law is the fit's.
    """
    model = trial.scenario.model
    if model is None or model.ramp is None:
        return lc.Planar()  # recorded, or as usual
    if model.ramp == model.joints.ramp:
        return lc.Planar()
    return lc.Planar(ramp=model.ramp)


def _start_of(trial: lc.Trial, gait: lc.Gait) -> lc.Start:
    """Return where a trial began, and the speed that it had if it is a coast-down."""
    x, y = trial.center_of_mass[0, :2].tolist()
    heading = float(trial.heading[0])
    speed = 0.0
    is_coast_down = gait.amplitude == 0.0
    if is_coast_down:
        speed = float(np.linalg.norm(trial.center_of_mass_velocity[0]))
    return lc.Start(center_of_mass=(x, y), heading=heading, velocity=speed)


def from_tow(
    robot: Robot,
    environment: Environment,
    tow: Tow,
    loads: Mapping[str, float] | None = None,
    *,
    name: str = "",
    sigma: float = FORCE_SIGMA,
    share: float = FORCE_SHARE,
    misalignment: float = MISALIGNMENT,
) -> Measurement:
    """Return the loads of a tow as a measurement, or as a candidate if none were measured.

    Args:
        robot: Robot that is towed, straight.
        environment: Water in which it is towed; the effect of errors of the angle is derived from
            it.
        tow: Speed and angle of the tow.
        loads: Loads by name, from `LOADS`; None: those computed for the water, for a straight tow
            only the drag.
        name: Name in tables and messages; empty: composed from the kind of tow, with or without
            fin.
        sigma: Standard deviation of the noise of a force [N]; for the moment, multiplied by half
            the robot's length.
        share: Additional standard deviation as a fraction of the load, from speed and calibration
            [-].
        misalignment: Standard deviation of the angle [rad].

    Raises:
        ValueError: If an argument is out of its range.
    """
    check_instance("environment", environment, Water)
    scenario = lc.Scenario(robot=robot, motion=STRAIGHT, environment=environment, duration=1.0)
    if loads is None:
        loads = _computed_loads(tow, scenario)
    turned_back = replace(tow, angle=tow.angle - misalignment).loads(scenario)
    turned_further = replace(tow, angle=tow.angle + misalignment).loads(scenario)
    figures: dict[str, tuple[float, float]] = {}
    for load_name, load in loads.items():
        check_choice("loads", load_name, tuple(LOADS))
        arm = 1.0
        if load_name == "yaw_moment":
            arm = 0.5 * robot.length
        by_misalignment = 0.5 * (turned_further[load_name] - turned_back[load_name])
        figures[load_name] = (load, math.hypot(arm * sigma, share * load, by_misalignment))
    return Measurement(
        name=name or _name_of_tow(tow, robot),
        scenario=scenario,
        figures=figures,
        tow=tow,
        group="tow",
    )


def _computed_loads(tow: Tow, scenario: lc.Scenario) -> dict[str, float]:
    """Return the loads that the water exerts; a robot towed ahead has only its drag."""
    loads = tow.loads(scenario)
    if tow.angle:
        return loads
    return {"drag": loads["drag"]}


def _name_of_tow(tow: Tow, robot: Robot) -> str:
    kind = "straight tow"
    if tow.angle:
        kind = f"oblique tow, {math.degrees(tow.angle):.3g} deg,"
    return f"{kind} at {tow.speed:g} m/s{fin_suffix(robot)}"


def fin_suffix(robot: Robot) -> str:
    """Return the end of the name of a measurement that tells whether the robot had its fin.

    Args:
        robot: Robot that swims or is towed.
    """
    if robot.caudal_fin is None:
        return ""
    return ", with fin"
