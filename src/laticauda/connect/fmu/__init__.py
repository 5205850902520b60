"""Robots in water as FMUs (FMI 2.0 and 3.0, co-simulation): the planar kernels as machine code that needs no Python.

- `exporting`: writes the file
- `model_description`: its `modelDescription.xml`, for programs
- `documentation`: its HTML page, for people
- `units`: the units of its variables
"""

from laticauda.connect.fmu.exporting import export_fmu
from laticauda.connect.native.linking import LinkingFailed
from laticauda.connect.native.variable import Variable
from laticauda.values import explain

__all__ = ["LinkingFailed", "Variable", "export_fmu"]

explain(globals())
