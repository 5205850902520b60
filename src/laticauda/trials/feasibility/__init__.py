"""Can this robot do it? What a run demands of the joints, and whether links overlap.

actuators.py     joint limits and torque-speed lines: what the robot offers
link_overlap.py  links that fold over each other, or cross
scanning.py      utilization from peaks that are already known
figures.py       peak demands as numbers, of one run or of many side by side
judgment.py      the same of one run, in sentences
"""

from laticauda.trials.feasibility.actuators import duty as duty
from laticauda.trials.feasibility.figures import (
    CAN_DO as CAN_DO,
    MOST_POSTURES as MOST_POSTURES,
    NEEDS as NEEDS,
    ROUNDING as ROUNDING,
    compute_joint_shares as compute_joint_shares,
    compute_peaks as compute_peaks,
    count_unsettled_samples as count_unsettled_samples,
    find_settled_samples as find_settled_samples,
    make_peak_figure as make_peak_figure,
    spread_evenly as spread_evenly,
)
from laticauda.trials.feasibility.judgment import (
    SERVOS as SERVOS,
    Feasibility as Feasibility,
    describe_ability as describe_ability,
    exceeds_actuators as exceeds_actuators,
    judge_feasibility as judge_feasibility,
)
from laticauda.trials.feasibility.link_overlap import (
    measure_crossing as measure_crossing,
    measure_overlap as measure_overlap,
)
from laticauda.trials.feasibility.scanning import (
    ScanLimits as ScanLimits,
    include_neighbors as include_neighbors,
)
from laticauda.values.packaging import renamed_names

# Names of 0.2, for one release.
__getattr__ = renamed_names(__name__, {"feasibility": "judge_feasibility"})
