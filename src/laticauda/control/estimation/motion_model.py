"""Motion and measurement model of the filter: the estimated quantities, their motion, and the resulting marker pose.

The center of mass and the heading are a smooth motion through moving water plus the gait's ripple,
which repeats with the gait. Joint angles are their lagged references plus a deviation. See
docs/theory/estimation.md.
"""

import math
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from laticauda.control.estimation.digital_twin import TwinState
from laticauda.control.estimation.filter_state import Gaussian, Matrix, Noise, Vector
from laticauda.control.estimation.samples import Mount
from laticauda.robot import Posture, Robot, link_angles

# Indices in the estimated vector. U: surge, S: sway, V: current, h: smooth heading, r: its rate;
# then the rate of turning and the sideways speed per mean joint angle.
X, Y, U, S, VX, VY, H, R, TURN, SLIP = range(10)
# Contributions of one bending mode of the body to the heading, and to the position of the center of
# mass across it.
N_MODES = 4
HEADING_GAIN = slice(10, 10 + N_MODES)
ACROSS_GAIN = slice(10 + N_MODES, 10 + 2 * N_MODES)
# Motion that repeats with the gait is a rotating phasor (c, s) per harmonic; its contribution to
# the motion is c.
HEADING, ALONG, ACROSS = range(3)
RIPPLES = ((HEADING, 1), (HEADING, 3), (ALONG, 1), (ALONG, 2), (ACROSS, 1), (ACROSS, 2))
RIPPLE = 10 + 2 * N_MODES
JOINTS = RIPPLE + 2 * len(RIPPLES)
_KIND, _HARMONIC = np.array(RIPPLES).T
_C = np.arange(RIPPLE, JOINTS, 2)
_OF = np.arange(3)[:, np.newaxis] == _KIND
_POINTER = [_C[one] for one in _OF]


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
    """Robot's speed through the water under its gait, if known; it allows a current along the course to be
    distinguished from the robot's own speed. None: only turning distinguishes the two [m/s]."""
    swim_speed_std: float = 0.01
    """Standard deviation of `swim_speed` [m/s]."""
    has_twin: bool = False
    """Whether a twin predicts the motion: U, S and R are then the motion of the robot beyond the twin's, TURN is the
    fraction by which it turns faster than the twin, and all of them are small."""
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
        return self.mount.on_link(self.robot)[0]

    @cached_property
    def lever(self) -> np.ndarray:
        """Lever of each link: marker body minus center of mass = sum of lever exp(i theta), in complex numbers [m]."""
        n, (link, (along, across)) = self.chain.n_links, self.mount.on_link(self.robot)
        # With one link along x and all others along y, the x component of a link's middle is the
        # lever of that one.
        one_turned = 0.5 * math.pi * (1.0 - np.eye(n))
        lever = (
            Posture(self.chain, np.zeros((n, 2)), one_turned)
            .link_centers[:, link, 0]
            .astype(np.complex128)
        )
        lever[link] += complex(along, across)
        return lever

    @cached_property
    def spread(self) -> np.ndarray:
        """theta minus heading, per joint angle [-]."""
        n = self.n_joints
        return link_angles(np.eye(n), angle=np.zeros(n)).T if n else np.zeros((1, 0))

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
        mean[[X, Y]], mean[H] = center_of_mass, heading
        mean[JOINTS::2], mean[JOINTS + 1 :: 2] = deviation, deviation_rate
        return Gaussian(mean=mean, covariance=np.diag(self._first_variance()))

    def reopened(self, posterior: Gaussian) -> Gaussian:
        """Keep pose, current and joints, and reset all that explains the motion: for a change of models.

        Args:
            posterior: Estimate under the other model.
        """
        at = np.array([U, S, R, *range(TURN, JOINTS)])
        return posterior.restarted(at, 0.0, self._first_variance()[at])

    def _first_variance(self) -> Vector:
        variance = np.zeros(self.size)
        noise, share = self.noise, TWIN_OPENING if self.has_twin else 1.0
        variance[[X, Y]] = 0.05**2
        variance[[U, S]] = TWIN_SURGE**2 if self.has_twin else 0.1**2, noise.sway**2
        variance[[VX, VY]] = noise.current**2
        variance[[H, R]] = 0.05**2, 0.1**2
        variance[[TURN, SLIP]] = (share * 0.5) ** 2, (share * 0.2) ** 2
        variance[HEADING_GAIN], variance[ACROSS_GAIN] = share**2, (share * 0.1) ** 2
        variance[JOINTS::2], variance[JOINTS + 1 :: 2] = (2.0 * noise.joint) ** 2, 0.5**2
        return variance

    def step(
        self,
        mean: Vector,
        reference: Vector,
        frequency: float,
        dt: float,
        twin: TwinState | None = None,
    ) -> tuple[Vector, Matrix, Matrix]:
        """Advance the mean by one time step.

        Args:
            mean: Mean of the estimated vector before the step.
            reference: References that the joint angles deviate from [rad].
            frequency: omega, frequency of the gait [rad/s].
            dt: Time step [s].
            twin: Twin after its own step; None without one.

        Returns:
            The mean after the step, F and Q.
        """
        f, q = np.eye(self.size), np.zeros((self.size, self.size))
        after = mean.copy()
        bend = float(self.modes[0] @ (reference + mean[JOINTS::2]))
        self._travel(mean, after, f, bend, dt, twin)
        self._wander(after, f, q, frequency, dt)
        self._ripples(after, f, q, frequency, dt)
        places = np.arange(JOINTS, self.size, 2)
        after[places] += dt * mean[places + 1]
        f[places, places + 1] = dt
        _walk_of_rate(q, places, self.noise.joint_acceleration**2, dt)
        return after, f, q

    def _travel(
        self, mean: Vector, after: Vector, f: Matrix, bend: float, dt: float, twin: TwinState | None
    ) -> None:
        """Advance the smooth motion, with the heading in the middle of the step; `bend` is the mean joint angle."""
        foreseen = 0.0 if twin is None else twin.turn
        lever = bend if twin is None else foreseen / dt
        turning = mean[R] + mean[TURN] * lever
        h = mean[H] + 0.5 * (dt * turning + foreseen)
        c, s = math.cos(h), math.sin(h)
        after[[X, Y]] += dt * _through_water(mean, bend, c, s) + dt * mean[[VX, VY]]
        after[H] += foreseen + dt * turning
        f[H, R], f[H, TURN] = dt, dt * lever
        per_bend = dt * self.modes[0]
        across = mean[S] + mean[SLIP] * bend
        turned = dt * _in_world(-across, mean[U], c, s)
        if twin is None:
            f[H, JOINTS::2] = mean[TURN] * per_bend
        else:
            h0 = mean[H] + 0.5 * dt * turning
            way = _in_world(twin.along, twin.across, math.cos(h0), math.sin(h0))
            after[[X, Y]] += way
            turned += np.array([-way[1], way[0]])
        f[[X, Y], H], f[[X, Y], R], f[[X, Y], TURN] = (
            turned,
            0.5 * dt * turned,
            0.5 * dt * lever * turned,
        )
        f[X, U], f[X, S], f[X, SLIP], f[X, VX] = dt * c, -dt * s, -dt * s * bend, dt
        f[Y, U], f[Y, S], f[Y, SLIP], f[Y, VY] = dt * s, dt * c, dt * c * bend, dt
        f[X, JOINTS::2], f[Y, JOINTS::2] = -s * mean[SLIP] * per_bend, c * mean[SLIP] * per_bend

    def _wander(self, after: Vector, f: Matrix, q: Matrix, frequency: float, dt: float) -> None:
        """Add the process noise of the smooth motion and of the gains."""
        noise = self.noise
        fade = math.exp(-dt / noise.sway_time)
        after[S] *= fade
        f[S, S] = fade
        q[S, S] = noise.sway**2 * (1.0 - fade * fade)
        self._surge(after, f, q, frequency, dt)
        q[X, X] = q[Y, Y] = noise.position_walk**2 * dt
        q[VX, VX] = q[VY, VY] = noise.current_walk**2 * dt
        _walk_of_rate(q, H, noise.turning**2, dt)
        q[TURN, TURN], q[SLIP, SLIP] = noise.turn_gain**2 * dt, noise.slip_gain**2 * dt
        for gains, walk in ((HEADING_GAIN, noise.heading_gain), (ACROSS_GAIN, noise.across_gain)):
            q[gains, gains] = walk**2 * dt * np.eye(N_MODES)

    def _surge(self, after: Vector, f: Matrix, q: Matrix, frequency: float, dt: float) -> None:
        """Advance the speed through the water: a random walk, or relaxation to the known or twin's in some cycles."""
        if self.has_twin:
            memory, std, target = TWIN_MEMORY, TWIN_SURGE, 0.0
        elif self.swim_speed is None:
            q[U, U] = self.noise.surge**2 * dt
            return
        else:
            memory, std, target = (
                SPEED_UP,
                self.swim_speed_std,
                self.swim_speed if frequency > 0.0 else 0.0,
            )
        fade = math.exp(-dt / memory)
        after[U] = target + fade * (after[U] - target)
        f[U, U] = fade
        q[U, U] = std**2 * (1.0 - fade * fade)

    def _ripples(self, after: Vector, f: Matrix, q: Matrix, frequency: float, dt: float) -> None:
        """Rotate every phasor by the gait's phase; without a gait, it decays at once."""
        moving = frequency > 0.0
        fade = math.exp(-dt / (self.ripple_memory if moving else STOPPED_MEMORY))
        angle, at = _HARMONIC * frequency * dt, _C + 1
        c, s = fade * np.cos(angle), fade * np.sin(angle)
        after[_C], after[at] = c * after[_C] - s * after[at], s * after[_C] + c * after[at]
        f[_C, _C] = f[at, at] = c
        f[_C, at], f[at, _C] = -s, s
        if moving:
            walk = np.where(_KIND == HEADING, self.noise.heading_ripple, self.noise.position_ripple)
            q[_C, _C] = q[at, at] = (walk / _HARMONIC) ** 2 * dt

    # ---- the measurement model -------------------------------------------------------------------

    def pose(self, mean: Vector, reference: Vector) -> tuple[Vector, float, Matrix]:
        """Return center of mass [m] and heading (6) [rad], ripple included, and the derivative of these three.

        Args:
            mean: Mean of the estimated vector.
            reference: References that the joint angles deviate from [rad].
        """
        bending = self.modes @ (reference + mean[JOINTS::2])
        c, s = math.cos(mean[H]), math.sin(mean[H])
        along = mean[_POINTER[ALONG]].sum()
        across = mean[_POINTER[ACROSS]].sum() + mean[ACROSS_GAIN] @ bending
        theta = mean[H] + mean[_POINTER[HEADING]].sum() + mean[HEADING_GAIN] @ bending
        rows = np.zeros((3, self.size))
        rows[0, X] = rows[1, Y] = rows[2, H] = 1.0
        rows[0, H], rows[1, H] = -s * along - c * across, c * along - s * across
        rows[0, _POINTER[ALONG]], rows[1, _POINTER[ALONG]] = c, s
        rows[2, _POINTER[HEADING]] = 1.0
        rows[2, HEADING_GAIN] = bending
        rows[2, JOINTS::2] = mean[HEADING_GAIN] @ self.modes
        sideways = np.zeros(self.size)
        sideways[_POINTER[ACROSS]], sideways[ACROSS_GAIN] = 1.0, bending
        sideways[JOINTS::2] = mean[ACROSS_GAIN] @ self.modes
        rows[0] -= s * sideways
        rows[1] += c * sideways
        place = mean[[X, Y]] + _in_world(along, across, c, s)
        return place, float(theta), rows

    def rates(
        self,
        mean: Vector,
        reference: Vector,
        reference_rate: Vector,
        frequency: float,
        twin: TwinState | None = None,
    ) -> tuple[Vector, float]:
        """Return the velocity of the center of mass [m/s] and the heading rate [rad/s], ripple included.

        Args:
            mean: Mean of the estimated vector.
            reference: References that the joint angles deviate from [rad].
            reference_rate: Rates of the references [rad/s].
            frequency: omega, frequency of the gait [rad/s].
            twin: Current twin; None without one.
        """
        bending = self.modes @ (reference + mean[JOINTS::2])
        bending_rate = self.modes @ (reference_rate + mean[JOINTS + 1 :: 2])
        c, s = math.cos(mean[H]), math.sin(mean[H])
        place, pace = (_OF @ part for part in (mean[_C], -frequency * _HARMONIC * mean[_C + 1]))
        place[ACROSS] += mean[ACROSS_GAIN] @ bending
        pace[ACROSS] += mean[ACROSS_GAIN] @ bending_rate
        foreseen = 0.0 if twin is None else twin.rate
        turning = (
            float(mean[R] + mean[TURN] * (bending[0] if twin is None else foreseen)) + foreseen
        )
        along = pace[ALONG] - turning * place[ACROSS]
        across = pace[ACROSS] + turning * place[ALONG]
        velocity = _through_water(mean, float(bending[0]), c, s) + mean[[VX, VY]]
        velocity += _in_world(along, across, c, s)
        if twin is not None:
            (u, v), ahead = twin.velocity.tolist(), mean[H] - twin.heading
            velocity += _in_world(u, v, math.cos(ahead), math.sin(ahead))
        return velocity, float(turning + pace[HEADING] + mean[HEADING_GAIN] @ bending_rate)

    def marker(self, mean: Vector, reference: Vector) -> tuple[Vector, Matrix]:
        """Return the expected motion-capture measurement, x, y [m] and yaw of the link [rad], and its derivative.

        Args:
            mean: Mean of the estimated vector.
            reference: References that the joint angles deviate from [rad].
        """
        place, heading, rows = self.pose(mean, reference)
        theta = heading + self.spread @ (reference + mean[JOINTS::2])
        arm = self.lever * np.exp(1j * theta)
        marker = complex(place[0], place[1]) + arm.sum()
        per_link = 1j * arm
        whole = per_link.sum()
        rows[0] += whole.real * rows[2]
        rows[1] += whole.imag * rows[2]
        per_joint = per_link @ self.spread
        rows[0, JOINTS::2] += per_joint.real
        rows[1, JOINTS::2] += per_joint.imag
        rows[2, JOINTS::2] += self.spread[self.link]
        return np.array([marker.real, marker.imag, theta[self.link]]), rows


# Time constants with which the robot reaches its speed [s], and with which ripples decay once the
# gait has stopped [s].
SPEED_UP = 4.0
STOPPED_MEMORY = 0.3
# Error of the twin's speed [m/s], and how long it lasts [s].
TWIN_SURGE = 0.02
TWIN_MEMORY = 10.0
# Initial standard deviations of the gains with a twin, as a fraction of those without one [-].
TWIN_OPENING = 0.1


def _through_water(mean: Vector, bend: float, c: float, s: float) -> Vector:
    """Return the velocity of the smooth motion through the water, world axes [m/s]."""
    return _in_world(mean[U], mean[S] + mean[SLIP] * bend, c, s)


def _in_world(along: float, across: float, c: float, s: float) -> Vector:
    """Convert a vector along a heading and to its left to world axes, given the heading's cosine and sine."""
    return np.array([c * along - s * across, s * along + c * across])


def _walk_of_rate(q: Matrix, at: int | np.ndarray, density: float, dt: float) -> None:
    """Set the process noise of a value whose rate is a random walk."""
    q[at, at] = density * dt**3 / 3.0
    q[at, at + 1] = q[at + 1, at] = density * dt**2 / 2.0
    q[at + 1, at + 1] = density * dt


def _bending_modes(n_joints: int) -> Matrix:
    """Return rows that map joint angles to modes: their mean, and cosines of 1, 2 and 3 half waves along the body."""
    place = (np.arange(n_joints) + 0.5) / max(n_joints, 1)
    return np.array([np.cos(math.pi * k * place) for k in range(N_MODES)]) / max(n_joints, 1)
