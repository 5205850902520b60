"""Robots in water as FMUs (FMI 2.0 and 3.0, co-simulation): the planar kernels as machine code that needs no Python."""

from laticauda.connect.fmu.exporting import export_fmu
from laticauda.connect.native.platforms import LinkingFailed
from laticauda.connect.native.variables import Variable

__all__ = ["LinkingFailed", "Variable", "export_fmu"]
