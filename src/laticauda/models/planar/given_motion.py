"""Loads of a given motion: what water and joints would have to do, and how the body would accelerate.

A run computes a motion from loads. Here the motion is known, from a film for instance: position, heading,
joint angles and their rates at every moment. The kernels give the loads of that moment, the joint torques
and the acceleration of the free root that follows from them. What the root really did, less that, times
its inertia is the force that the model does not explain.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from laticauda.models.planar import rows
from laticauda.models.planar.layout import Layout
from laticauda.models.planar.model import PlanarPlant
from laticauda.models.planar.sample_format import column_of, columns_of_joints
from laticauda.motion.gaits import JointAngles, recorded_gait
from laticauda.robot import link_angles
from laticauda.scenarios import Command, Start
from laticauda.values import BadArgument

LAST_KNOT = 1e-3
"""Time by which the last knot of a recording lies beyond the motion [s]."""
Vectors = Float[np.ndarray, "n_times 2"]
JointSeries = Float[np.ndarray, "n_times n_joints"]


@dataclass(frozen=True, kw_only=True, eq=False)
class GivenMotion:
    """A motion in the plane at increasing times, world axes, joints tail first."""

    time: Float[np.ndarray, " n_times"]
    """Times [s]."""
    center_of_mass: Vectors
    """Position of the center of mass [m]."""
    velocity: Vectors
    """Its velocity [m/s]."""
    heading: Float[np.ndarray, " n_times"]
    """Mean angle of the links [rad]."""
    heading_rate: Float[np.ndarray, " n_times"]
    """Its rate [rad/s]."""
    joint_angle: JointSeries
    """Joint angles [rad]."""
    joint_rate: JointSeries
    """Their rates [rad/s]."""
    joint_acceleration: JointSeries
    """Their accelerations [rad/s^2]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class MotionLoads:
    """What a model says of a given motion."""

    link_force: Float[np.ndarray, "n_times n_links 2"]
    """Force of the water on every link, with what is mounted on it, world axes [N]."""
    joint_torque: JointSeries
    """Torque of every joint's actuator [N m]."""
    acceleration: Vectors
    """Acceleration of the center of mass that follows [m/s^2]."""
    heading_acceleration: Float[np.ndarray, " n_times"]
    """Acceleration of the heading that follows [rad/s^2]."""
    root_inertia: Float[np.ndarray, "n_times 3 3"]
    """Inertia of the stiff body with its added mass about the center of mass: rotation, x, y."""

    def left_over(
        self,
        acceleration: Vectors,
        heading_acceleration: Float[np.ndarray, " n_times"],
    ) -> Float[np.ndarray, "n_times 3"]:
        """Return moment [N m] and force [N] that the model does not explain.

        Args:
            acceleration: What the center of mass really did [m/s^2].
            heading_acceleration: What the heading really did [rad/s^2].
        """
        turning = heading_acceleration - self.heading_acceleration
        difference = np.column_stack((turning, acceleration - self.acceleration))
        return np.einsum("tij,tj->ti", self.root_inertia, difference)


def evaluate_motion(plant: PlanarPlant, motion: GivenMotion) -> MotionLoads:
    """Return the loads of a given motion.

    Args:
        plant: Robot and environment; its joints are prescribed, and its fin, if any, is rigid.
        motion: The motion.

    Raises:
        ValueError: If the plant's joints are driven, or its fin bends.
    """
    if not plant.joints.prescribed:
        raise BadArgument("plant.joints", "must be prescribed for a motion that is given")
    layout = plant.layout
    if layout.tail_link > 0:
        raise BadArgument("robot", "must have no fin that bends: no point of the film shows it")
    n_joints = layout.n_joints
    samples = np.zeros((motion.time.size, layout.sample_size))
    columns = {
        rows.TIME: motion.time - motion.time[0],
        rows.HEADING: motion.heading,
        rows.X: motion.center_of_mass[:, 0],
        rows.Y: motion.center_of_mass[:, 1],
        rows.HEADING_RATE: motion.heading_rate,
        rows.VX: motion.velocity[:, 0],
        rows.VY: motion.velocity[:, 1],
    }
    for row, values in columns.items():
        samples[:, column_of(row)] = values
    samples[:, columns_of_joints(rows.ANGLE, n_joints)] = motion.joint_angle
    samples[:, columns_of_joints(rows.RATE, n_joints)] = motion.joint_rate
    samples[:, column_of(rows.EDGE_MEMORY)] = _edge_memory(plant, samples, motion)
    root = _evaluate_root(plant, samples, motion)
    stiffness = np.array([joint.stiffness for joint in plant.robot.joints])
    damping = np.array([joint.damping for joint in plant.robot.joints])
    skin = stiffness * motion.joint_angle + damping * motion.joint_rate
    return MotionLoads(
        link_force=_link_forces(plant, samples, motion),
        joint_torque=root[:, 3:] + skin,
        acceleration=root[:, 1:3],
        heading_acceleration=root[:, 0],
        root_inertia=_root_inertia(plant, motion),
    )


class _Moments:
    """The moments of a motion, of which the kernels compute the rows one by one."""

    def __init__(self, plant: PlanarPlant, samples: np.ndarray, motion: GivenMotion) -> None:
        layout = plant.layout
        self.layout = layout
        self.samples = samples
        self.motion = motion
        self.joints = rows.HEADER_ROWS + rows.BODY_ROWS * np.arange(1, layout.n_bodies)
        self.rows = _rows_with_knots(plant, np.zeros((2, 1 + 2 * layout.n_joints)))
        self._evaluate = plant.kernels_of(1).evaluate
        is_free = np.zeros(layout.n_bodies, dtype=bool)
        strips_and_plates = (layout.first_strip, layout.first_plate)
        self._shape = (*strips_and_plates, is_free, layout.tail_link, layout.has_extras)

    def evaluate(self, moment: int, edge_memory: float) -> None:
        """Compute the rows at a moment, with a state of the trailing edge [m/s]."""
        S = self.rows
        S[self.layout.state_rows] = self.samples[moment, : self.layout.state_size]
        S[rows.EDGE_MEMORY] = edge_memory
        S[self.joints + rows.REFERENCE_2] = self.motion.joint_acceleration[moment]
        self._evaluate(S, self.layout.n_bodies, *self._shape)

    def edge_rate(self, moment: int, edge_memory: float) -> float:
        """Return the rate of the state of the trailing edge at a moment [m/s^2]."""
        self.evaluate(moment, edge_memory)
        return float(self.rows[rows.EDGE_MEMORY_RATE])


def _edge_memory(
    plant: PlanarPlant, samples: Float[np.ndarray, "n_times n_numbers"], motion: GivenMotion
) -> Float[np.ndarray, " n_times"]:
    """Return the state of a trailing edge of finite span, integrated by Heun; 0 without one [m/s].

    Nothing is known of the time before the motion: it begins with the state that would stay.
    """
    memory = np.zeros(motion.time.size)
    if plant.layout.template[rows.EDGE_LAG] == 0.0:
        return memory
    moments = _Moments(plant, samples, motion)
    growth = moments.edge_rate(0, 0.0)
    decay = growth - moments.edge_rate(0, 1.0)
    if decay > 0.0:
        memory[0] = growth / decay
    for i, step in enumerate(np.diff(motion.time)):
        rate = moments.edge_rate(i, memory[i])
        rate_after = moments.edge_rate(i + 1, memory[i] + step * rate)
        memory[i + 1] = memory[i] + 0.5 * step * (rate + rate_after)
    return memory


def _evaluate_root(
    plant: PlanarPlant, samples: Float[np.ndarray, "n_times n_numbers"], motion: GivenMotion
) -> Float[np.ndarray, "n_times n_results"]:
    """Return the accelerations of heading and center of mass, then the torque in every joint."""
    moments = _Moments(plant, samples, motion)
    read = np.concatenate(
        ([rows.HEADING_ACCELERATION, rows.AX, rows.AY], moments.joints + rows.TOTAL_TORQUE)
    )
    results = np.empty((len(samples), read.size))
    for i, edge_memory in enumerate(samples[:, column_of(rows.EDGE_MEMORY)]):
        moments.evaluate(i, edge_memory)
        results[i] = moments.rows[read]
    return results


def _link_forces(
    plant: PlanarPlant, samples: Float[np.ndarray, "n_times n_numbers"], motion: GivenMotion
) -> Float[np.ndarray, "n_times n_links 2"]:
    """Return the force of the water on every link, with effectors [N]."""
    layout = plant.layout
    force = np.empty((len(samples), 3, layout.n_bodies, 2, 1))
    # The rates of the recording are those of the motion, not those of a spline that begins at rest.
    rate, acceleration = motion.joint_rate[-1], motion.joint_acceleration[-1]
    angle = motion.joint_angle[-1]
    next_rate = rate + LAST_KNOT * acceleration
    next_angle = angle + 0.5 * LAST_KNOT * (rate + next_rate)
    beyond = np.column_stack((next_angle, next_rate))
    table = np.stack((motion.joint_angle, motion.joint_rate), axis=2).reshape(len(samples), -1)
    knots = np.column_stack((_knot_times(motion), np.vstack((table, beyond.ravel()))))
    S = _rows_with_knots(plant, knots)
    plant.kernels_of(1).link_forces(S, *layout.chain, samples[:, :, np.newaxis], force)
    return force[..., 0].sum(axis=1)


def _rows_with_knots(
    plant: PlanarPlant, knots: Float[np.ndarray, "n_knots n_numbers"]
) -> Float[np.ndarray, " n_rows"]:
    """Return all rows of a plant at rest whose joints follow the knots of a recording."""
    still = JointAngles(time=(0.0, 1.0), angle=((0.0, 0.0),) * plant.layout.n_joints)
    command = Command(gait=recorded_gait(still))
    S = plant.rows(plant.init(Start(), command), command)
    S[rows.N_KNOTS] = len(knots)
    return np.concatenate((S[: int(S[rows.KNOTS])], knots.ravel()))


def _knot_times(motion: GivenMotion) -> Float[np.ndarray, " n_knots"]:
    time = motion.time - motion.time[0]
    return np.append(time, time[-1] + LAST_KNOT)


def _root_inertia(plant: PlanarPlant, motion: GivenMotion) -> Float[np.ndarray, "n_times 3 3"]:
    """Return the inertia of the body, its joints locked, about its center of mass: rotation, x, y."""
    bodies = _records(plant.layout)
    angle = link_angles(motion.joint_angle, angle=motion.heading)
    c, s = np.cos(angle), np.sin(angle)
    lengths = bodies[:, rows.LENGTH]
    # Tail ends from that of body 0, then from the center of mass.
    x = np.cumsum(lengths * c, axis=1) - lengths * c
    y = np.cumsum(lengths * s, axis=1) - lengths * s
    share, arm = bodies[:, rows.MASS_SHARE], bodies[:, rows.FIRST_MOMENT_SHARE]
    x -= np.sum(share * x + arm * c, axis=1)[:, np.newaxis]
    y -= np.sum(share * y + arm * s, axis=1)[:, np.newaxis]
    along, across = bodies[:, rows.MASS_T], bodies[:, rows.MASS_N]
    own_xx = along * c**2 + across * s**2
    own_yy = along * s**2 + across * c**2
    own_xy = (along - across) * s * c
    own_x, own_y = -s * bodies[:, rows.COUPLING], c * bodies[:, rows.COUPLING]
    by_x = own_x - own_xx * y + own_xy * x
    by_y = own_y - own_xy * y + own_yy * x
    turning = bodies[:, rows.INERTIA] - own_x * y + own_y * x - y * by_x + x * by_y
    sums = [np.sum(part, axis=1) for part in (turning, by_x, by_y, own_xx, own_xy, own_yy)]
    t, tx, ty, xx, xy, yy = sums
    return np.moveaxis(np.array([[t, tx, ty], [tx, xx, xy], [ty, xy, yy]]), 2, 0)


def _records(layout: Layout) -> Float[np.ndarray, "n_bodies n_rows"]:
    """Return the records of all bodies, one per row."""
    end = rows.HEADER_ROWS + layout.n_bodies * rows.BODY_ROWS
    return layout.template[rows.HEADER_ROWS : end].reshape(-1, rows.BODY_ROWS)
