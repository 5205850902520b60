"""Numbers of a run, beside those of the paper."""

import math
from typing import Any, NamedTuple

import numpy as np

from laticauda.robot import Robot, Water
from laticauda.show.cockpit.changes import find_measured
from laticauda.show.cockpit.live import Live, read_tilt
from laticauda.show.cockpit.simulation import TICK, Simulation
from laticauda.show.reports import format_number
from laticauda.trials import MeasuredTrial, metrics
from laticauda.trials.feasibility import describe_ability, judge_feasibility
from laticauda.values import Log

RECENT = 800
"""Latest samples, over which joints and actuators are checked."""
SLOWEST_TRANSPORT = 1e-6
"""Velocity up to which there is no cost of transport [m/s]."""


def read_figures(live: Live) -> dict[str, Any]:
    """Return the figures of a `live` run since the scenario was last changed, by name; nan if not yet available.

    The elapsed `time` [s], the forward velocity (5), that over the last gait cycle, the speed through
    the water if it moves [m/s], the mean power, electrical with servos or a power model [W], the
    resulting cost of transport, which rests on the speed through the water [-],
    cross-track error [m], heading [rad], and `joints`: recent demands on the joints and their
    actuators, and why the robot cannot meet them, if so.

    Args:
        live: The run.
    """
    record, simulation = live.record()
    figures: dict[str, Any] = {
        "time": float(record.time[-1] - record.time[0]),
        "cross_track_error": simulation.cross_track_error,
        "heading": float(live.latest().heading),
        "forward_velocity": math.nan,
        "speed_through_water": math.nan,
        "cycle_velocity": math.nan,
        "mean_power": math.nan,
        "cost_of_transport": math.nan,
        "joints": "-",
    }
    if not figures["time"] > 0.0:
        return figures
    period = math.inf
    frequency = simulation.scenario.gait.frequency
    if frequency > 0.0:
        period = 2.0 * math.pi / frequency
    figures |= _measure_transport(record, simulation)
    figures["cycle_velocity"] = _measure_cycle_velocity(record, period)
    figures["joints"] = _describe_joints(simulation.plant.robot, record, period)
    return figures


def _measure_transport(record: Log, simulation: Simulation) -> dict[str, float]:
    """Return velocity, power and, if the robot advances, cost of transport."""
    velocity = metrics.forward_velocity(record.time, record.center_of_mass)
    work = record.work[:, 0]
    if record.electrical_work is not None:
        work = record.electrical_work
    power = metrics.mean_power(record.time, work)
    figures = {"forward_velocity": velocity, "mean_power": power}
    environment = simulation.scenario.environment
    transport_speed = velocity
    if isinstance(environment, Water) and not environment.is_still:
        transport_speed = metrics.speed_relative_to(environment, record.time, record.center_of_mass)
        figures["speed_through_water"] = transport_speed
    if transport_speed > SLOWEST_TRANSPORT:
        weight = metrics.carried_weight(simulation.plant.robot, environment)
        figures["cost_of_transport"] = metrics.cost_of_transport(power, weight, transport_speed)
    return figures


def _measure_cycle_velocity(record: Log, period: float) -> float:
    """Return the velocity over the last cycle of a gait; nan if the record is shorter, or samples are too sparse."""
    elapsed = float(record.time[-1] - record.time[0])
    if not TICK <= period < elapsed:
        return math.nan
    n_samples = round(period / TICK)
    position = record.center_of_mass
    distance = np.linalg.norm(position[-1] - position[-1 - n_samples])
    duration = record.time[-1] - record.time[-1 - n_samples]
    return float(distance / duration)


def _describe_joints(robot: Robot, record: Log, period: float) -> str:
    """Return recent demands on the joints, or why the robot cannot meet them."""
    cycle = period if math.isfinite(period) else None
    feasibility = judge_feasibility(robot, record.at(slice(-RECENT, None)), cycle)
    return describe_ability(robot, feasibility)


# ---- as text -------------------------------------------------------------------------------------


class NumberFormat(NamedTuple):
    """How a number is shown."""

    unit: str
    digits: int
    """Digits after the decimal point."""

    def format(self, value: float) -> str:
        """Return a number with its unit; a dash if it is not available."""
        if not math.isfinite(value):
            return "\N{EN DASH}"
        return f"{format_number(value, f'.{self.digits}f')} {self.unit}".strip()


VELOCITY = NumberFormat("m/s", 3)
POWER = NumberFormat("W", 1)
RATIO = NumberFormat("", 2)
DISTANCE = NumberFormat("m", 3)
DEPTH = NumberFormat("m", 2)
ANGLE = NumberFormat("deg", 1)
LOAD = "{:.1f} N, {:.2f} N m"
UNAVAILABLE = "not available"


def format_figures(live: Live) -> str:
    """Return the figures next to those of the paper, as Markdown."""
    failure = live.simulation.failure
    if failure is not None:
        return f"**{failure}** Change a setting, or reset."
    figures = read_figures(live)
    latest = live.latest()
    kind_of_power = "electrical"
    if latest.electrical_work is None:
        kind_of_power = "mechanical"
    rows = {
        "speed": VELOCITY.format(figures["forward_velocity"]),
        **_format_speed_through_water(figures["speed_through_water"]),
        "over the last gait cycle": VELOCITY.format(figures["cycle_velocity"]),
        f"power, {kind_of_power}": POWER.format(figures["mean_power"]),
        "cost of transport": RATIO.format(figures["cost_of_transport"]),
        "cross-track error": DISTANCE.format(figures["cross_track_error"]),
        "heading": ANGLE.format(math.degrees(figures["heading"])),
        **_format_tilt(read_tilt(latest)),
        **_format_joint_loads(latest),
    }
    lines = [f"| since the last change | {figures['time']:.1f} s |", "|:--|--:|"]
    lines += [f"| {name} | **{value}** |" for name, value in rows.items()]
    lines.append(f"| joints | {figures['joints']} |")
    measured = find_measured(live.scenario)
    if measured is not None:
        lines += _format_measured(measured)
    return "\n".join(lines)


def _format_speed_through_water(speed: float) -> dict[str, str]:
    """Return the speed through the water; nothing where it does not move."""
    if not math.isfinite(speed):
        return {}
    return {"through the water": VELOCITY.format(speed)}


def _format_joint_loads(sample: Log) -> dict[str, str]:
    """Return the largest force and moment that a joint carries; nothing unless forces are shown."""
    if sample.joint_force is None or sample.joint_moment is None or sample.joint_force.size == 0:
        return {}
    force = np.max(np.linalg.norm(sample.joint_force, axis=1))
    moment = np.max(np.linalg.norm(sample.joint_moment, axis=1))
    return {"largest load of a joint": LOAD.format(force, moment)}


def _format_tilt(tilt: dict[str, float]) -> dict[str, str]:
    """Return depth, pitch and roll of a robot in space; nothing in the plane."""
    rows: dict[str, str] = {}
    for name, value in tilt.items():
        if math.isfinite(value):
            number_format = DEPTH if name == "depth" else ANGLE
            rows[name] = number_format.format(value)
    return rows


def _format_measured(measured: MeasuredTrial) -> list[str]:
    """Return what was measured in the same setting."""
    speed = UNAVAILABLE
    if measured.forward_velocity is not None:
        speed = f"{measured.forward_velocity:.3f} m/s"
    power = UNAVAILABLE
    if measured.mean_power is not None:
        power = f"{measured.mean_power:.1f} W"
    duration = f"{measured.duration:.3g} s from rest"
    return [
        f"| speed in the tank, {duration} | {speed} |",
        f"| power in the tank, electrical | {power} |",
    ]
