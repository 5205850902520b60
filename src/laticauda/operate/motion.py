"""The motion model of the filter: what is estimated, how it moves on, and what a marker sees of it.

The center of mass and the heading are a smooth motion through moving water plus the gait's ripple, which repeats with
the gait. Joint angles are what was asked for, smoothed, plus a deviation. See docs/theory/estimation.md.
"""

import math
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float

from laticauda.errors import not_negative, positive
from laticauda.kinematics import link_angles, link_centers
from laticauda.operate.estimate import Mount
from laticauda.robot import Robot

Vector = Float[np.ndarray, " n"]
Matrix = Float[np.ndarray, "m n"]

# Places in the vector of what is estimated. U: surge, S: sway, V: current, h: smooth heading, r: its rate.
X, Y, U, S, VX, VY, H, R = range(8)
RIPPLE = 8
HARMONICS = (1, 2, 3)
# Each ripple is a turning pointer (c, s) per harmonic; what is seen of it is c.
HEADING, ALONG, ACROSS = range(3)
N_RIPPLE = 3 * len(HARMONICS)
JOINTS = RIPPLE + 2 * N_RIPPLE


def _ripple(kind: int, harmonic: int) -> int:
    return RIPPLE + 2 * (kind * len(HARMONICS) + harmonic)


SEEN = np.array([[_ripple(kind, k) for k in range(len(HARMONICS))] for kind in range(3)])


@dataclass(frozen=True, kw_only=True)
class Noise:
    """How much the sensors and the model are off: standard deviations, and how fast what is not known wanders.

    Raises:
        ValueError: If a field is out of its range.
    """

    position: float = 0.001
    """Of the marker body, per axis [m]."""
    yaw: float = math.radians(0.1)
    """Of the marker body [rad]."""
    joint: float = math.radians(0.25)
    """Of a joint's sensor, its backlash included [rad]."""
    joint_acceleration: float = 1.5
    """How fast a joint's rate strays from the reference's [rad/s^2/sqrt(Hz)]."""
    position_walk: float = 0.001
    """How fast the center of mass strays [m/sqrt(s)]."""
    surge: float = 0.02
    """How fast the speed through the water changes [m/s/sqrt(s)]."""
    sway: float = 0.03
    """Of the sideways speed through the water, which fades within `sway_time` [m/s]."""
    sway_time: float = 2.0
    """[s]."""
    current: float = 0.1
    """Of the water's velocity, per axis, before anything was seen [m/s]."""
    current_walk: float = 0.001
    """How fast it changes [m/s/sqrt(s)]."""
    turning: float = 0.03
    """How fast the smooth heading's rate changes [rad/s/sqrt(s)]."""
    heading_ripple: float = 0.03
    """How fast the heading's ripple changes; its harmonic k by 1/k of it [rad/sqrt(s)]."""
    position_ripple: float = 0.003
    """The same for the center of mass [m/sqrt(s)]."""

    def __post_init__(self) -> None:
        """Check every field once."""
        for name in ("position", "yaw", "joint", "joint_acceleration", "sway_time", "current"):
            object.__setattr__(self, name, positive(name, getattr(self, name)))
        for name in ("position_walk", "surge", "sway", "current_walk", "turning", "heading_ripple", "position_ripple"):
            object.__setattr__(self, name, not_negative(name, getattr(self, name)))


@dataclass(frozen=True, kw_only=True, eq=False)
class MotionModel:
    """The model for one robot with one marker body; holds what never changes."""

    robot: Robot
    """Its planar reduction counts."""
    mount: Mount = field(default_factory=Mount)
    """Where the marker body sits."""
    noise: Noise = field(default_factory=Noise)
    """What is not known."""
    swim_speed: float | None = None
    """The robot's speed through the water under its gait, if it is known: then a current along the course can be told
    from the robot's own speed. None: only turning tells the two apart [m/s]."""
    swim_speed_std: float = 0.01
    """How well it is known [m/s]."""
    ripple_memory: float = 100.0
    """Time in which a ripple that nobody sees fades [s]."""
    reference_bandwidth: float = 25.0
    """Of the second-order filter that stands for the joints' lag [rad/s]."""

    def __post_init__(self) -> None:
        """Check every field once, and work out the levers."""
        chain = self.robot.planar()
        n = chain.n_links
        link, (along, across) = self.mount.on_link(self.robot)
        # One link along x and all others along y: what the place of a link's middle has in x is that one's lever.
        one_turned = 0.5 * math.pi * (1.0 - np.eye(n))
        lever = link_centers(chain, np.zeros((n, 2)), one_turned)[:, link, 0].astype(np.complex128)
        lever[link] += complex(along, across)
        spread = link_angles(np.eye(n - 1), angle=np.zeros(n - 1)).T if n > 1 else np.zeros((1, 0))
        for name, value in (("chain", chain), ("n_joints", n - 1), ("link", link), ("lever", lever)):
            object.__setattr__(self, name, value)
        object.__setattr__(self, "spread", spread)
        object.__setattr__(self, "size", JOINTS + 2 * (n - 1))

    chain: Robot = field(init=False)
    """The planar reduction."""
    n_joints: int = field(init=False)
    """Its joints [-]."""
    size: int = field(init=False)
    """Length of what is estimated [-]."""
    link: int = field(init=False)
    """Which link carries the markers [-]."""
    lever: np.ndarray = field(init=False)
    """Marker body minus center of mass = sum of these times exp(i theta), in complex numbers [m]."""
    spread: np.ndarray = field(init=False)
    """theta minus heading, per joint angle [-]."""

    def start(self, center_of_mass: Vector, heading: float, deviation: Vector, deviation_rate: Vector):
        """What is known after the first frame: mean and covariance.

        Args:
            center_of_mass: p [m].
            heading: [rad].
            deviation: Joint angles minus references [rad].
            deviation_rate: Their rates [rad/s].
        """
        from laticauda.operate.filtering import Gaussian

        mean = np.zeros(self.size)
        mean[[X, Y]], mean[H] = center_of_mass, heading
        mean[JOINTS::2], mean[JOINTS + 1 :: 2] = deviation, deviation_rate
        variance = np.zeros(self.size)
        noise = self.noise
        variance[[X, Y]] = 0.05**2
        variance[[U, S]] = 0.1**2, noise.sway**2
        variance[[VX, VY]] = noise.current**2
        variance[[H, R]] = 0.05**2, 0.1**2
        variance[JOINTS::2], variance[JOINTS + 1 :: 2] = (2.0 * noise.joint) ** 2, 0.5**2
        return Gaussian(mean=mean, covariance=np.diag(variance))

    def step(self, mean: Vector, frequency: float, dt: float) -> tuple[Vector, Matrix, Matrix]:
        """One step of time.

        Args:
            mean: What is estimated, before it.
            frequency: Of the gait, omega [rad/s].
            dt: [s].

        Returns:
            The mean after it, F and Q.
        """
        noise = self.noise
        f, q = np.eye(self.size), np.zeros((self.size, self.size))
        after = mean.copy()
        # Smooth motion, with the heading in the middle of the step.
        h = mean[H] + 0.5 * dt * mean[R]
        c, s = math.cos(h), math.sin(h)
        velocity = _body_velocity(mean, c, s)
        after[[X, Y]] += dt * velocity
        turned = dt * np.array([-s * mean[U] - c * mean[S], c * mean[U] - s * mean[S]])
        f[X, U], f[X, S], f[X, VX] = dt * c, -dt * s, dt
        f[Y, U], f[Y, S], f[Y, VY] = dt * s, dt * c, dt
        f[[X, Y], H], f[[X, Y], R] = turned, 0.5 * dt * turned
        after[H] += dt * mean[R]
        f[H, R] = dt
        fade = math.exp(-dt / noise.sway_time)
        after[S] *= fade
        f[S, S] = fade
        q[S, S] = noise.sway**2 * (1.0 - fade * fade)
        self._surge(after, f, q, frequency, dt)
        q[X, X] = q[Y, Y] = noise.position_walk**2 * dt
        q[VX, VX] = q[VY, VY] = noise.current_walk**2 * dt
        _wander(q, H, noise.turning**2, dt)
        self._ripples(after, f, q, frequency, dt)
        places = np.arange(JOINTS, self.size, 2)
        after[places] += dt * mean[places + 1]
        f[places, places + 1] = dt
        _wander(q, places, noise.joint_acceleration**2, dt)
        return after, f, q

    def _surge(self, after: Vector, f: Matrix, q: Matrix, frequency: float, dt: float) -> None:
        """Speed through the water: a random walk, or drawn to the known one within some cycles."""
        if self.swim_speed is None:
            q[U, U] = self.noise.surge**2 * dt
            return
        fade = math.exp(-dt / SPEED_UP)
        target = self.swim_speed if frequency > 0.0 else 0.0
        after[U] = target + fade * (after[U] - target)
        f[U, U] = fade
        q[U, U] = self.swim_speed_std**2 * (1.0 - fade * fade)

    def _ripples(self, after: Vector, f: Matrix, q: Matrix, frequency: float, dt: float) -> None:
        """Every pointer turns by the gait's phase; without a gait it fades at once."""
        moving = frequency > 0.0
        fade = math.exp(-dt / (self.ripple_memory if moving else STOPPED_MEMORY))
        for k, harmonic in enumerate(HARMONICS):
            angle = harmonic * frequency * dt
            turn = fade * np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
            for kind in range(3):
                at = _ripple(kind, k)
                after[at : at + 2] = turn @ after[at : at + 2]
                f[at : at + 2, at : at + 2] = turn
                walk = self.noise.heading_ripple if kind == HEADING else self.noise.position_ripple
                if moving:
                    q[at, at] = q[at + 1, at + 1] = (walk / harmonic) ** 2 * dt

    # ---- what is seen of it ----------------------------------------------------------------------------------------

    def pose(self, mean: Vector) -> tuple[Vector, float]:
        """Center of mass [m] and heading (6) [rad], ripple included."""
        c, s = math.cos(mean[H]), math.sin(mean[H])
        along, across = mean[SEEN[ALONG]].sum(), mean[SEEN[ACROSS]].sum()
        place = np.array([mean[X] + c * along - s * across, mean[Y] + s * along + c * across])
        return place, float(mean[H] + mean[SEEN[HEADING]].sum())

    def pose_sensitivity(self, mean: Vector) -> Matrix:
        """Derivative of center of mass and heading with respect to what is estimated, 3 rows."""
        c, s = math.cos(mean[H]), math.sin(mean[H])
        along, across = mean[SEEN[ALONG]].sum(), mean[SEEN[ACROSS]].sum()
        rows = np.zeros((3, self.size))
        rows[0, X] = rows[1, Y] = rows[2, H] = 1.0
        rows[0, SEEN[ALONG]], rows[0, SEEN[ACROSS]] = c, -s
        rows[1, SEEN[ALONG]], rows[1, SEEN[ACROSS]] = s, c
        rows[0, H], rows[1, H] = -s * along - c * across, c * along - s * across
        rows[2, SEEN[HEADING]] = 1.0
        return rows

    def rates(self, mean: Vector, frequency: float) -> tuple[Vector, float]:
        """Velocity of the center of mass [m/s] and heading rate [rad/s], ripple included."""
        c, s = math.cos(mean[H]), math.sin(mean[H])
        speed = -frequency * np.array(HARMONICS)
        along, across, turning = (float(speed @ mean[SEEN[kind] + 1]) for kind in (ALONG, ACROSS, HEADING))
        along -= mean[R] * mean[SEEN[ACROSS]].sum()
        across += mean[R] * mean[SEEN[ALONG]].sum()
        velocity = _body_velocity(mean, c, s) + np.array([c * along - s * across, s * along + c * across])
        return velocity, float(mean[R] + turning)

    def marker(self, mean: Vector, reference: Vector) -> tuple[Vector, Matrix]:
        """What motion capture should see: x, y [m] and yaw of the link [rad], and its derivative.

        Args:
            mean: What is estimated.
            reference: What joint angles deviate from [rad].
        """
        place, heading = self.pose(mean)
        joint = reference + mean[JOINTS::2]
        theta = heading + self.spread @ joint
        arm = self.lever * np.exp(1j * theta)
        seen = complex(place[0], place[1]) + arm.sum()
        per_link = 1j * arm
        pose = self.pose_sensitivity(mean)
        rows = pose.copy()
        rows[:2] += np.outer(_parts(per_link.sum()), pose[2])
        per_joint = per_link @ self.spread
        rows[0, JOINTS::2], rows[1, JOINTS::2] = per_joint.real, per_joint.imag
        rows[2, JOINTS::2] = self.spread[self.link]
        return np.array([seen.real, seen.imag, theta[self.link]]), rows


# Time in which the robot comes to its speed [s], and in which ripples fade once the gait stands still [s].
SPEED_UP = 4.0
STOPPED_MEMORY = 0.3


def _body_velocity(mean: Vector, c: float, s: float) -> Vector:
    surge, sway = mean[U], mean[S]
    return np.array([c * surge - s * sway + mean[VX], s * surge + c * sway + mean[VY]])


def _wander(q: Matrix, at: int | np.ndarray, density: float, dt: float) -> None:
    """A value whose rate is a random walk."""
    q[at, at] = density * dt**3 / 3.0
    q[at, at + 1] = q[at + 1, at] = density * dt**2 / 2.0
    q[at + 1, at + 1] = density * dt


def _parts(value: complex) -> Vector:
    return np.array([value.real, value.imag])
