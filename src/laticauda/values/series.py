"""Logs: time series by name, each declared once with its axes, its unit and its meaning."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Annotated, Any, NamedTuple, TypeAlias, get_args, get_origin, get_type_hints

import numpy as np
from jaxtyping import Float

from laticauda.values.errors import BadArgument

# Contents of `Log`, by axes; a single sample has no time axis.
Samples: TypeAlias = Float[np.ndarray, " *time"]
Places: TypeAlias = Float[np.ndarray, "*time axis"]
Links: TypeAlias = Float[np.ndarray, "*time link"]
Joints: TypeAlias = Float[np.ndarray, "*time joint"]
JointVectors: TypeAlias = Float[np.ndarray, "*time joint direction"]
LinkVectors: TypeAlias = Float[np.ndarray, "*time link direction"]
Work: TypeAlias = Float[np.ndarray, "*time 3"]
LINK_FORCE = "link_force_"
SIGNAL = "signal_"
"""Prefixes of force and signal names, used where a log is a flat set of arrays by name: see `Log.series`."""


class Series(NamedTuple):
    """Description of one time series, for trials, their files and the reference."""

    units: str
    """SI unit, in UDUNITS notation."""
    text: str
    """Meaning, in words."""
    dimensions: tuple[str, ...] = ("time",)
    """Names of its axes, time first."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Log:
    """Samples logged by a plant or contained in a `laticauda.Trial`, with time as the first axis.

    Links and joints are numbered from the tail. A single sample (`at` an index) has no time axis.
    """

    time: Annotated[Samples, Series("s", "time since the start of the run, strictly increasing")]
    center_of_mass: Annotated[
        Places, Series("m", "position of the center of mass, with the fin's mass, world axes")
    ]
    center_of_mass_velocity: Annotated[
        Places, Series("m s-1", "velocity of the center of mass, world axes")
    ]
    heading: Annotated[
        Samples, Series("rad", "mean angle of the body's links (6), unwrapped, without the fin")
    ]
    heading_rate: Annotated[Samples, Series("rad s-1", "rate of the heading")]
    link_angle: Annotated[
        Links,
        Series("rad", "angle of each link to the world x axis, counter-clockwise, tail first"),
    ]
    joint_angle: Annotated[
        Joints, Series("rad", "joint angle, head side minus tail side, tail first")
    ]
    joint_rate: Annotated[Joints, Series("rad s-1", "rate of the joint angle")]
    joint_angle_ref: Annotated[Joints, Series("rad", "joint angle that was asked for")]
    joint_torque: Annotated[
        Joints, Series("N m", "torque of the joint's drive; its power is torque times rate")
    ]
    work: Annotated[
        Work,
        Series("J", "work of the joints so far: sum of |u phi'|, of u phi', of max(u phi', 0)"),
    ]
    electrical_work: Annotated[
        Samples | None,
        Series("J", "electrical work of the robot above idle, by a model or a meter"),
    ] = None
    joint_force: Annotated[
        JointVectors | None,
        Series(
            "N",
            "force of the part on the joint's tail side on the part on its head side: along, left "
            "and up, axes of the link on the tail side",
        ),
    ] = None
    joint_moment: Annotated[
        JointVectors | None,
        Series("N m", "moment of the same part on the other one about the joint, same axes"),
    ] = None
    water_force: Annotated[
        LinkVectors | None,
        Series("N", "force of the water on each link, fin included: along, left and up, its axes"),
    ] = None
    link_force: Mapping[str, Float[np.ndarray, "*time link axis"]] | None = None
    """Force on each link by component (drag, added_mass, effector), world axes; None if not requested [N]."""
    signals: Mapping[str, Samples] = field(default_factory=dict[str, np.ndarray])
    """Internal quantities of a controller, held between control instants (see `control`), and other data logged by a
    plant: `orientation_w` to `orientation_z` of module 0, a quaternion, for the spatial plant;
    often empty [SI]."""

    def at(self, index: int | slice) -> "Log":
        """Select some of the samples.

        Args:
            index: Index of a single sample, which then has no time axis, or a slice.
        """
        return log_of({name: np.asarray(values[index]) for name, values in self.series().items()})

    def series(self) -> dict[str, np.ndarray]:
        """Return every array by its name in tables and messages: `signal_offset` is the signal `offset`."""
        arrays: dict[str, np.ndarray] = {}
        for name in SERIES:
            values = getattr(self, name)
            if values is not None:
                arrays[name] = values
        for name, values in (self.link_force or {}).items():
            arrays[LINK_FORCE + name] = values
        for name, values in self.signals.items():
            arrays[SIGNAL + name] = values
        return arrays


def as_floats(name: str, values: object) -> Float[np.ndarray, "..."]:
    """Return `values` as an array of floats, which may share their memory.

    Args:
        name: Name of the argument.
        values: Numbers of any shape.

    Raises:
        ValueError: If they are not numbers, are complex, some are masked, or rows differ in length.
    """
    if type(values) is np.ndarray and values.dtype == np.float64:  # as nearly always
        return np.asarray(values, order="C")
    try:
        array = np.asarray(values)
    except (ValueError, MemoryError):  # rows of different lengths, or endless input
        array = np.empty((), dtype=object)
    if array.dtype.kind not in "iuf" or np.ma.is_masked(values):
        raise BadArgument(
            name, f"must be an array of numbers, got {type(values).__name__} of {array.dtype}"
        )
    return np.asarray(array, dtype=np.float64, order="C")


def _series(hint: Any) -> Series:
    """Return the `Series` in a field's annotation, with the axes of its type."""
    kind, declared = get_args(hint)
    if not hasattr(kind, "dim_str"):  # of `Samples | None`, the first
        kind = get_args(kind)[0]
    return declared._replace(dimensions=tuple(kind.dim_str.replace("*", "").split()))


_HINTS = get_type_hints(Log, include_extras=True)
SERIES = {name: _series(hint) for name, hint in _HINTS.items() if get_origin(hint) is Annotated}
"""Series of a log that are single arrays."""
REQUESTED_SERIES = ("joint_force", "joint_moment", "water_force")
"""Series that are logged on request only, together with the forces on the links."""
OPTIONAL_SERIES = ("electrical_work", *REQUESTED_SERIES)
"""Series that a log may lack."""
DIRECTIONS = ("along", "left", "up")
"""Axes of a link: along it to the head, to its left, up."""


def log_of(series: Mapping[str, np.ndarray]) -> Log:
    """Return the log whose `Log.series` is given.

    Args:
        series: Every array by name.
    """
    fields: dict[str, Any] = {}
    forces: dict[str, np.ndarray] = {}
    signals: dict[str, np.ndarray] = {}
    for name, values in series.items():
        if name.startswith(LINK_FORCE):
            forces[name.removeprefix(LINK_FORCE)] = values
        elif name.startswith(SIGNAL):
            signals[name.removeprefix(SIGNAL)] = values
        elif name in SERIES:
            fields[name] = values
    return Log(**fields, link_force=forces or None, signals=signals)


def concatenated(parts: Sequence[Log]) -> Log:
    """Join several consecutive logs into one.

    Args:
        parts: At least one log; all have the same forces and signals.
    """
    if len(parts) == 1:
        return parts[0]
    series = [log.series() for log in parts]
    joined: dict[str, np.ndarray] = {}
    for name in series[0]:
        joined[name] = np.concatenate([part[name] for part in series])
    return log_of(joined)
