"""A picture of the fitted chain over the tracked points, so that a person sees whether it holds."""

import numpy as np
from matplotlib.figure import Figure

from laticauda.film.forces.inverse import FilmForces
from laticauda.film.tracking import BodyTrack, draw_over_frames
from laticauda.robot import kinematics


def draw_chain(forces: FilmForces) -> Figure:
    """Draw the fitted chain over the tracked points in six frames of the film.

    Args:
        forces: The figures of the swim.
    """
    fit = forces.fit
    motion = fit.motion(fit.model.time)
    track = BodyTrack(
        robot=fit.robot,
        time=fit.model.time,
        center_of_mass=motion.center_of_mass,
        link_angle=kinematics.link_angles(motion.joint_angle, angle=motion.heading),
        frame=np.arange(fit.model.time.size),
        points=fit.points,
        calibration=None,
        center_deviation=np.nan,
    )
    return draw_over_frames(track)
