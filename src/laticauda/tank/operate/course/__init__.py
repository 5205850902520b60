"""The course of an operation as a pure tick: preparations, run and stop, according to one table of transitions."""
