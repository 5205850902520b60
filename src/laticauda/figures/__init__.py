"""Figures of trials: one function per figure, which takes data and axes and returns the axes."""

from typing import TYPE_CHECKING

from laticauda.packaging import lazy_exports

if TYPE_CHECKING:
    from laticauda.figures.film import Film as Film, swim_film as swim_film
    from laticauda.figures.path import path_strip as path_strip
    from laticauda.figures.several import plot_overlay as plot_overlay, sweep_sheet as sweep_sheet
    from laticauda.figures.style import new_figure as new_figure, save_figure as save_figure
    from laticauda.figures.swim import (
        follow_sheet as follow_sheet,
        plot_joint_angle as plot_joint_angle,
        plot_joint_torque as plot_joint_torque,
        sheet as sheet,
        plot_speed as plot_speed,
        swim_sheet as swim_sheet,
        timing_sheet as timing_sheet,
    )

__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {
        "laticauda.figures.film": ["Film", "swim_film"],
        "laticauda.figures.path": ["path_strip"],
        "laticauda.figures.several": ["plot_overlay", "sweep_sheet"],
        "laticauda.figures.style": ["new_figure", "save_figure"],
        "laticauda.figures.swim": [
            "follow_sheet",
            "plot_joint_angle",
            "plot_joint_torque",
            "sheet",
            "plot_speed",
            "swim_sheet",
            "timing_sheet",
        ],
    },
    renamed={
        "joint_angle": "plot_joint_angle",
        "joint_torque": "plot_joint_torque",
        "overlay": "plot_overlay",
        "speed": "plot_speed",
    },
)
