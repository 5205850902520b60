"""Outputs of the sensors in a scenario's model: what they measure without noise, by the names of logs.

Rate, latency, noise, losses and faults are left to the tool that runs the robot.
"""

from collections.abc import Iterator
from typing import NamedTuple

from laticauda.connect.native import sensor_formulas as formulas
from laticauda.connect.native.variable import SensorFormula, Variable
from laticauda.models.planar import PlanarPlant
from laticauda.sensing import (
    AcousticPosition,
    Compass,
    DepthGauge,
    DopplerVelocity,
    InertialUnit,
    Sensor,
)
from laticauda.values import warn_caller

ZERO = SensorFormula(kind=formulas.CONSTANT, numbers=(0.0,))


def list_sensor_outputs(plant: PlanarPlant) -> Iterator[Variable]:
    """Yield an output for every value that a sensor tells and the compiled function can compute.

    Args:
        plant: Plant in water.
    """
    for sensor in plant.settings.sensors:
        for column, measurand in _measurands_of(sensor, plant).items():
            yield Variable(
                name=f"{sensor.name}_{column}",
                causality="output",
                unit=measurand.unit,
                description=f"What the sensor {sensor.name} measures, without noise, at this moment.",
                formula=measurand.formula,
            )


def warn_of_missing_sensors(plant: PlanarPlant) -> None:
    """Say which values of sensors the compiled function cannot compute.

    Args:
        plant: Plant in water.
    """
    missing: list[str] = []
    for sensor in plant.settings.sensors:
        computed_columns = _measurands_of(sensor, plant)
        missing += [
            f"{sensor.name}_{name}" for name in sensor.columns if name not in computed_columns
        ]
    if missing:
        warn_caller(
            f"there are no outputs for {', '.join(missing)}: C code has neither places nor loads, "
            "and knows where the head is only if no fin bends or is driven.",
            UserWarning,
        )


class _Measurand(NamedTuple):
    """What a sensor measures in one column."""

    unit: str
    """Its unit, as in files of the compiled function."""
    formula: SensorFormula
    """How it follows from the motion of the links."""


def _measurands_of(sensor: Sensor, plant: PlanarPlant) -> dict[str, _Measurand]:
    """Return by column what a sensor measures, as far as the compiled function can compute it."""
    if plant.robot.fin_joints:
        return {}
    depth = getattr(plant.environment, "depth", None) or 0.0
    if isinstance(sensor, Compass):
        return {"heading": _Measurand("rad", SensorFormula(formulas.HEADING, (sensor.bias,)))}
    if isinstance(sensor, DepthGauge):
        return {"depth": _Measurand("m", SensorFormula(formulas.CONSTANT, (depth,)))}
    if isinstance(sensor, DopplerVelocity) and not sensor.through_water:
        return {
            "forward": _Measurand("m/s", SensorFormula(formulas.FORWARD)),
            "left": _Measurand("m/s", SensorFormula(formulas.LEFT)),
            "up": _Measurand("m/s", ZERO),
        }
    if isinstance(sensor, InertialUnit):
        bias = SensorFormula(formulas.CONSTANT, (sensor.turn_bias,))
        return {
            "turn_x": _Measurand("rad/s", bias),
            "turn_y": _Measurand("rad/s", bias),
            "turn_z": _Measurand("rad/s", SensorFormula(formulas.TURN_RATE, (sensor.turn_bias,))),
        }
    if isinstance(sensor, AcousticPosition):
        x, y, z = sensor.beacon
        numbers = (x, y, z + depth, sensor.largest_range)
        return {
            "range": _Measurand("m", SensorFormula(formulas.RANGE, numbers)),
            "bearing": _Measurand("rad", SensorFormula(formulas.BEARING, numbers)),
            "elevation": _Measurand("rad", SensorFormula(formulas.ELEVATION, numbers)),
        }
    return {}
