"""Operating a robot: what it reports, where it is, and what happened."""
