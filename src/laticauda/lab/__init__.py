"""The virtual tank: Mamba's modules on a CAN bus, cameras and a power meter, around a `Plant` that is handed in."""

from laticauda.lab.tank import assist
from laticauda.lab.faults import KINDS, Fault, FaultFileError, Faults, fault_from_words, load_faults
from laticauda.lab.instruments import BODY
from laticauda.lab.qtm_server import LOOPBACK, QtmServer, ServerFailed
from laticauda.lab.serving import Lab, LabAddresses
from laticauda.lab.settings import LabSettings, MocapSettings, NodeSettings, SupplySettings
from laticauda.lab.tank import Tank
from laticauda.lab.virtual_robot import Truth, VirtualRobot

__all__ = [
    "BODY",
    "KINDS",
    "LOOPBACK",
    "Fault",
    "FaultFileError",
    "Faults",
    "Lab",
    "LabAddresses",
    "LabSettings",
    "MocapSettings",
    "NodeSettings",
    "QtmServer",
    "ServerFailed",
    "SupplySettings",
    "Tank",
    "Truth",
    "VirtualRobot",
    "assist",
    "fault_from_words",
    "load_faults",
]
