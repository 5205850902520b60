"""The virtual tank: Mamba's modules on a CAN bus, cameras and a power meter around a given `Plant`."""

from typing import TYPE_CHECKING

from laticauda.packaging import lazy_exports

if TYPE_CHECKING:
    from laticauda.lab.faults import (
        KINDS as KINDS,
        Fault as Fault,
        FaultFileError as FaultFileError,
        Faults as Faults,
    )
    from laticauda.lab.faults import (
        fault_from_words as fault_from_words,
        load_faults as load_faults,
    )
    from laticauda.lab.instruments import BODY as BODY
    from laticauda.lab.qtm_server import (
        LOOPBACK as LOOPBACK,
        QtmServer as QtmServer,
        ServerFailed as ServerFailed,
    )
    from laticauda.lab.serving import Lab as Lab, LabAddresses as LabAddresses
    from laticauda.lab.settings import LabSettings as LabSettings, MocapSettings as MocapSettings
    from laticauda.lab.settings import (
        NodeSettings as NodeSettings,
        SupplySettings as SupplySettings,
    )
    from laticauda.lab.tank import assist as assist, Tank as Tank
    from laticauda.lab.virtual_robot import Truth as Truth, VirtualRobot as VirtualRobot

__getattr__, __dir__, __all__ = lazy_exports()
