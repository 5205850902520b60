"""The paper, repeated in simulation and compared with measurements on the robot; it uses all layers below.

Every run looks up the measured tables, so nothing else is imported for them.
"""

from typing import TYPE_CHECKING

from laticauda.values.packaging import lazy_exports

if TYPE_CHECKING:
    from laticauda.paper.claims.judge import Claim as Claim
    from laticauda.paper.efficiency import (
        EfficiencyStudy as EfficiencyStudy,
        Repeat as Repeat,
        TABLE2 as TABLE2,
        load_repeats as load_repeats,
        maxima as maxima,
        run_efficiency as run_efficiency,
    )
    from laticauda.paper.measured import (
        efficiency_trials as efficiency_trials,
        measured_trial as measured_trial,
        path_following_trials as path_following_trials,
    )
    from laticauda.paper.path_following import (
        PathFollowingStudy as PathFollowingStudy,
        run_path_following as run_path_following,
    )
    from laticauda.paper.report.reproduce import (
        Experiments as Experiments,
        paper_experiments as paper_experiments,
        reproduce as reproduce,
    )
    from laticauda.paper.runs import Coefficients as Coefficients
    from laticauda.paper.scores import (
        fin_gains as fin_gains,
        meter_costs as meter_costs,
        null_predictions as null_predictions,
        score_simulations as score_simulations,
    )
    from laticauda.paper.settings import (
        PARAMETERS as PARAMETERS,
        efficiency_settings as efficiency_settings,
        path_following_settings as path_following_settings,
    )
    from laticauda.paper.side_trials import (
        SideSettings as SideSettings,
        run_side_trials as run_side_trials,
    )

__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {
        "laticauda.paper.claims.judge": ["Claim"],
        "laticauda.paper.efficiency": [
            "EfficiencyStudy",
            "Repeat",
            "TABLE2",
            "load_repeats",
            "maxima",
            "run_efficiency",
        ],
        "laticauda.paper.measured": [
            "efficiency_trials",
            "measured_trial",
            "path_following_trials",
        ],
        "laticauda.paper.path_following": ["PathFollowingStudy", "run_path_following"],
        "laticauda.paper.report.reproduce": ["Experiments", "paper_experiments", "reproduce"],
        "laticauda.paper.runs": ["Coefficients"],
        "laticauda.paper.scores": [
            "fin_gains",
            "meter_costs",
            "null_predictions",
            "score_simulations",
        ],
        "laticauda.paper.settings": [
            "PARAMETERS",
            "efficiency_settings",
            "path_following_settings",
        ],
        "laticauda.paper.side_trials": ["SideSettings", "run_side_trials"],
    },
    renamed={"simulated": "score_simulations"},
)
