"""The paper, repeated in simulation and compared with measurements on the robot; it uses all layers below.

Every run looks up the measured tables, so nothing else is imported for them.
"""

from typing import TYPE_CHECKING

from laticauda.packaging import lazy_exports

if TYPE_CHECKING:
    from laticauda.paper.claims.judge import Claim as Claim
    from laticauda.paper.efficiency import EfficiencyStudy as EfficiencyStudy, maxima as maxima
    from laticauda.paper.efficiency import run_efficiency as run_efficiency
    from laticauda.paper.measured import (
        efficiency_trials as efficiency_trials,
        measured_trial as measured_trial,
    )
    from laticauda.paper.measured import path_following_trials as path_following_trials
    from laticauda.paper.path_following import PathFollowingStudy as PathFollowingStudy
    from laticauda.paper.path_following import run_path_following as run_path_following
    from laticauda.paper.efficiency import (
        TABLE2 as TABLE2,
        Repeat as Repeat,
        load_repeats as load_repeats,
    )
    from laticauda.paper.report.reproduce import (
        Experiments as Experiments,
        paper_experiments as paper_experiments,
    )
    from laticauda.paper.report.reproduce import reproduce as reproduce
    from laticauda.paper.runs import Coefficients as Coefficients
    from laticauda.paper.scores import fin_gains as fin_gains, meter_costs as meter_costs
    from laticauda.paper.scores import null_predictions as null_predictions, simulated as simulated
    from laticauda.paper.settings import (
        PARAMETERS as PARAMETERS,
        efficiency_settings as efficiency_settings,
    )
    from laticauda.paper.settings import path_following_settings as path_following_settings
    from laticauda.paper.side_trials import (
        SideSettings as SideSettings,
        run_side_trials as run_side_trials,
    )

__getattr__, __dir__, __all__ = lazy_exports()
