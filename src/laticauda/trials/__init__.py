"""The `Trial`, the time-stamped log of one run: its figures, its Dataset, comparisons, and what was measured.

contents.py     what a trial holds, validated
arrays.py       checks of its arrays and texts
trial.py        `Trial`: the contents, with figures, pictures and files
metrics.py      formulas of the figures
moving_water.py what a current does to a run, in words
wake.py         the wake of the robot, as water for another one
load_figures.py figures of what the joints carry
edge.py         incidence of the trailing edge, and whether its law holds
cycles.py       whole gait cycles of a log, and means over them
feasibility/    whether the robot can do what the run demands
following.py    figures of path following
dataset.py      conversion to a Dataset and back, and file formats
several.py      trials compared, or joined into one
markers.py      markers on the body, beside those seen by cameras
measured.py     published trials, and tables of speeds
null_models.py  speeds predicted without physics
logs/           files of trials and of other programs
"""

from typing import TYPE_CHECKING

from laticauda.values import lazy_exports

if TYPE_CHECKING:
    from laticauda.trials.contents import (
        FORCE_COMPONENTS as FORCE_COMPONENTS,
        REACHED_END as REACHED_END,
        Setting as Setting,
    )
    from laticauda.trials.cycles import (
        CycleMean as CycleMean,
        TRANSIENT as TRANSIENT,
        hermite as hermite,
    )
    from laticauda.trials.dataset import Format as Format, AXES as AXES
    from laticauda.trials.measured import (
        MeasuredTrial as MeasuredTrial,
        MeasuredTrials as MeasuredTrials,
        all_measured as all_measured,
        measured_counterpart as measured_counterpart,
        measured_setting as measured_setting,
    )
    from laticauda.trials.several import (
        ComparedFigure as ComparedFigure,
        Comparison as Comparison,
        compare as compare,
        joined as joined,
        note_differences as note_differences,
    )
    from laticauda.trials.trial import (
        FIGURES as FIGURES,
        Figure as Figure,
        Trial as Trial,
        shown_figures as shown_figures,
    )
    from laticauda.trials.wake import WakeOfTrial as WakeOfTrial, measure_wake as measure_wake
    from laticauda.trials.edge import (
        ThrustError as ThrustError,
        describe_edge as describe_edge,
        thrust_error as thrust_error,
    )
    from laticauda.trials.following import nearest_points as nearest_points
    from laticauda.trials.load_figures import (
        LOAD_FIGURES as LOAD_FIGURES,
        compute_load_figure as compute_load_figure,
    )
    from laticauda.trials.side_pressure import side_areas as side_areas
    from laticauda.trials.moving_water import (
        MOVING_WATER_NOTE as MOVING_WATER_NOTE,
        describe_sweeping as describe_sweeping,
        water_moves as water_moves,
    )
    from laticauda.trials.null_models import (
        NullModel as NullModel,
        PREDICTORS as PREDICTORS,
        Row as Row,
        Values as Values,
        compared as compared,
        group_name as group_name,
        mape as mape,
        predict as predict,
    )

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
        "laticauda.trials.several": ["ComparedFigure", "Comparison", "compare", "joined"],
        "laticauda.trials.trial": ["FIGURES", "Figure", "Trial"],
        "laticauda.trials.wake": ["WakeOfTrial", "measure_wake"],
    },
    plain={
        "laticauda.trials.contents": ["REACHED_END", "Setting"],
        "laticauda.trials.cycles": ["TRANSIENT", "hermite"],
        "laticauda.trials.dataset": ["AXES"],
        "laticauda.trials.edge": ["ThrustError", "describe_edge", "thrust_error"],
        "laticauda.trials.following": ["nearest_points"],
        "laticauda.trials.load_figures": ["LOAD_FIGURES", "compute_load_figure"],
        "laticauda.trials.several": ["note_differences"],
        "laticauda.trials.side_pressure": ["side_areas"],
        "laticauda.trials.moving_water": ["MOVING_WATER_NOTE", "describe_sweeping", "water_moves"],
        "laticauda.trials.trial": ["shown_figures"],
        "laticauda.trials.null_models": [
            "NullModel",
            "PREDICTORS",
            "Row",
            "Values",
            "compared",
            "group_name",
            "mape",
            "predict",
        ],
    },
)
