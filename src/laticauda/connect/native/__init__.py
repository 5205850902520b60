"""Planar kernels for machines without Python: machine code for many platforms, and tables of a robot's numbers.

All computation is done by one C function, which does not depend on the robot:

    int64_t laticauda_move(const int64_t *whole, const double *real, double *variables, double *rows, double interval);

With an interval of 0 it starts a run: it fills all rows from the tables `whole` and `real` and the
parameters among the variables. With any other interval it advances the run by that time [s], with
inputs held constant. Both set the outputs. It returns 1, or 0 if the motion diverged. `rows` has
room for `Tables.n_rows + entry.SCRATCH` numbers; together with the variables, it is all that is
needed to continue a run.

In Python, `tables_of` builds the tables and variables of a robot in water, `object_code` the
machine code for a platform, and `linked` a library or WebAssembly module from that code.
"""
