"""Extension points: base classes whose subclasses are found by name, wherever they are defined.

Drag laws, joint laws, envelopes and controllers are subclasses of such a base. The name of a
subclass in files, flags and messages is its class name with hyphens. It is found if it comes with
the package, was defined or imported by this process, or is an entry point of an installed package;
nothing named in a file is imported because of it.
"""

import functools
import re
from collections.abc import Mapping
from importlib import import_module
from importlib.metadata import entry_points
from itertools import chain
from typing import Any, ClassVar, Self, cast

from laticauda.values.checks import suggest_nearest
from laticauda.values.errors import BadArgument

ENTRY_POINTS = "laticauda."
"""Prefix of the entry-point groups; the group of drag laws is ``laticauda.drag_laws``."""
HOMES: Mapping[str, Mapping[str, str]] = {
    "behaviours": {
        "follow-wall": "laticauda.missions.behaviours.walls",
        "hover": "laticauda.missions.behaviours.station",
        "keep-station": "laticauda.missions.behaviours.station",
        "rest": "laticauda.missions.behaviours.routes",
        "search": "laticauda.missions.behaviours.routes",
        "stand-off": "laticauda.missions.behaviours.walls",
        "swim-into-dock": "laticauda.missions.behaviours.docking",
        "swim-route": "laticauda.missions.behaviours.routes",
        "swim-straight": "laticauda.missions.behaviours.routes",
    },
    "conditions": {
        "battery-low": "laticauda.missions.phases",
        "captured": "laticauda.missions.phases",
        "position-unsure": "laticauda.missions.phases",
        "sensor-heard": "laticauda.missions.phases",
        "sensor-silent": "laticauda.missions.phases",
        "touched": "laticauda.missions.phases",
    },
    "controllers": {
        "mission": "laticauda.missions.mission",
        "path-following": "laticauda.control.path_following",
        "spatial-path-following": "laticauda.control.spatial_path_following",
        "model-predictive": "laticauda.control.mpc.predictive",
        "offset-steps": "laticauda.control.offset_steps",
        "phase-oscillators": "laticauda.control.neural.phase_oscillators",
        "half-centers": "laticauda.control.neural.half_centers",
    },
    "drivers.bus": {
        "can": "laticauda.tank.operate.drivers.can",
    },
    "drivers.meter": {
        "fluke": "laticauda.tank.operate.drivers.meter",
    },
    "drivers.mocap": {
        "qtm": "laticauda.tank.operate.drivers.mocap",
    },
    "drivers.sensors": {
        "udp-readings": "laticauda.tank.operate.drivers.readings",
    },
    "drivers.stop": {
        "serial-line": "laticauda.tank.operate.drivers.stop",
    },
    "flows": {
        "lamb-oseen": "laticauda.water.fluid.eddies",
        "karman-street": "laticauda.water.fluid.eddies",
        "uniform": "laticauda.water.fluid.uniform",
        "linear-shear": "laticauda.water.fluid.uniform",
        "power-law-shear": "laticauda.water.fluid.uniform",
        "waves": "laticauda.water.fluid.waves",
        "sea": "laticauda.water.fluid.waves",
        "turbulence": "laticauda.water.fluid.eddies",
        "wake": "laticauda.water.fluid.wake",
        "wake-of-trial": "laticauda.trials.wake",
        "gridded": "laticauda.water.fluid.gridded",
    },
    "formats": {
        "nc": "laticauda.trials.logs.netcdf",
        "mcap": "laticauda.trials.logs.mcap_trials",
        "parquet": "laticauda.trials.logs.tabular",
        "mat": "laticauda.trials.logs.mat",
        "csv": "laticauda.trials.logs.tabular",
    },
    "paths": {
        "straight-line": "laticauda.control.paths",
        "circle": "laticauda.control.paths",
        "polyline": "laticauda.control.paths",
        "spline": "laticauda.control.paths",
    },
    "places": {
        "buoy": "laticauda.sensing.places.structures",
        "dock": "laticauda.sensing.places.dock",
        "net": "laticauda.sensing.places.structures",
        "pipeline": "laticauda.sensing.places.structures",
        "seabed": "laticauda.sensing.places.structures",
        "wall": "laticauda.sensing.places.structures",
    },
    "point_formats": {
        "deeplabcut": "laticauda.film.formats.deeplabcut",
        "sleap": "laticauda.film.formats.sleap",
        "trex": "laticauda.film.formats.trex",
        "idtracker": "laticauda.film.formats.idtracker",
        "points": "laticauda.film.formats.plain",
    },
    "sensors": {
        "acoustic-position": "laticauda.sensing.sensors.navigation",
        "altimeter": "laticauda.sensing.sensors.sonar",
        "battery-gauge": "laticauda.sensing.sensors.condition",
        "compass": "laticauda.sensing.sensors.navigation",
        "contact-sensor": "laticauda.sensing.sensors.condition",
        "depth-gauge": "laticauda.sensing.sensors.navigation",
        "doppler-velocity": "laticauda.sensing.sensors.navigation",
        "inertial-unit": "laticauda.sensing.sensors.navigation",
        "pressure-sensor": "laticauda.sensing.sensors.loads",
        "sonar": "laticauda.sensing.sensors.sonar",
        "strain-gauge": "laticauda.sensing.sensors.loads",
    },
    "scenes": {
        "pegs": "laticauda.models.spatial.scene",
        "slope": "laticauda.models.spatial.scene",
        "pipe": "laticauda.models.spatial.scene",
        "shore": "laticauda.models.spatial.scene",
        "tank": "laticauda.models.spatial.scene",
        "height-field": "laticauda.models.spatial.scene",
        "mjcf": "laticauda.models.spatial.scene",
        "edited": "laticauda.models.spatial.scene",
    },
}
"""By group, the module of every member that comes with the package and is imported only on demand."""


class Extensible:
    """Base class of extension points; each extension point names its group.

    class DragLaw(Extensible, group="drag_laws"): ...
    class PathFollowing(Controller): ...      # known as path-following
    """

    group: ClassVar[str]
    """Group of entry points, without `ENTRY_POINTS`."""
    _members: ClassVar[dict[str, type]]
    """Members that are defined or imported, by name."""
    _homes: ClassVar[Mapping[str, str]]
    """Modules of the members that come with the package, by name."""

    def __init_subclass__(cls, *, group: str | None = None, **base_arguments: Any) -> None:
        """Create a new group, or join the group of the base.

        Args:
            group: Name of the group; given by the base of a new group.
            base_arguments: Arguments for other bases.
        """
        super().__init_subclass__(**base_arguments)
        if group is not None:
            cls.group = group
            cls._homes = HOMES.get(group, {})
            cls._members = {}
            if "called" in vars(cls):  # a base with a name is itself a member
                cls._members[name_of(cls)] = cls
        elif not cls.__name__.startswith("_"):
            cls._members[name_of(cls)] = cls

    @classmethod
    def named(cls, name: str) -> type[Self]:
        """Return the member of this group with a given name.

        Args:
            name: Name, as in the key `kind` of files.

        Raises:
            ValueError: If there is no such member; the message lists the known ones.
        """
        if name in cls._homes and name not in cls._members:
            import_module(cls._homes[name])
        if name not in cls._members and name in _find_installed(cls.group):
            _find_installed(cls.group)[name].load()
        if name not in cls._members:
            listed = ", ".join(f"`{member}`" for member in cls.names())
            hint = suggest_nearest(name, cls.names())
            raise BadArgument("kind", f"must be one of {listed}, got {name!r}{hint}")
        return cls._members[name]

    @classmethod
    def stand_in(cls, name: str, table: Mapping[str, Any]) -> Self:
        """Return a stand-in for a member that a file names but that is undefined here: it is kept, and can do nothing.

        Args:
            name: Name of the member in the file.
            table: Everything else that the file states about it.
        """
        stand_in: Any = object.__new__(_stand_in(cls, name))
        stand_in.__dict__ |= {"kind": name, "table": dict(table)}
        return stand_in

    @classmethod
    def names(cls) -> tuple[str, ...]:
        """Return the names of all members of this group, those of the package first."""
        return tuple(dict.fromkeys([*cls._homes, *cls._members, *_find_installed(cls.group)]))


class Unknown:
    """Mixin of stand-ins, see `Extensible.stand_in`."""

    kind: str
    table: Mapping[str, Any]

    def __eq__(self, other: object) -> bool:
        return type(other) is type(self) and vars(other) == vars(self)

    def __hash__(self) -> int:
        return hash(self.kind)

    def __repr__(self) -> str:
        return f"<{self.kind}, which is not defined here>"

    def __call__(self, *_: object) -> Any:
        """Raise an error: a stand-in cannot replace a formula."""
        raise ValueError(f"`{self.kind}` is not defined here; import the module that defines it.")

    @property
    def written(self) -> dict[str, Any]:
        """Content as it was in the file."""
        return {"kind": self.kind, **self.table}

    @property
    def formula(self) -> Any:
        """Raises an error: a stand-in has no formula."""
        return self()

    @property
    def words(self) -> str:
        """Description for people."""
        return repr(self).strip("<>")


@functools.cache
def _stand_in(base: type[Any], name: str) -> type[Any]:
    return type(f"_Unknown{base.__name__}", (Unknown, base), {"called": name})


def name_of(kind: type) -> str:
    """Return the name of a class in files, flags and messages: TotalSpeedDrag is total-speed-drag.

    Args:
        kind: The class.
    """
    own = kind.__dict__.get("called")
    if own is not None:
        return str(own)
    return re.sub(r"(?<=[^A-Z])(?=[A-Z])", "-", kind.__name__).lower()


def _find_installed(group: str) -> Mapping[str, Any]:
    """Return the entry points of a group, by their names."""
    return _installed().get(f"{ENTRY_POINTS}{group}", {})


@functools.cache
def _installed() -> Mapping[str, Mapping[str, Any]]:
    """Return the entry points of all groups, by group and name: to find those of one takes as long."""
    points: Any = entry_points()
    if isinstance(points, dict):  # of Python 3.11: by groups, and with methods that warn
        points = chain.from_iterable(cast(Any, dict).values(points))
    groups: dict[str, dict[str, Any]] = {}
    for point in points:
        groups.setdefault(point.group, {})[point.name] = point
    return groups
