"""Gymnasium environments of swimming robots; importing this package registers them.

    import gymnasium
    import laticauda_gym
    envs = gymnasium.make_vec("laticauda/PathFollowing-v0", num_envs=64)

or, in one go, ``gymnasium.make("laticauda_gym:laticauda/PathFollowing-v0")``.
"""

# pyright: reportUnknownMemberType=false

from typing import TYPE_CHECKING

from gymnasium.envs import registration

from laticauda.values import lazy_exports

if TYPE_CHECKING:
    from laticauda_gym.abreast import Abreast as Abreast
    from laticauda_gym.baselines import StableBaselines as StableBaselines
    from laticauda_gym.environments import (
        SwimmingEnv as SwimmingEnv,
        SwimmingVectorEnv as SwimmingVectorEnv,
    )
    from laticauda_gym.episodes import Episodes as Episodes, Pilots as Pilots
    from laticauda_gym.swimming import (
        Range as Range,
        Sight as Sight,
        Step as Step,
        Swimming as Swimming,
        swimmer as swimmer,
    )
    from laticauda_gym.tasks import (
        Efficiency as Efficiency,
        PathFollowing as PathFollowing,
        StationKeeping as StationKeeping,
    )
    from laticauda_gym.together import SwimmingParallelEnv as SwimmingParallelEnv

IDS = ("laticauda/PathFollowing-v0", "laticauda/Efficiency-v0", "laticauda/StationKeeping-v0")
"""Names of the environments in Gymnasium."""

for _id in IDS:
    if _id not in registration.registry:
        registration.register(
            id=_id,
            entry_point="laticauda_gym.environments:SwimmingEnv",
            vector_entry_point="laticauda_gym.environments:SwimmingVectorEnv",
            kwargs={"task": _id.removeprefix("laticauda/").removesuffix("-v0")},
        )

# Kernels are imported when an environment is made.
__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {
        "laticauda_gym.abreast": ["Abreast"],
        "laticauda_gym.baselines": ["StableBaselines"],
        "laticauda_gym.environments": ["SwimmingEnv", "SwimmingVectorEnv"],
        "laticauda_gym.episodes": ["Episodes", "Pilots"],
        "laticauda_gym.swimming": ["Range", "Sight", "Step", "Swimming", "swimmer"],
        "laticauda_gym.tasks": ["Efficiency", "PathFollowing", "StationKeeping"],
        "laticauda_gym.together": ["SwimmingParallelEnv"],
    },
    own=["IDS"],
)
