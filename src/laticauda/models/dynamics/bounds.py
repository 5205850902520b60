"""Bounds of a run, in both models."""

FARTHEST = 1e6
"""Bound of positions [m, rad] and rates [m/s, rad/s]; a run that exceeds it has diverged."""
STRONGEST = 1e12
"""Bound of torques [N m]; a run that exceeds it has diverged."""
