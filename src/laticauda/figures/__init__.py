"""Figures of trials: one function per figure, which takes data and axes and returns the axes."""

from typing import TYPE_CHECKING

from laticauda.packaging import lazy_exports

if TYPE_CHECKING:
    from laticauda.figures.film import Film as Film, swim_film as swim_film
    from laticauda.figures.path import path_strip as path_strip
    from laticauda.figures.several import overlay as overlay, sweep_sheet as sweep_sheet
    from laticauda.figures.style import new_figure as new_figure, save_figure as save_figure
    from laticauda.figures.swim import (
        follow_sheet as follow_sheet,
        joint_angle as joint_angle,
        joint_torque as joint_torque,
        sheet as sheet,
        speed as speed,
        swim_sheet as swim_sheet,
        timing_sheet as timing_sheet,
    )

__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {
        "laticauda.figures.film": ["Film", "swim_film"],
        "laticauda.figures.path": ["path_strip"],
        "laticauda.figures.several": ["overlay", "sweep_sheet"],
        "laticauda.figures.style": ["new_figure", "save_figure"],
        "laticauda.figures.swim": [
            "follow_sheet",
            "joint_angle",
            "joint_torque",
            "sheet",
            "speed",
            "swim_sheet",
            "timing_sheet",
        ],
    },
)
