"""From tags or points in a film to a trial.

body     where a body was in every frame
trials   a trial of it: path, heading, joint angles
measuring  the path as a measurement for an identification
picture  the chain over frames of the film
"""

from typing import TYPE_CHECKING

from laticauda.values import lazy_exports

if TYPE_CHECKING:
    from laticauda.film.tracking.body import (
        BodyTrack as BodyTrack,
        LinkPoses as LinkPoses,
        follow_points as follow_points,
        follow_tags as follow_tags,
        poses_of_links as poses_of_links,
    )
    from laticauda.film.tracking.measuring import measure_path as measure_path
    from laticauda.film.tracking.picture import draw_over_frames as draw_over_frames
    from laticauda.film.tracking.trials import build_trial as build_trial

__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {
        "laticauda.film.tracking.body": [
            "BodyTrack",
            "LinkPoses",
            "follow_points",
            "follow_tags",
            "poses_of_links",
        ],
        "laticauda.film.tracking.measuring": ["measure_path"],
        "laticauda.film.tracking.picture": ["draw_over_frames"],
        "laticauda.film.tracking.trials": ["build_trial"],
    },
)
