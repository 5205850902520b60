"""Guidance, control and the paths to follow: from what is seen of a robot to the gait that it is asked for.

Knows no model and no hardware: the same controller steers the planar model and the robot in the tank.
"""

from laticauda.control.averaged import AveragedModel
from laticauda.control.averaging import OffsetSteps, fit_averaged
from laticauda.control.frames import Path, PathFrame
from laticauda.control.guidance import Guidance, IntegralLineOfSight, LineOfSight
from laticauda.control.heading import HeadingController, HeadingEstimate
from laticauda.control.path_following import HEADING_ESTIMATES, Following, PathFollowing, PathFollowingState
from laticauda.control.paths import Polyline, Spline, StraightLine
from laticauda.control.predictive import ModelPredictive, PredictiveState
from laticauda.control.spatial_following import SpatialPathFollowing, SpatialPathFollowingState

__all__ = [
    "HEADING_ESTIMATES",
    "AveragedModel",
    "Following",
    "Guidance",
    "HeadingController",
    "HeadingEstimate",
    "IntegralLineOfSight",
    "LineOfSight",
    "ModelPredictive",
    "OffsetSteps",
    "Path",
    "PathFollowing",
    "PathFollowingState",
    "PathFrame",
    "Polyline",
    "PredictiveState",
    "SpatialPathFollowing",
    "SpatialPathFollowingState",
    "Spline",
    "StraightLine",
    "fit_averaged",
]
