"""Guidance, control and paths to follow: from the observation of a robot to its commanded gait.

Independent of model and hardware: the same controller steers the planar model and the robot in the
tank.

- frames: what a path is to guidance, and the position of a robot relative to it
- curve: smooth curve through points; paths: line, circle, legs and smooth curve as paths
- guidance: laws that give a heading, its estimate, and the offset that turns the robot there
- path_following, spatial_path_following: the controllers, in plan and in space
- vector_paths, vector_guidance, vector_following: the same of many robots at once, as arrays
- following: their parameters as in trial files and on the command line
- averaged: a model of the motion from cycle to cycle; averaged_fit: its fit to trials;
  offset_steps: a maneuver that identifies it; current: an observer of the current, built on it
- neural: gaits by oscillators and neurons, with feedback from the body
- mpc: guidance that plans ahead; estimation: position and motion of the robot from samples
"""

from typing import TYPE_CHECKING

from laticauda.values import lazy_exports

if TYPE_CHECKING:
    from laticauda.control.averaged import AveragedModel as AveragedModel
    from laticauda.control.averaged_fit import fit_averaged as fit_averaged
    from laticauda.control.offset_steps import OffsetSteps as OffsetSteps
    from laticauda.control.current import CurrentObserver as CurrentObserver
    from laticauda.control.following import Course as Course, Following as Following
    from laticauda.control.frames import Path as Path, PathFrame as PathFrame
    from laticauda.control.guidance import (
        Guidance as Guidance,
        HeadingController as HeadingController,
        HeadingEstimate as HeadingEstimate,
        IntegralLineOfSight as IntegralLineOfSight,
        LineOfSight as LineOfSight,
        HeadingSample as HeadingSample,
        ROUNDING as ROUNDING,
        compute_mean_heading as compute_mean_heading,
        extend_integral as extend_integral,
    )
    from laticauda.control.neural import (
        Feedback as Feedback,
        HalfCenters as HalfCenters,
        NeuralGait as NeuralGait,
        PhaseOscillators as PhaseOscillators,
    )
    from laticauda.control.path_following import (
        PathFollowing as PathFollowing,
        PathFollowingState as PathFollowingState,
        refuse_offset as refuse_offset,
    )
    from laticauda.control.paths import (
        Circle as Circle,
        Polyline as Polyline,
        Spline as Spline,
        StraightLine as StraightLine,
        transform_to_axes as transform_to_axes,
    )
    from laticauda.control.mpc.predictive import (
        ModelPredictive as ModelPredictive,
        PlanLimits as PlanLimits,
        PredictiveState as PredictiveState,
    )
    from laticauda.control.spatial_path_following import (
        SpatialPathFollowing as SpatialPathFollowing,
        SpatialPathFollowingState as SpatialPathFollowingState,
    )

__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {
        "laticauda.control.averaged": ["AveragedModel"],
        "laticauda.control.averaged_fit": ["fit_averaged"],
        "laticauda.control.offset_steps": ["OffsetSteps"],
        "laticauda.control.current": ["CurrentObserver"],
        "laticauda.control.following": ["Course", "Following"],
        "laticauda.control.frames": ["Path", "PathFrame"],
        "laticauda.control.guidance": [
            "Guidance",
            "HeadingController",
            "HeadingEstimate",
            "IntegralLineOfSight",
            "LineOfSight",
        ],
        "laticauda.control.neural": [
            "Feedback",
            "HalfCenters",
            "NeuralGait",
            "PhaseOscillators",
        ],
        "laticauda.control.path_following": ["PathFollowing", "PathFollowingState"],
        "laticauda.control.paths": ["Circle", "Polyline", "Spline", "StraightLine"],
        "laticauda.control.mpc.predictive": ["ModelPredictive", "PlanLimits", "PredictiveState"],
        "laticauda.control.spatial_path_following": [
            "SpatialPathFollowing",
            "SpatialPathFollowingState",
        ],
    },
    plain={
        "laticauda.control.guidance": [
            "HeadingSample",
            "ROUNDING",
            "compute_mean_heading",
            "extend_integral",
        ],
        "laticauda.control.path_following": ["refuse_offset"],
        "laticauda.control.paths": ["transform_to_axes"],
    },
)
