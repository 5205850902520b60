"""Drivers of the devices: modules' bus, motion capture, power meter, emergency-stop input, the robot's own sensors.

No exception ends their threads. `base` says what a driver is, how your own driver is found, and
what it has to do.
"""

from laticauda.tank.operate.drivers.base import (
    KINDS,
    Bus,
    Frame,
    Meter,
    MotionCapture,
    Sensors,
    StopInput,
    driver_named,
)
from laticauda.tank.protocol.clock import Clock
from laticauda.tank.protocol.worker import DeviceFailed
from laticauda.values import explain

__all__ = [
    "KINDS",
    "Bus",
    "Clock",
    "DeviceFailed",
    "Frame",
    "Meter",
    "MotionCapture",
    "Sensors",
    "StopInput",
    "driver_named",
]

explain(globals())
