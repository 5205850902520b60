"""The devices: CAN bus, motion capture, power meter. Each has a thread, and no exception leaves it.

A driver is connected when it has been made, or says why not; then it holds what came in for `receive`, says what is
wrong (`trouble`), and ends without a trace (`close`, or a `with` block).
"""

from laticauda.operate.drivers.can import CanDriver
from laticauda.operate.drivers.meter import MeterDriver
from laticauda.operate.drivers.mocap import MocapDriver
from laticauda.protocol.worker import Clock, DeviceFailed

__all__ = ["CanDriver", "Clock", "DeviceFailed", "MeterDriver", "MocapDriver"]
