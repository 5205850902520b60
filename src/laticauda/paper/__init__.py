"""The paper, repeated in simulation and compared with measurements on the robot; it uses all layers below.

- `measured`: what the paper printed, Tables 1 and 2.
- `settings`: what is run, from `paper.toml`; `runs`: how a study is run, and its coefficients.
- `efficiency`, `path_following`, `side_trials`: the studies.
- `repeats`: repeated trials of a user's own robot.
- `fin_effect`, `scores`: changes due to the fin, and errors of all predictors.
- `figures`, `speed_figures`: how results are drawn.
- `claims`: the paper's claims, judged by the results.
- `report`: the report in one folder; `command`: `laticauda reproduce`.

Every run looks up the measured tables, so nothing else is imported for them.
"""

from typing import TYPE_CHECKING

from laticauda.values import lazy_exports

if TYPE_CHECKING:
    from laticauda.paper.claims.judge import Claim as Claim
    from laticauda.paper.efficiency import (
        EfficiencyStudy as EfficiencyStudy,
        maxima as maxima,
        run_efficiency as run_efficiency,
    )
    from laticauda.paper.fin_effect import fin_gains as fin_gains
    from laticauda.paper.measured import (
        efficiency_trials as efficiency_trials,
        measured_trial as measured_trial,
        path_following_trials as path_following_trials,
    )
    from laticauda.paper.path_following import (
        PathFollowingStudy as PathFollowingStudy,
        run_path_following as run_path_following,
    )
    from laticauda.paper.repeats import (
        Repeat as Repeat,
        TABLE2 as TABLE2,
        load_repeats as load_repeats,
    )
    from laticauda.paper.report.reproduce import (
        Experiments as Experiments,
        paper_experiments as paper_experiments,
        reproduce as reproduce,
    )
    from laticauda.paper.runs import Coefficients as Coefficients
    from laticauda.paper.scores import (
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
        "laticauda.paper.efficiency": ["EfficiencyStudy", "maxima", "run_efficiency"],
        "laticauda.paper.fin_effect": ["fin_gains"],
        "laticauda.paper.measured": [
            "efficiency_trials",
            "measured_trial",
            "path_following_trials",
        ],
        "laticauda.paper.path_following": ["PathFollowingStudy", "run_path_following"],
        "laticauda.paper.repeats": ["Repeat", "TABLE2", "load_repeats"],
        "laticauda.paper.report.reproduce": ["Experiments", "paper_experiments", "reproduce"],
        "laticauda.paper.runs": ["Coefficients"],
        "laticauda.paper.scores": [
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
