"""SwimBench: fixed swimming scenarios, scores that include energy, and baselines.

import laticauda_swimbench as swimbench
env = swimbench.make("path")          # a Gymnasium environment
scores = swimbench.score("ilos")      # a score file's content
scores = swimbench.score_missions("reference")
"""

from typing import TYPE_CHECKING

from laticauda.values import lazy_exports

if TYPE_CHECKING:
    from laticauda_swimbench.challenges import (
        CHALLENGES as CHALLENGES,
        Challenge as Challenge,
        challenge as challenge,
        make as make,
    )
    from laticauda_swimbench.methods import Method as Method, method as method
    from laticauda_swimbench.missions import (
        MISSIONS as MISSIONS,
        MissionChallenge as MissionChallenge,
        mission_challenge as mission_challenge,
        score_missions as score_missions,
    )
    from laticauda_swimbench.scoring import score as score
    from laticauda_swimbench.task import Swim as Swim

__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {
        "laticauda_swimbench.challenges": ["CHALLENGES", "Challenge", "challenge", "make"],
        "laticauda_swimbench.methods": ["Method", "method"],
        "laticauda_swimbench.missions": [
            "MISSIONS",
            "MissionChallenge",
            "mission_challenge",
            "score_missions",
        ],
        "laticauda_swimbench.scoring": ["score"],
        "laticauda_swimbench.task": ["Swim"],
    },
)
