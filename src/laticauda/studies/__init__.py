"""Studies of many trials: sweeps and searches, and their combined results.

point_trials    the trials of a study: one scenario, other numbers at every point
sampling        points of a sweep: a grid, a list, or samples
regions         pieces of a sweep that are computed in one go
sweep           definition of a sweep
store           writing a sweep's folder
stored_sweep    reading it
damage          which of its regions are damaged
checksums       which of its other files are
running         running a sweep, here or on a cluster (`remote_points`)
sharing         shares of a sweep, each run by a process of its own, and their merger
design_limits   battery, mass, buoyancy, lengths: what a design must respect
optimization    definition of an optimization, and the evaluation of its points
choosing        which search an optimization takes
point_search    what all searches have in common
search          an evolution: which points to try next
slope_search    the same with the slopes of one objective
cma_search      CMA-ES
limited_search  along the slopes of one objective and of all limits
local_model     these slopes
quadratic       quadratic programs
checkpoint      the points tried so far, in a file
optimize        an optimization from beginning to end
front           its result
limits          what limits the robot at a point
judging         what a design takes of its limits
folder          folders of jobs that can be stopped and resumed
averaged        averaged model of a gait, for model-predictive guidance
"""

from typing import TYPE_CHECKING

from laticauda.values import lazy_exports
from laticauda.studies.optimize import optimize as optimize  # at once: a module has its name

if TYPE_CHECKING:
    from laticauda.studies.averaged import averaged_model as averaged_model
    from laticauda.studies.front import Front as Front, pareto_front as pareto_front
    from laticauda.studies.judging import (
        Judgment as Judgment,
        LimitUse as LimitUse,
        judge_design as judge_design,
        judge_point as judge_point,
    )
    from laticauda.studies.optimization import (
        OBJECTIVES as OBJECTIVES,
        Optimization as Optimization,
        SPEED_POWER as SPEED_POWER,
        Limits as Limits,
    )
    from laticauda.studies.running import run_sweep as run_sweep
    from laticauda.studies.sampling import (
        Grid as Grid,
        Rows as Rows,
        Samples as Samples,
        Points as Points,
    )
    from laticauda.studies.sharing import (
        Share as Share,
        merge_shares as merge_shares,
        Merged as Merged,
        StoredShare as StoredShare,
        find_shares as find_shares,
        list_shares as list_shares,
        parse_share as parse_share,
    )
    from laticauda.studies.stored_sweep import (
        best_points as best_points,
        count_failed as count_failed,
        count_infeasible as count_infeasible,
        open_sweep as open_sweep,
    )
    from laticauda.studies.sweep import Sweep as Sweep
    from laticauda.studies.choosing import Method as Method
    from laticauda.studies.design_limits import DesignLimits as DesignLimits
    from laticauda.studies.limits import (
        describe_limits as describe_limits,
        name_limits as name_limits,
    )
    from laticauda.studies.point_trials import (
        COSTS as COSTS,
        LABELS as LABELS,
        Progress as Progress,
        attributes_of as attributes_of,
        moves_water as moves_water,
        scenarios_at as scenarios_at,
        swim_points as swim_points,
        swum_figure as swum_figure,
    )
    from laticauda.studies.folder import storage as storage
    from laticauda.studies.remote_points import GO_ON as GO_ON

__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {
        "laticauda.studies.averaged": ["averaged_model"],
        "laticauda.studies.front": ["Front", "pareto_front"],
        "laticauda.studies.judging": ["Judgment", "LimitUse", "judge_design"],
        "laticauda.studies.optimization": ["OBJECTIVES", "Optimization", "SPEED_POWER"],
        "laticauda.studies.running": ["run_sweep"],
        "laticauda.studies.sampling": ["Grid", "Rows", "Samples"],
        "laticauda.studies.sharing": ["Share", "merge_shares"],
        "laticauda.studies.stored_sweep": [
            "best_points",
            "count_failed",
            "count_infeasible",
            "open_sweep",
        ],
        "laticauda.studies.sweep": ["Sweep"],
    },
    own=["optimize"],
    plain={
        "laticauda.studies.optimization": ["Limits"],
        "laticauda.studies.choosing": ["Method"],
        "laticauda.studies.design_limits": ["DesignLimits"],
        "laticauda.studies.judging": ["judge_point"],
        "laticauda.studies.limits": ["describe_limits", "name_limits"],
        "laticauda.studies.point_trials": [
            "COSTS",
            "LABELS",
            "Progress",
            "attributes_of",
            "moves_water",
            "scenarios_at",
            "swim_points",
            "swum_figure",
        ],
        "laticauda.studies.sampling": ["Points"],
        "laticauda.studies.folder": ["storage"],
        "laticauda.studies.remote_points": ["GO_ON"],
        "laticauda.studies.sharing": [
            "Merged",
            "StoredShare",
            "find_shares",
            "list_shares",
            "parse_share",
        ],
    },
    renamed={"best": "best_points", "unbeaten": "pareto_front"},
)
