"""Recording of an operation: one file for everything, how it is read, and how it is converted to a trial."""
