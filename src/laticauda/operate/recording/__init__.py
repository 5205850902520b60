"""The recording of an operation: one file for everything, read again, and made a trial of."""
