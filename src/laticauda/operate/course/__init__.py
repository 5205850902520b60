"""The course of an operation as a pure tick: preparations, run and stop, by one table of transitions."""
