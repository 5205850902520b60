"""Robots in water as FMUs (FMI 2.0 and 3.0, co-simulation): the planar kernels as machine code that needs no Python."""

from laticauda.cosim.fmu.exporting import INPUTS, export_fmu, needs_compiling
from laticauda.cosim.fmu.exporting import LinkingFailed
from laticauda.cosim.fmu.variables import Variable

__all__ = ["INPUTS", "LinkingFailed", "Variable", "export_fmu", "needs_compiling"]
