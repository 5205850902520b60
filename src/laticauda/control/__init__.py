"""Guidance, control and paths to follow: from the observation of a robot to its commanded gait.

Independent of model and hardware: the same controller steers the planar model and the robot in the
tank.
"""

from laticauda.control.averaged import AveragedModel as AveragedModel
from laticauda.control.averaged import OffsetSteps as OffsetSteps, fit_averaged as fit_averaged
from laticauda.control.current import CurrentObserver as CurrentObserver
from laticauda.control.following import Course as Course, Following as Following
from laticauda.control.frames import Path as Path, PathFrame as PathFrame
from laticauda.control.guidance import Guidance as Guidance, HeadingController as HeadingController
from laticauda.control.guidance import (
    HeadingEstimate as HeadingEstimate,
    LineOfSight as LineOfSight,
)
from laticauda.control.guidance import IntegralLineOfSight as IntegralLineOfSight
from laticauda.control.path_following import (
    PathFollowing as PathFollowing,
    PathFollowingState as PathFollowingState,
)
from laticauda.control.path_following import SpatialPathFollowing as SpatialPathFollowing
from laticauda.control.path_following import SpatialPathFollowingState as SpatialPathFollowingState
from laticauda.control.paths import Circle as Circle, Polyline as Polyline, Spline as Spline
from laticauda.control.paths import StraightLine as StraightLine
from laticauda.control.predictive import (
    ModelPredictive as ModelPredictive,
    PlanLimits as PlanLimits,
)
from laticauda.control.predictive import PredictiveState as PredictiveState
from laticauda.packaging import lazy_exports

__getattr__, __dir__, __all__ = lazy_exports()
