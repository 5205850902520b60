"""Motion and measurement model of the filter: how the estimated vector moves, and what is measured.

The center of mass and the heading are a smooth motion through moving water plus the gait's ripple,
which repeats with the gait. Joint angles are their lagged references plus a deviation. What the
entries of the vector are says `laticauda.control.estimation.state_vector`; why they move so,
docs/theory/estimation.md.
"""

import math
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np

from laticauda.control.estimation.digital_twin import TwinState
from laticauda.control.estimation.filter_state import Gaussian, Matrix, Noise, Vector
from laticauda.control.estimation.samples import Mount
from laticauda.control.estimation.state_vector import (
    ACROSS,
    ACROSS_GAIN,
    ALONG,
    HEADING,
    HEADING_GAIN,
    IS_OF_KIND,
    JOINTS,
    N_MODES,
    RIPPLE_C,
    RIPPLE_C_OF_KIND,
    RIPPLE_HARMONIC,
    RIPPLE_KIND,
    RIPPLE_S,
    SLIP,
    TURN,
    VX,
    VY,
    H,
    R,
    S,
    U,
    X,
    Y,
)
from laticauda.robot import Posture, Robot, link_angles

SPEED_UP = 4.0
"""Time constant with which the robot reaches its speed [s]."""
STOPPED_MEMORY = 0.3
"""Time constant with which ripples decay once the gait has stopped [s]."""
TWIN_SURGE = 0.02
"""Error of the twin's speed [m/s]."""
TWIN_MEMORY = 10.0
"""How long this error lasts [s]."""
TWIN_OPENING = 0.1
"""Initial standard deviations of the gains with a twin, per those without one [-]."""

# Standard deviations of the first estimate.
FIRST_POSITION = 0.05
"""Of the position, per axis [m]."""
FIRST_SURGE = 0.1
"""Of the speed through the water, without a twin [m/s]."""
FIRST_HEADING = 0.05
"""Of the heading [rad]."""
FIRST_HEADING_RATE = 0.1
"""Of its rate [rad/s]."""
FIRST_TURN_GAIN = 0.5
"""Of the rate of turning per mean joint angle [1/s]."""
FIRST_SLIP_GAIN = 0.2
"""Of the sideways speed per mean joint angle [m/s]."""
FIRST_ACROSS_GAIN = 0.1
"""Of a bending mode's contribution to the position across [m]; to the heading: 1 [-]."""
FIRST_JOINT_RATE = 0.5
"""Of the deviation of a joint's rate [rad/s]."""


class ModelStep(NamedTuple):
    """Time step of the estimated vector."""

    mean: Vector
    """Mean after the step."""
    transition: Matrix
    """F, derivative of the step with respect to the vector before it."""
    noise: Matrix
    """Q, covariance of the process noise."""


class _Relaxation(NamedTuple):
    """Relaxation of the speed through the water to a known one."""

    target: float
    """Speed [m/s]."""
    std: float
    """Standard deviation around it [m/s]."""
    memory: float
    """Time constant [s]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class MotionModel:
    """Model of one robot with one marker body; holds everything that never changes."""

    robot: Robot
    """Robot; its planar reduction is used."""
    mount: Mount = field(default_factory=Mount)
    """Mount of the marker body."""
    noise: Noise = field(default_factory=Noise)
    """Errors of sensors and model."""
    swim_speed: float | None = None
    """Robot's speed through the water under its gait, if known [m/s].

    It allows a current along the course to be distinguished from the robot's own speed. None: only
    turning distinguishes the two.
    """
    swim_speed_std: float = 0.01
    """Standard deviation of `swim_speed` [m/s]."""
    has_twin: bool = False
    """Whether a twin predicts the motion.

    U, S and R are then the motion of the robot beyond the twin's, TURN is the fraction by which it
    turns faster than the twin, and all of them are small.
    """
    ripple_memory: float = 100.0
    """Time constant with which a ripple decays unless frames sustain it [s]."""
    reference_bandwidth: float = 25.0
    """Bandwidth of the second-order filter that models the joints' lag [rad/s]."""

    @cached_property
    def chain(self) -> Robot:
        """Planar reduction of the robot."""
        return self.robot.planar()

    @cached_property
    def n_joints(self) -> int:
        """Number of its joints [-]."""
        return self.chain.n_links - 1

    @cached_property
    def size(self) -> int:
        """Length of the estimated vector [-]."""
        return JOINTS + 2 * self.n_joints

    @cached_property
    def link(self) -> int:
        """Link that carries the markers [-]."""
        return self.mount.on_link(self.robot).link

    @cached_property
    def lever(self) -> np.ndarray:
        """Lever of each link: marker body minus center of mass = sum of lever exp(i theta) [m]."""
        n = self.chain.n_links
        link, (along, across) = self.mount.on_link(self.robot)
        # With one link along x and all others along y, the x component of a link's middle is the
        # lever of that one.
        one_along_x = 0.5 * math.pi * (1.0 - np.eye(n))
        posture = Posture(self.chain, np.zeros((n, 2)), one_along_x)
        lever = posture.link_centers[:, link, 0].astype(np.complex128)
        lever[link] += complex(along, across)
        return lever

    @cached_property
    def spread(self) -> np.ndarray:
        """theta minus heading, per joint angle [-]."""
        n = self.n_joints
        if n == 0:
            return np.zeros((1, 0))
        return link_angles(np.eye(n), angle=np.zeros(n)).T

    @cached_property
    def modes(self) -> np.ndarray:
        """Bending modes, per joint angle; the first is the mean [-]."""
        return _bending_modes(self.n_joints)

    def initial(
        self, center_of_mass: Vector, heading: float, deviation: Vector, deviation_rate: Vector
    ) -> Gaussian:
        """Return the mean and covariance after the first frame.

        Args:
            center_of_mass: p [m].
            heading: Heading [rad].
            deviation: Joint angles minus references [rad].
            deviation_rate: Rates of these deviations [rad/s].
        """
        mean = np.zeros(self.size)
        mean[[X, Y]] = center_of_mass
        mean[H] = heading
        mean[JOINTS::2] = deviation
        mean[JOINTS + 1 :: 2] = deviation_rate
        return Gaussian(mean=mean, covariance=np.diag(self._first_variance()))

    def reset_motion(self, posterior: Gaussian) -> Gaussian:
        """Keep pose, current and joints, and reset all that explains the motion.

        Args:
            posterior: Estimate under another model: the twin has just begun, or was abandoned.
        """
        entries = np.array([U, S, R, *range(TURN, JOINTS)])
        return posterior.reset_entries(entries, 0.0, self._first_variance()[entries])

    def _first_variance(self) -> Vector:
        """Return the variance of every entry after the first frame; the ripples' is 0."""
        noise = self.noise
        surge_std = FIRST_SURGE
        share = 1.0
        if self.has_twin:
            surge_std = TWIN_SURGE
            share = TWIN_OPENING
        variance = np.zeros(self.size)
        variance[[X, Y]] = FIRST_POSITION**2
        variance[U] = surge_std**2
        variance[S] = noise.sway**2
        variance[[VX, VY]] = noise.current**2
        variance[H] = FIRST_HEADING**2
        variance[R] = FIRST_HEADING_RATE**2
        variance[TURN] = (share * FIRST_TURN_GAIN) ** 2
        variance[SLIP] = (share * FIRST_SLIP_GAIN) ** 2
        variance[HEADING_GAIN] = share**2
        variance[ACROSS_GAIN] = (share * FIRST_ACROSS_GAIN) ** 2
        variance[JOINTS::2] = (2.0 * noise.joint) ** 2
        variance[JOINTS + 1 :: 2] = FIRST_JOINT_RATE**2
        return variance

    def step(
        self,
        mean: Vector,
        reference: Vector,
        frequency: float,
        dt: float,
        twin: TwinState | None = None,
    ) -> ModelStep:
        """Advance the mean by one time step.

        Args:
            mean: Mean of the estimated vector before the step.
            reference: References that the joint angles deviate from [rad].
            frequency: omega, frequency of the gait [rad/s].
            dt: Time step [s].
            twin: Twin after its own step; None without one.
        """
        after = mean.copy()
        f = np.eye(self.size)
        q = np.zeros((self.size, self.size))
        bend = float(self.modes[0] @ (reference + mean[JOINTS::2]))
        self._travel(mean, after, f, bend, dt, twin)
        self._wander(after, f, q, frequency, dt)
        self._rotate_ripples(after, f, q, frequency, dt)
        joints = np.arange(JOINTS, self.size, 2)
        after[joints] += dt * mean[joints + 1]
        f[joints, joints + 1] = dt
        _add_walk_of_rate(q, joints, self.noise.joint_acceleration**2, dt)
        return ModelStep(after, f, q)

    def _travel(
        self, mean: Vector, after: Vector, f: Matrix, bend: float, dt: float, twin: TwinState | None
    ) -> None:
        """Advance the smooth motion, with the heading in the middle of the step.

        `bend` is the mean joint angle. Without a twin, the robot turns by TURN per mean joint
        angle; with one, as the twin does and by TURN of that more.
        """
        twin_turn = 0.0
        turned_by = bend
        if twin is not None:
            twin_turn = twin.turn
            turned_by = twin_turn / dt
        turning = mean[R] + mean[TURN] * turned_by
        h = mean[H] + 0.5 * (dt * turning + twin_turn)
        c = math.cos(h)
        s = math.sin(h)
        after[[X, Y]] += dt * _velocity_through_water(mean, bend, c, s) + dt * mean[[VX, VY]]
        after[H] += twin_turn + dt * turning
        f[H, R] = dt
        f[H, TURN] = dt * turned_by
        # Change of the displacement per change of the heading in the middle of the step.
        across = mean[S] + mean[SLIP] * bend
        per_heading = dt * _to_world(-across, mean[U], c, s)
        per_bend = dt * self.modes[0]
        if twin is None:
            f[H, JOINTS::2] = mean[TURN] * per_bend
        else:
            # The twin's displacement is along its first heading, not that in the middle.
            h0 = mean[H] + 0.5 * dt * turning
            way = _to_world(twin.along, twin.across, math.cos(h0), math.sin(h0))
            after[[X, Y]] += way
            per_heading += np.array([-way[1], way[0]])
        f[[X, Y], H] = per_heading
        f[[X, Y], R] = 0.5 * dt * per_heading
        f[[X, Y], TURN] = 0.5 * dt * turned_by * per_heading
        f[X, U] = dt * c
        f[Y, U] = dt * s
        f[X, S] = -dt * s
        f[Y, S] = dt * c
        f[X, SLIP] = -dt * s * bend
        f[Y, SLIP] = dt * c * bend
        f[X, VX] = dt
        f[Y, VY] = dt
        f[X, JOINTS::2] = -s * mean[SLIP] * per_bend
        f[Y, JOINTS::2] = c * mean[SLIP] * per_bend

    def _wander(self, after: Vector, f: Matrix, q: Matrix, frequency: float, dt: float) -> None:
        """Advance the speeds, and add the process noise of the smooth motion and of the gains."""
        noise = self.noise
        fade = math.exp(-dt / noise.sway_time)
        after[S] *= fade
        f[S, S] = fade
        q[S, S] = noise.sway**2 * (1.0 - fade * fade)
        self._relax_surge(after, f, q, frequency, dt)
        position_variance = noise.position_walk**2 * dt
        q[X, X] = position_variance
        q[Y, Y] = position_variance
        current_variance = noise.current_walk**2 * dt
        q[VX, VX] = current_variance
        q[VY, VY] = current_variance
        _add_walk_of_rate(q, H, noise.turning**2, dt)
        q[TURN, TURN] = noise.turn_gain**2 * dt
        q[SLIP, SLIP] = noise.slip_gain**2 * dt
        identity = np.eye(N_MODES)
        q[HEADING_GAIN, HEADING_GAIN] = noise.heading_gain**2 * dt * identity
        q[ACROSS_GAIN, ACROSS_GAIN] = noise.across_gain**2 * dt * identity

    def _relax_surge(
        self, after: Vector, f: Matrix, q: Matrix, frequency: float, dt: float
    ) -> None:
        """Advance the speed through the water: it relaxes to a known one, or wanders freely."""
        relaxation = self._relaxation(frequency)
        if relaxation is None:
            q[U, U] = self.noise.surge**2 * dt
            return
        target = relaxation.target
        fade = math.exp(-dt / relaxation.memory)
        after[U] = target + fade * (after[U] - target)
        f[U, U] = fade
        q[U, U] = relaxation.std**2 * (1.0 - fade * fade)

    def _relaxation(self, frequency: float) -> _Relaxation | None:
        """Return to what the speed relaxes; None if nothing is known of it."""
        if self.has_twin:
            return _Relaxation(target=0.0, std=TWIN_SURGE, memory=TWIN_MEMORY)
        if self.swim_speed is None:
            return None
        target = 0.0
        if frequency > 0.0:
            target = self.swim_speed
        return _Relaxation(target=target, std=self.swim_speed_std, memory=SPEED_UP)

    def _rotate_ripples(
        self, after: Vector, f: Matrix, q: Matrix, frequency: float, dt: float
    ) -> None:
        """Rotate every phasor by the gait's phase; without a gait, it decays at once."""
        is_moving = frequency > 0.0
        memory = STOPPED_MEMORY
        if is_moving:
            memory = self.ripple_memory
        fade = math.exp(-dt / memory)
        angle = RIPPLE_HARMONIC * frequency * dt
        c = fade * np.cos(angle)
        s = fade * np.sin(angle)
        first, second = after[RIPPLE_C], after[RIPPLE_S]
        after[RIPPLE_C] = c * first - s * second
        after[RIPPLE_S] = s * first + c * second
        f[RIPPLE_C, RIPPLE_C] = c
        f[RIPPLE_S, RIPPLE_S] = c
        f[RIPPLE_C, RIPPLE_S] = -s
        f[RIPPLE_S, RIPPLE_C] = s
        if is_moving:
            noise = self.noise
            of_heading = RIPPLE_KIND == HEADING
            walk = np.where(of_heading, noise.heading_ripple, noise.position_ripple)
            variance = (walk / RIPPLE_HARMONIC) ** 2 * dt
            q[RIPPLE_C, RIPPLE_C] = variance
            q[RIPPLE_S, RIPPLE_S] = variance

    # ---- the measurement model -------------------------------------------------------------------

    def pose(self, mean: Vector, reference: Vector) -> tuple[Vector, float, Matrix]:
        """Return center of mass [m] and heading (6) [rad], ripple included, and their derivative.

        Args:
            mean: Mean of the estimated vector.
            reference: References that the joint angles deviate from [rad].
        """
        bending = self.modes @ (reference + mean[JOINTS::2])
        c = math.cos(mean[H])
        s = math.sin(mean[H])
        along_entries = RIPPLE_C_OF_KIND[ALONG]
        across_entries = RIPPLE_C_OF_KIND[ACROSS]
        heading_entries = RIPPLE_C_OF_KIND[HEADING]
        along = mean[along_entries].sum()
        across = mean[across_entries].sum() + mean[ACROSS_GAIN] @ bending
        heading = mean[H] + mean[heading_entries].sum() + mean[HEADING_GAIN] @ bending
        rows = np.zeros((3, self.size))
        rows[0, X] = 1.0
        rows[1, Y] = 1.0
        rows[2, H] = 1.0
        rows[0, H] = -s * along - c * across
        rows[1, H] = c * along - s * across
        rows[0, along_entries] = c
        rows[1, along_entries] = s
        rows[2, heading_entries] = 1.0
        rows[2, HEADING_GAIN] = bending
        rows[2, JOINTS::2] = mean[HEADING_GAIN] @ self.modes
        across_row = np.zeros(self.size)
        across_row[across_entries] = 1.0
        across_row[ACROSS_GAIN] = bending
        across_row[JOINTS::2] = mean[ACROSS_GAIN] @ self.modes
        rows[0] -= s * across_row
        rows[1] += c * across_row
        center_of_mass = mean[[X, Y]] + _to_world(along, across, c, s)
        return center_of_mass, float(heading), rows

    def rates(
        self,
        mean: Vector,
        reference: Vector,
        reference_rate: Vector,
        frequency: float,
        twin: TwinState | None = None,
    ) -> tuple[Vector, float]:
        """Return velocity of the center of mass [m/s] and heading rate [rad/s], ripple included.

        Args:
            mean: Mean of the estimated vector.
            reference: References that the joint angles deviate from [rad].
            reference_rate: Rates of the references [rad/s].
            frequency: omega, frequency of the gait [rad/s].
            twin: Current twin; None without one.
        """
        bending = self.modes @ (reference + mean[JOINTS::2])
        bending_rate = self.modes @ (reference_rate + mean[JOINTS + 1 :: 2])
        c = math.cos(mean[H])
        s = math.sin(mean[H])
        ripple = IS_OF_KIND @ mean[RIPPLE_C]
        ripple_rate = IS_OF_KIND @ (-frequency * RIPPLE_HARMONIC * mean[RIPPLE_S])
        ripple[ACROSS] += mean[ACROSS_GAIN] @ bending
        ripple_rate[ACROSS] += mean[ACROSS_GAIN] @ bending_rate
        twin_rate = 0.0
        turned_by = bending[0]
        if twin is not None:
            twin_rate = twin.rate
            turned_by = twin_rate
        turning = float(mean[R] + mean[TURN] * turned_by) + twin_rate
        along = ripple_rate[ALONG] - turning * ripple[ACROSS]
        across = ripple_rate[ACROSS] + turning * ripple[ALONG]
        velocity = _velocity_through_water(mean, float(bending[0]), c, s) + mean[[VX, VY]]
        velocity += _to_world(along, across, c, s)
        if twin is not None:
            u, v = twin.velocity.tolist()
            ahead_of_twin = mean[H] - twin.heading
            velocity += _to_world(u, v, math.cos(ahead_of_twin), math.sin(ahead_of_twin))
        heading_rate = turning + ripple_rate[HEADING] + mean[HEADING_GAIN] @ bending_rate
        return velocity, float(heading_rate)

    def marker(self, mean: Vector, reference: Vector) -> tuple[Vector, Matrix]:
        """Return the expected measurement, x, y [m] and yaw of the link [rad], and its derivative.

        Args:
            mean: Mean of the estimated vector.
            reference: References that the joint angles deviate from [rad].
        """
        center_of_mass, heading, rows = self.pose(mean, reference)
        theta = heading + self.spread @ (reference + mean[JOINTS::2])
        arms = self.lever * np.exp(1j * theta)
        marker = complex(center_of_mass[0], center_of_mass[1]) + arms.sum()
        per_link = 1j * arms
        per_heading = per_link.sum()
        rows[0] += per_heading.real * rows[2]
        rows[1] += per_heading.imag * rows[2]
        per_joint = per_link @ self.spread
        rows[0, JOINTS::2] += per_joint.real
        rows[1, JOINTS::2] += per_joint.imag
        rows[2, JOINTS::2] += self.spread[self.link]
        return np.array([marker.real, marker.imag, theta[self.link]]), rows


def _velocity_through_water(mean: Vector, bend: float, c: float, s: float) -> Vector:
    """Return the velocity of the smooth motion through the water, world axes [m/s]."""
    return _to_world(mean[U], mean[S] + mean[SLIP] * bend, c, s)


def _to_world(along: float, across: float, c: float, s: float) -> Vector:
    """Convert a vector along a heading and to its left to world axes; c, s: its cos and sin."""
    return np.array([c * along - s * across, s * along + c * across])


def _add_walk_of_rate(q: Matrix, entry: int | np.ndarray, density: float, dt: float) -> None:
    """Set the process noise of entries whose rates, the next entries, are random walks."""
    q[entry, entry] = density * dt**3 / 3.0
    covariance = density * dt**2 / 2.0
    q[entry, entry + 1] = covariance
    q[entry + 1, entry] = covariance
    q[entry + 1, entry + 1] = density * dt


def _bending_modes(n_joints: int) -> Matrix:
    """Return rows that map joint angles to modes.

    These are their mean, and cosines of 1, 2 and 3 half waves along the body.
    """
    n = max(n_joints, 1)
    position = (np.arange(n_joints) + 0.5) / n
    cosines = [np.cos(math.pi * k * position) for k in range(N_MODES)]
    return np.array(cosines) / n
