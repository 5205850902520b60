"""Pictures of trials: one function per figure, which takes data and axes and returns the axes."""

from laticauda.figures.path import path_strip
from laticauda.figures.style import new_figure, save_figure
from laticauda.figures.swim import follow_sheet, joint_angle, joint_torque, speed, swim_sheet
from laticauda.figures.timing import timing_sheet

__all__ = [
    "follow_sheet",
    "joint_angle",
    "joint_torque",
    "new_figure",
    "path_strip",
    "save_figure",
    "speed",
    "swim_sheet",
    "timing_sheet",
]
