"""The planar kernels for machines without Python: machine code for many platforms, and the tables of a robot's numbers.

What computes is one function in C, which knows no robot:

    int64_t laticauda_move(const int64_t *whole, const double *real, double *variables, double *rows, double interval);

With an interval of 0 it begins: it fills all rows from the tables `whole` and `real` and the parameters among the
variables. With any other it goes that much time on [s]; the inputs are held meanwhile. Both set the outputs. It returns
1, or 0 if the motion diverged. `rows` has room for `Tables.n_rows + entry.SCRATCH` numbers, and is all that a run needs
to go on, with the variables.

In Python: `tables_of` makes the tables and the variables of a robot in water, `object_code` the machine code for a
platform, `linked` a library or a module of WebAssembly of it.
"""
