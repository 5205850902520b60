"""The virtual tank: Mamba's modules on a CAN bus, cameras and a power meter around a given `Plant`."""

from typing import TYPE_CHECKING

from laticauda.values import lazy_exports

if TYPE_CHECKING:
    from laticauda.tank.lab.faults import (
        Fault as Fault,
        FaultFileError as FaultFileError,
        Faults as Faults,
        KINDS as KINDS,
        fault_from_words as fault_from_words,
        load_faults as load_faults,
    )
    from laticauda.tank.lab.instruments import BODY as BODY
    from laticauda.tank.lab.qtm_server import (
        LOOPBACK as LOOPBACK,
        QtmServer as QtmServer,
        ServerFailed as ServerFailed,
    )
    from laticauda.tank.lab.serving import Lab as Lab, LabAddresses as LabAddresses
    from laticauda.tank.lab.settings import (
        LabSettings as LabSettings,
        MocapSettings as MocapSettings,
        NodeSettings as NodeSettings,
        SupplySettings as SupplySettings,
    )
    from laticauda.tank.lab.tank import Tank as Tank, assist as assist
    from laticauda.tank.lab.virtual_robot import Truth as Truth, VirtualRobot as VirtualRobot

__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {
        "laticauda.tank.lab.faults": [
            "Fault",
            "FaultFileError",
            "Faults",
            "KINDS",
            "fault_from_words",
            "load_faults",
        ],
        "laticauda.tank.lab.instruments": ["BODY"],
        "laticauda.tank.lab.qtm_server": ["LOOPBACK", "QtmServer", "ServerFailed"],
        "laticauda.tank.lab.serving": ["Lab", "LabAddresses"],
        "laticauda.tank.lab.settings": [
            "LabSettings",
            "MocapSettings",
            "NodeSettings",
            "SupplySettings",
        ],
        "laticauda.tank.lab.tank": ["Tank", "assist"],
        "laticauda.tank.lab.virtual_robot": ["Truth", "VirtualRobot"],
    },
)
