"""laticauda: simulate, identify, optimize and operate swimming snake robots, with and without a caudal fin.

    import laticauda as lc
    trial = lc.swim(lc.load_robot("mamba"), lc.lateral_undulation(amplitude=0.52, frequency=2.27, phase_shift=0.70))

Names are imported when they are first used, so that ``import laticauda`` stays fast and loads no heavy library.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from laticauda.control import (
        HeadingController,
        IntegralLineOfSight,
        LineOfSight,
        PathFollowing,
        Polyline,
        SpatialPathFollowing,
        Spline,
        StraightLine,
    )
    from laticauda.gaits import Gait, Wave, custom_gait, eel_like, lateral_undulation
    from laticauda.interfaces import Command, Controller, Observation, OpenLoop, Plant, Start
    from laticauda.robot import (
        Ground,
        Parameters,
        Robot,
        Water,
        load_ground,
        load_parameters,
        load_robot,
        load_water,
    )
    from laticauda.simulate import Swims, plant, resume, run, swim, swim_many
    from laticauda.trial import Trial, compare, joined, load_trial

_HOMES = {
    "control": (
        "HeadingController",
        "IntegralLineOfSight",
        "LineOfSight",
        "PathFollowing",
        "Polyline",
        "SpatialPathFollowing",
        "Spline",
        "StraightLine",
    ),
    "gaits": ("Gait", "Wave", "custom_gait", "eel_like", "lateral_undulation"),
    "interfaces": ("Command", "Controller", "Observation", "OpenLoop", "Plant", "Start"),
    "robot": (
        "Ground",
        "Parameters",
        "Robot",
        "Water",
        "load_ground",
        "load_parameters",
        "load_robot",
        "load_water",
    ),
    "simulate": ("Swims", "plant", "resume", "run", "swim", "swim_many"),
    "trial": ("Trial", "compare", "joined", "load_trial"),
}
_HOME_OF = {name: home for home, names in _HOMES.items() for name in names}

__all__ = [
    "Command",
    "Controller",
    "Gait",
    "Ground",
    "HeadingController",
    "IntegralLineOfSight",
    "LineOfSight",
    "Observation",
    "OpenLoop",
    "Parameters",
    "PathFollowing",
    "Plant",
    "Polyline",
    "Robot",
    "SpatialPathFollowing",
    "Spline",
    "Start",
    "StraightLine",
    "Swims",
    "Trial",
    "Water",
    "Wave",
    "compare",
    "custom_gait",
    "eel_like",
    "joined",
    "lateral_undulation",
    "load_ground",
    "load_parameters",
    "load_robot",
    "load_trial",
    "load_water",
    "plant",
    "resume",
    "run",
    "swim",
    "swim_many",
]


def __getattr__(name: str) -> Any:
    if name == "__version__":
        from importlib.metadata import version

        return version("laticauda")
    if name in _HOME_OF:
        return getattr(import_module(f"laticauda.{_HOME_OF[name]}"), name)
    raise AttributeError(f"module 'laticauda' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted([*globals(), *__all__, "__version__"])
