"""Names of parameters, short enough for a figure."""

from collections.abc import Sequence

DROPPED_PATHS = ("robot.joint.actuator.", "robot.joint.", "robot.", "water.")
"""Paths that are left out of a name, the longest first."""


def shorten_names(names: Sequence[str]) -> list[str]:
    """Return names as shown in figures: without the path to the parameter, if that leaves them distinct.

    Args:
        names: Full names.
    """
    short_names = [_shorten(name) for name in names]
    shown_names: list[str] = []
    for short_name, name in zip(short_names, names, strict=True):
        is_distinct = short_names.count(short_name) == 1
        shown_names.append(short_name if is_distinct else name)
    return shown_names


def _shorten(name: str) -> str:
    """Return the name of a parameter without its path; what stands before the path is kept."""
    for path in DROPPED_PATHS:
        scope, separator, parameter = name.partition(path)
        if not separator:
            continue
        parameter = parameter.replace("_", " ")
        if not scope:
            return parameter
        scope = scope.rstrip(".").replace("_", " ")
        return f"{scope}: {parameter}"
    return name.replace("_", " ")
