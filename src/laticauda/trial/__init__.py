"""The `Trial`, the time-stamped log of one run: its figures, its Dataset, comparisons, and what was measured."""

from typing import TYPE_CHECKING

from laticauda.packaging import lazy_exports

if TYPE_CHECKING:
    from laticauda.trial.contents import FORCE_COMPONENTS as FORCE_COMPONENTS
    from laticauda.trial.cycles import CycleMean as CycleMean
    from laticauda.trial.dataset import Format as Format
    from laticauda.trial.measured import (
        MeasuredTrial as MeasuredTrial,
        MeasuredTrials as MeasuredTrials,
        all_measured as all_measured,
        measured_counterpart as measured_counterpart,
        measured_setting as measured_setting,
    )
    from laticauda.trial.several import (
        ComparedFigure as ComparedFigure,
        compare as compare,
        joined as joined,
    )
    from laticauda.trial.trial import FIGURES as FIGURES, Figure as Figure, Trial as Trial

__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {
        "laticauda.trial.contents": ["FORCE_COMPONENTS"],
        "laticauda.trial.cycles": ["CycleMean"],
        "laticauda.trial.dataset": ["Format"],
        "laticauda.trial.measured": [
            "MeasuredTrial",
            "MeasuredTrials",
            "all_measured",
            "measured_counterpart",
            "measured_setting",
        ],
        "laticauda.trial.several": ["ComparedFigure", "compare", "joined"],
        "laticauda.trial.trial": ["FIGURES", "Figure", "Trial"],
    },
)
