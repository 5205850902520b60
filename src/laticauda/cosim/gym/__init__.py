"""Gymnasium environments of swimming robots; importing this registers them.

    import gymnasium
    import laticauda.cosim.gym
    envs = gymnasium.make_vec("laticauda/PathFollowing-v0", num_envs=64)

or, in one go, ``gymnasium.make("laticauda.cosim.gym:laticauda/PathFollowing-v0")``.
"""

# pyright: reportUnknownVariableType=false

from typing import TYPE_CHECKING, Any

from laticauda.errors import MissingExtra

try:
    from gymnasium.envs.registration import register, registry
except ImportError as error:
    raise MissingExtra("Learning", "gymnasium", "learn") from error

if TYPE_CHECKING:
    from laticauda.cosim.gym.baselines import StableBaselines
    from laticauda.cosim.gym.efficiency import Efficiency
    from laticauda.cosim.gym.environments import SwimmingEnv, SwimmingVectorEnv
    from laticauda.cosim.gym.episodes import Episodes
    from laticauda.cosim.gym.following import PathFollowing
    from laticauda.cosim.gym.piloting import Pilots
    from laticauda.cosim.gym.station import StationKeeping
    from laticauda.cosim.gym.swimming import Range, Sight, Step, Swimming

__all__ = [
    "IDS",
    "Efficiency",
    "Episodes",
    "PathFollowing",
    "Pilots",
    "Range",
    "Sight",
    "StableBaselines",
    "StationKeeping",
    "Step",
    "Swimming",
    "SwimmingEnv",
    "SwimmingVectorEnv",
]

IDS = ("laticauda/PathFollowing-v0", "laticauda/Efficiency-v0", "laticauda/StationKeeping-v0")
"""What Gymnasium calls them."""

_HOMES = {
    "Efficiency": "efficiency",
    "Episodes": "episodes",
    "PathFollowing": "following",
    "Pilots": "piloting",
    "Range": "swimming",
    "Sight": "swimming",
    "StableBaselines": "baselines",
    "StationKeeping": "station",
    "Step": "swimming",
    "Swimming": "swimming",
    "SwimmingEnv": "environments",
    "SwimmingVectorEnv": "environments",
}

for _id in IDS:
    if _id not in registry:
        register(
            id=_id,
            entry_point="laticauda.cosim.gym.environments:SwimmingEnv",
            vector_entry_point="laticauda.cosim.gym.environments:SwimmingVectorEnv",
            kwargs={"task": _id.removeprefix("laticauda/").removesuffix("-v0")},
        )


def __getattr__(name: str) -> Any:
    # Kernels are imported when an environment is made.
    if name in _HOMES:
        from importlib import import_module

        return getattr(import_module(f"laticauda.cosim.gym.{_HOMES[name]}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
