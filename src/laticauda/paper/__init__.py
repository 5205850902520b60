"""The paper, repeated in simulation and compared with measurements on the robot.

It uses all layers below, by their public faces:

- `measured`: what the paper printed, Tables 1 and 2.
- `settings`: what is run, from `paper.toml`; `runs`: how a study is run, and its coefficients.
- `efficiency`, `path_following`, `side_trials`: the studies.
- `repeats`: repeated trials of a user's own robot.
- `fin_effect`, `scores`: changes due to the fin, and errors of all predictors.
- `figures`, `speed_figures`: how results are drawn.
- `claims`: the paper's claims, judged by the results.
- `report`: the report in one folder; `command`: `laticauda reproduce`.

A *case* is a row of a table, and a *group* its cases with one gait and one configuration of the
robot. A *model* of the efficiency study is a set of fluid coefficients; the claims are *judged* by
one of them. A *null model* predicts speeds without physics. The *band* is every combination of
joint law and bandwidth in which a path is followed, and one of these *ways* is the chosen one.

Every trial that is shown looks up the measured tables, so what else is here is imported when first
used.
"""

from typing import TYPE_CHECKING

from laticauda.values import lazy_exports

if TYPE_CHECKING:
    from laticauda.paper.claims.judge import Claim as Claim
    from laticauda.paper.efficiency import (
        EfficiencyStudy as EfficiencyStudy,
        find_maxima as find_maxima,
        run_efficiency as run_efficiency,
    )
    from laticauda.paper.fin_effect import find_fin_gains as find_fin_gains
    from laticauda.paper.measured import (
        read_efficiency_trials as read_efficiency_trials,
        find_measured_trial as find_measured_trial,
        read_path_following_trials as read_path_following_trials,
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
        plan_experiments as plan_experiments,
        reproduce as reproduce,
    )
    from laticauda.paper.runs import Coefficients as Coefficients
    from laticauda.paper.scores import (
        compute_meter_costs as compute_meter_costs,
        score_null_predictions as score_null_predictions,
        score_simulations as score_simulations,
    )
    from laticauda.paper.settings import (
        PARAMETERS as PARAMETERS,
        load_efficiency_settings as load_efficiency_settings,
        load_path_following_settings as load_path_following_settings,
    )
    from laticauda.paper.side_trials import (
        SideSettings as SideSettings,
        run_side_trials as run_side_trials,
    )

__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {
        "laticauda.paper.claims.judge": ["Claim"],
        "laticauda.paper.efficiency": ["EfficiencyStudy", "find_maxima", "run_efficiency"],
        "laticauda.paper.fin_effect": ["find_fin_gains"],
        "laticauda.paper.measured": [
            "read_efficiency_trials",
            "find_measured_trial",
            "read_path_following_trials",
        ],
        "laticauda.paper.path_following": ["PathFollowingStudy", "run_path_following"],
        "laticauda.paper.repeats": ["Repeat", "TABLE2", "load_repeats"],
        "laticauda.paper.report.reproduce": ["Experiments", "plan_experiments", "reproduce"],
        "laticauda.paper.runs": ["Coefficients"],
        "laticauda.paper.scores": [
            "compute_meter_costs",
            "score_null_predictions",
            "score_simulations",
        ],
        "laticauda.paper.settings": [
            "PARAMETERS",
            "load_efficiency_settings",
            "load_path_following_settings",
        ],
        "laticauda.paper.side_trials": ["SideSettings", "run_side_trials"],
    },
    renamed={
        "efficiency_settings": "load_efficiency_settings",
        "efficiency_trials": "read_efficiency_trials",
        "fin_gains": "find_fin_gains",
        "maxima": "find_maxima",
        "measured_trial": "find_measured_trial",
        "meter_costs": "compute_meter_costs",
        "null_predictions": "score_null_predictions",
        "paper_experiments": "plan_experiments",
        "path_following_settings": "load_path_following_settings",
        "path_following_trials": "read_path_following_trials",
        "simulated": "score_simulations",
    },
)
