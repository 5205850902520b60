"""Common parts of both models: the base of their plants, and the joints and time steps of their kernels."""
