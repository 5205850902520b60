"""Figures of trials: one function per figure, which takes data and axes and returns the axes.

style     sizes, colors and labels of all figures
posture   the body, true to scale
water     the motion of the water under a path
places    what stands in the water: nets, walls, pipes, docks, buoys
path      the path of a run, with postures along it
swim      speed, joint angles and torques; the sheet of a run
follow    the sheet of a run that followed a path
sheets    which of the two a run gets
several   several runs in one figure
sweep     the results of a sweep
timing    how late the loop of an operated run was
film      a run in the plane as a film
"""

from typing import TYPE_CHECKING

from laticauda.values import lazy_exports

if TYPE_CHECKING:
    from laticauda.show.figures.film import Film as Film, swim_film as swim_film
    from laticauda.show.figures.path import path_extent as path_extent, path_strip as path_strip
    from laticauda.show.figures.places import (
        draw_places as draw_places,
        outlines_of as outlines_of,
        places_of as places_of,
    )
    from laticauda.show.figures.posture import draw_posture as draw_posture, outline as outline
    from laticauda.show.figures.several import plot_overlay as plot_overlay
    from laticauda.show.figures.sweep import sweep_sheet as sweep_sheet
    from laticauda.show.figures.style import (
        new_figure as new_figure,
        new_panels as new_panels,
        picture_in_html as picture_in_html,
        save_figure as save_figure,
    )
    from laticauda.show.figures.follow import follow_sheet as follow_sheet
    from laticauda.show.figures.sheets import sheet as sheet
    from laticauda.show.figures.swim import (
        plot_joint_angle as plot_joint_angle,
        plot_joint_torque as plot_joint_torque,
        plot_speed as plot_speed,
        swim_sheet as swim_sheet,
    )
    from laticauda.show.figures.timing import timing_sheet as timing_sheet

__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {
        "laticauda.show.figures.film": ["Film", "swim_film"],
        "laticauda.show.figures.path": ["path_extent", "path_strip"],
        "laticauda.show.figures.places": ["draw_places", "outlines_of", "places_of"],
        "laticauda.show.figures.posture": ["draw_posture", "outline"],
        "laticauda.show.figures.several": ["plot_overlay"],
        "laticauda.show.figures.sweep": ["sweep_sheet"],
        "laticauda.show.figures.style": [
            "new_figure",
            "new_panels",
            "picture_in_html",
            "save_figure",
        ],
        "laticauda.show.figures.follow": ["follow_sheet"],
        "laticauda.show.figures.sheets": ["sheet"],
        "laticauda.show.figures.swim": [
            "plot_joint_angle",
            "plot_joint_torque",
            "plot_speed",
            "swim_sheet",
        ],
        "laticauda.show.figures.timing": ["timing_sheet"],
    },
    renamed={
        "joint_angle": "plot_joint_angle",
        "joint_torque": "plot_joint_torque",
        "overlay": "plot_overlay",
        "speed": "plot_speed",
    },
)
