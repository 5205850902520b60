"""Gymnasium environments of swimming robots; importing this registers them.

    import gymnasium
    import laticauda.cosim.gym
    envs = gymnasium.make_vec("laticauda/PathFollowing-v0", num_envs=64)

or, in one go, ``gymnasium.make("laticauda.cosim.gym:laticauda/PathFollowing-v0")``.
"""

# pyright: reportUnknownVariableType=false

from typing import TYPE_CHECKING

from laticauda.errors import optional_import
from laticauda.packaging import lazy_exports

registration = optional_import("Learning", "gymnasium", "learn", "gymnasium.envs.registration")

if TYPE_CHECKING:
    from laticauda.cosim.gym.baselines import StableBaselines as StableBaselines
    from laticauda.cosim.gym.tasks import Efficiency as Efficiency
    from laticauda.cosim.gym.environments import SwimmingEnv as SwimmingEnv, SwimmingVectorEnv as SwimmingVectorEnv
    from laticauda.cosim.gym.episodes import Episodes as Episodes, Pilots as Pilots
    from laticauda.cosim.gym.tasks import PathFollowing as PathFollowing
    from laticauda.cosim.gym.tasks import StationKeeping as StationKeeping
    from laticauda.cosim.gym.swimming import Range as Range, Sight as Sight, Step as Step
    from laticauda.cosim.gym.swimming import Swimming as Swimming, swimmer as swimmer

IDS = ("laticauda/PathFollowing-v0", "laticauda/Efficiency-v0", "laticauda/StationKeeping-v0")
"""What Gymnasium calls them."""

for _id in IDS:
    if _id not in registration.registry:
        registration.register(
            id=_id,
            entry_point="laticauda.cosim.gym.environments:SwimmingEnv",
            vector_entry_point="laticauda.cosim.gym.environments:SwimmingVectorEnv",
            kwargs={"task": _id.removeprefix("laticauda/").removesuffix("-v0")},
        )

# Kernels are imported when an environment is made.
__getattr__, __dir__, __all__ = lazy_exports("IDS")
