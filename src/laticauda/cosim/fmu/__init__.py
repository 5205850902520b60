"""Robots in water as FMUs (FMI 2.0 and 3.0, co-simulation): the planar kernels as machine code that needs no Python."""

from laticauda.cosim.fmu.exporting import export_fmu
from laticauda.cosim.native.platforms import LinkingFailed
from laticauda.cosim.native.variables import Variable

__all__ = ["LinkingFailed", "Variable", "export_fmu"]
