"""The posture in which a robot is drawn: of a trial at any time, or of a state of a plant."""

from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float

from laticauda.models.dynamics import Plant, PlantState
from laticauda.models.planar import PlanarPlant, rows, sample_format
from laticauda.models.spatial import SpatialPlant, mjcf
from laticauda.robot import Environment, Ground, Robot, kinematics
from laticauda.scenarios import interfaces
from laticauda.show.pictures.camera import lift_to_space
from laticauda.trials import Trial, hermite
from laticauda.water.fluid import has_waves

MID_WATER = 1.0
"""Depth at which a robot without one is shown [m]."""
NONE = np.zeros(0)


class Posture(NamedTuple):
    """Posture of a robot at one instant."""

    center_of_mass: Float[np.ndarray, "3"]
    """Position of the center of mass [m]."""
    orientation: Float[np.ndarray, "4"]
    """Orientation of module 0, a quaternion (w, x, y, z) [-]."""
    joint_angle: Float[np.ndarray, " n_joints"]
    """Angles of all joints of the robot, including those that the planar model holds straight [rad]."""
    fin_angle: Float[np.ndarray, " n_fin_joints"]
    """Angles of the joints of a driven or bending fin, starting at its root; straight if they are unknown [rad]."""
    time: float = 0.0
    """Time since the start of the run, which determines the motion of the water [s]."""
    scene_coordinates: Float[np.ndarray, " n_coordinates"] = NONE
    """MuJoCo's coordinates of what moves in the scene, nets included; empty: it is where it began [m, rad]."""


def choose_swimming_height(robot: Robot, environment: Environment) -> float:
    """Return the height at which a planar robot is shown [m]; the water surface, or the ground, is at 0."""
    if isinstance(environment, Ground):
        return mjcf.start_height(robot, environment)
    if environment.depth is not None:
        return -environment.depth
    if has_waves(environment.flow, np.zeros(2)):
        return 0.0  # the flow acts on it as if at the surface
    return -MID_WATER


# ---- of a plant ----------------------------------------------------------------------------------

N_PLANAR_ROOT = 3
"""Coordinates of a robot's root that stays upright, before its joints: x, y, angle."""
N_FREE_ROOT = 7
"""Coordinates of a free root: position and quaternion."""


def read_posture(plant: Plant[Any], state: PlantState) -> Posture:
    """Return the posture of a plant's robot in a state.

    Args:
        plant: A plant of either model.
        state: A state of the plant.
    """
    if isinstance(plant, SpatialPlant):
        return _read_spatial_posture(plant, state)
    assert isinstance(plant, PlanarPlant)
    return _read_planar_posture(plant, state)


def _read_spatial_posture(plant: SpatialPlant, state: Any) -> Posture:
    observation = plant.observe(state)
    robot = plant.robot
    coordinates = plant.data(state).qpos
    if plant.settings.root == "planar":
        orientation = turn_upright(float(coordinates[2]))
        first_joint = N_PLANAR_ROOT
    else:
        orientation = coordinates[3:7]
        first_joint = N_FREE_ROOT
    # Moving parts of the scene may follow the robot's joints.
    n_angles = len(robot.joints) + len(robot.fin_joints)
    angles = coordinates[first_joint:][:n_angles]
    of_scene = coordinates[first_joint + n_angles :]
    return Posture(
        center_of_mass=observation.center_of_mass,
        orientation=orientation,
        joint_angle=angles[: robot.n_joints],
        fin_angle=angles[robot.n_joints :],
        time=float(observation.time),
        scene_coordinates=of_scene.copy(),
    )


def _read_planar_posture(plant: PlanarPlant, state: Any) -> Posture:
    observation = plant.observe(state)
    robot = plant.robot
    columns = sample_format.columns_of_joints(rows.ANGLE, plant.layout.n_joints)
    angles = state.values[columns]
    fin_root = plant.layout.tail_link - 1
    fin_angle = np.array([angles[fin_root - k] for k in robot.fin_joints])
    posture = build_flat_posture(
        robot,
        center=observation.center_of_mass,
        tail=observation.link_angle[0],
        joint_angle=observation.joint_angle,
        fin_angle=fin_angle,
        height=choose_swimming_height(robot, plant.environment),
    )
    return posture._replace(time=float(observation.time))


def build_flat_posture(
    robot: Robot,
    center: np.ndarray,
    tail: float,
    joint_angle: np.ndarray,
    fin_angle: np.ndarray,
    height: float,
) -> Posture:
    """Return the posture of an upright robot.

    Args:
        robot: The robot with all its joints; if only angles of its yaw joints are known, the others
            are straight.
        center: Center of mass, in the plane or in space [m].
        tail: Angle of its tail link [rad].
        joint_angle: Angles of all joints, or of the yaw joints only [rad].
        fin_angle: Angles of the fin's joints [rad].
        height: Its height if `center` is planar [m].
    """
    has_only_yaw = joint_angle.size < robot.n_joints
    if has_only_yaw:
        joint_angle = _insert_straight_joints(robot, joint_angle)
    return Posture(
        center_of_mass=lift_to_space(center, height),
        orientation=turn_upright(tail),
        joint_angle=joint_angle,
        fin_angle=fin_angle,
    )


def _insert_straight_joints(robot: Robot, yaw: np.ndarray) -> np.ndarray:
    """Return the angles of all joints, if only those of the yaw joints are known [rad]."""
    yaw_joints = [index for index, joint in enumerate(robot.joints) if joint.axis == "yaw"]
    joint_angle = np.zeros(robot.n_joints)
    joint_angle[yaw_joints] = yaw
    return joint_angle


def turn_upright(angle: float) -> Float[np.ndarray, "4"]:
    """Return the orientation after a rotation about the vertical [rad]."""
    return np.array([np.cos(0.5 * angle), 0.0, 0.0, np.sin(0.5 * angle)])


# ---- of a trial ----------------------------------------------------------------------------------


class Interval(NamedTuple):
    """Two neighboring samples, and a time between them."""

    before: int
    """Index of the earlier sample."""
    after: int
    """Index of the later sample; that of the earlier one in a trial of one sample."""
    duration: float
    """Time between the two samples [s]."""
    share: float
    """Share of the duration that has passed at the time [-]."""

    def interpolate(self, values: np.ndarray, rates: np.ndarray) -> np.ndarray:
        """Return a signal at that time, smoothly from its samples and those of its time derivative."""
        before = np.atleast_1d(values[self.before])
        after = np.atleast_1d(values[self.after])
        rate_before = np.atleast_1d(rates[self.before])
        rate_after = np.atleast_1d(rates[self.after])
        return hermite(self.share, self.duration, (before, after), (rate_before, rate_after))


def interpolate_posture(trial: Trial, time: float, height: float) -> Posture:
    """Return the robot's posture, smoothly interpolated between samples.

    Args:
        trial: Any trial, planar or spatial.
        time: Time within the trial [s].
        height: Height at which a planar robot swims [m].

    Raises:
        ValueError: If a measured trial does not contain how the robot was bent.
    """
    trial.need("a picture of the robot", "joint_angle", "heading")
    interval = _find_interval(trial, time)
    center = interval.interpolate(trial.center_of_mass, trial.center_of_mass_velocity)
    joint_angle = interval.interpolate(trial.joint_angle, trial.joint_rate)
    fin_angle = interval.interpolate(trial.fin_angle, trial.fin_rate)
    is_spatial = center.size == 3
    if is_spatial and all(name in trial.signals for name in interfaces.ORIENTATION):
        orientation = _interpolate_orientation(trial, interval)
        return Posture(center, orientation, joint_angle, fin_angle, time)
    if is_spatial:
        tail_before = trial.link_angle[interval.before, 0]
        tail_after = trial.link_angle[interval.after, 0]
        tail = (1.0 - interval.share) * tail_before + interval.share * tail_after
    else:
        heading = float(interval.interpolate(trial.heading, trial.heading_rate)[0])
        tail = kinematics.link_angles(joint_angle, angle=heading)[0]
    posture = build_flat_posture(
        trial.robot,
        center=center,
        tail=tail,
        joint_angle=joint_angle,
        fin_angle=fin_angle,
        height=height,
    )
    return posture._replace(time=time)


def _find_interval(trial: Trial, time: float) -> Interval:
    """Return the samples around a time within a trial [s]."""
    n_samples = trial.time.size
    last_begin = max(n_samples - 2, 0)
    before = int(np.clip(np.searchsorted(trial.time, time, side="right") - 1, 0, last_begin))
    after = min(before + 1, n_samples - 1)
    duration = float(trial.time[after] - trial.time[before])
    share = 0.0
    if duration > 0.0:
        share = float(np.clip((time - trial.time[before]) / duration, 0.0, 1.0))
    return Interval(before, after, duration, share)


def _interpolate_orientation(trial: Trial, interval: Interval) -> Float[np.ndarray, "4"]:
    """Return the orientation between two samples, by the shorter way from one to the other."""
    before = _orientation_at(trial, interval.before)
    after = _orientation_at(trial, interval.after)
    if before @ after < 0.0:
        after = -after
    mean = (1.0 - interval.share) * before + interval.share * after
    return mean / np.linalg.norm(mean)


def _orientation_at(trial: Trial, sample: int) -> Float[np.ndarray, "4"]:
    return np.array([trial.signals[name][sample] for name in interfaces.ORIENTATION])
