"""Planar kernels for machines without Python: machine code for many platforms, and tables of a robot's numbers.

All computation is done by one C function, which does not depend on the robot:

    int64_t laticauda_move(const int64_t *whole, const double *real, double *variables, double *rows, double interval);

With an interval of 0 it starts a run: it fills all rows from the tables `whole` and `real` and the
parameters among the variables. With any other interval it advances the run by that time [s], with
inputs held constant. Both set the outputs. It returns 1, or 0 if the motion diverged. `rows` has
room for `Tables.n_numbers` numbers; together with the variables, it is all that is needed to
continue a run.

The function:

- `entry`: compiles the function to LLVM code, and says how `whole` and `real` are laid out
- `platforms`: operating systems and processors for which there can be libraries
- `machine_code`: object files of the function for a platform, cached on disk
- `linking`: libraries and WebAssembly modules from object files, by a C compiler

A robot:

- `variable`: what a variable is
- `joint_rows`: where the kernels keep each joint
- `settable`: variables that other tools set
- `outputs`: variables that other tools read
- `variables`: all of them, in order
- `water_slopes`: how the kernels' rows depend on the water
- `tables`: the arrays `whole` and `real` of a robot
- `c_tables`: the arrays as a C header
- `c_library`: export of a robot as a library in C
"""

from typing import TYPE_CHECKING

from laticauda.values import lazy_exports

if TYPE_CHECKING:
    from laticauda.connect.native.c_library import export_c as export_c

__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {},
    plain={
        "laticauda.connect.native.c_library": ["export_c"],
    },
)
