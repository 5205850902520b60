"""The `Trial`, the time-stamped log of one run: its figures, its Dataset, comparisons, and what was measured."""

from typing import TYPE_CHECKING

from laticauda.values.packaging import lazy_exports

if TYPE_CHECKING:
    from laticauda.trials.contents import FORCE_COMPONENTS as FORCE_COMPONENTS
    from laticauda.trials.cycles import CycleMean as CycleMean
    from laticauda.trials.dataset import Format as Format
    from laticauda.trials.measured import (
        MeasuredTrial as MeasuredTrial,
        MeasuredTrials as MeasuredTrials,
        all_measured as all_measured,
        measured_counterpart as measured_counterpart,
        measured_setting as measured_setting,
    )
    from laticauda.trials.several import (
        ComparedFigure as ComparedFigure,
        compare as compare,
        joined as joined,
    )
    from laticauda.trials.trial import FIGURES as FIGURES, Figure as Figure, Trial as Trial

__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {
        "laticauda.trials.contents": ["FORCE_COMPONENTS"],
        "laticauda.trials.cycles": ["CycleMean"],
        "laticauda.trials.dataset": ["Format"],
        "laticauda.trials.measured": [
            "MeasuredTrial",
            "MeasuredTrials",
            "all_measured",
            "measured_counterpart",
            "measured_setting",
        ],
        "laticauda.trials.several": ["ComparedFigure", "compare", "joined"],
        "laticauda.trials.trial": ["FIGURES", "Figure", "Trial"],
    },
)
