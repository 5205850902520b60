"""Tank day: two hours of trials, and the robot's own water identified from them.

`prepare_folder` creates a folder with a list of runs, the robot, and files to fill in; `evaluate`
fits its contents. The joints follow their logged angles, so that only the water is fitted. Three
laws of the water are fitted to the same trials, each with free friction and with the other numbers
near tabulated ones for the robot's cross sections:

    kirchhoff   added mass of potential flow, shed at the tail end; quadratic drag, beta free
    relative    added mass without Munk moment and wake; quadratic drag, beta free
    linear      the same with linear and quadratic drag, U_ref free

They are compared by their probabilities given the data, in Laplace's approximation,

    ln p = -Q/2 + ln det(C)/2 - sum ln s + const.

with the sum of squares Q of data and priors, the covariance C of the unknowns and the standard
deviations s of their priors. If the best law leaves residuals of k > 1 times the stated noise, Q
and C are computed with k times that noise. An unknown without a prior that no trial determines
counts as known from its range alone (`laws`).

    folder       the files to fill in, and what they hold
    laws         the three laws, and their probabilities
    evaluation   the fits, and the verdict
    report       results as text, plain values and files
"""

from typing import TYPE_CHECKING

from laticauda.values import lazy_exports

if TYPE_CHECKING:
    from laticauda.identify.tank_day.evaluation import (
        DECISIVE as DECISIVE,
        JOINTS as JOINTS,
        Evaluation as Evaluation,
        evaluate as evaluate,
    )
    from laticauda.identify.tank_day.folder import (
        DAY as DAY,
        Day as Day,
        Noise as Noise,
        load_day as load_day,
        prepare_folder as prepare_folder,
    )
    from laticauda.identify.tank_day.report import (
        format_evaluation as format_evaluation,
        tabulate_evaluation as tabulate_evaluation,
        write_result as write_result,
    )

__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {
        "laticauda.identify.tank_day.evaluation": [
            "DECISIVE",
            "JOINTS",
            "Evaluation",
            "evaluate",
        ],
        "laticauda.identify.tank_day.folder": [
            "DAY",
            "Day",
            "Noise",
            "load_day",
            "prepare_folder",
        ],
        "laticauda.identify.tank_day.report": [
            "format_evaluation",
            "tabulate_evaluation",
            "write_result",
        ],
    },
)
