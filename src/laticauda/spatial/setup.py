"""What a plant in space is made of."""

from dataclasses import dataclass
from typing import Literal

from laticauda.actuation.laws import JointLaw, Prescribed
from laticauda.errors import BadArgument, finite, instance, not_negative, one_of, positive, within
from laticauda.robot import Environment, Ground, Robot, check_fits
from laticauda.scenarios import Spatial
from laticauda.spatial import mjcf

LEAST_DT = 1e-6  # s


@dataclass(frozen=True, kw_only=True, eq=False)
class SpatialSetup:
    """Robot, environment and settings, checked.

    Raises:
        ValueError: If a setting is out of its range, or robot and environment do not fit together.
    """

    robot: Robot
    """What swims, all of its modules."""
    environment: Environment
    """The water it swims in, or the ground: a free root lies on it with its weight, a planar one slides along."""
    joints: JointLaw = Prescribed()
    """How they follow their references."""
    dt: float | None = None
    """Largest time step; None takes a converged one [s]."""
    offset_bandwidth: float = 10.0
    """Of the filters in the reference generator [rad/s]."""
    ramp: float | None = None
    """T of the smooth start; None: 1 s for prescribed joints, none for the others [s]."""
    gravity: bool = True
    """Weight and buoyancy."""
    root: Literal["free", "planar"] = "free"
    """`free`, or `planar`: height and tilt of the tail module fixed."""
    ballast_depth: float = 0.005
    """How far the modules' centers of mass lie below their axes, for a free root with gravity: without it nothing keeps
    a robot upright. Mamba's is not known; this is an assumption [m]."""
    tank: bool = False
    """Whether the tank's floor and walls are there."""
    shore: Ground | None = None
    """The ground of a shore that leads down into the water, on which the robot begins; None: there is no land."""

    def __post_init__(self) -> None:
        """Check every setting once and fill in what was left open."""
        instance("joints", self.joints, JointLaw)
        one_of("root", self.root, mjcf.ROOTS)
        check_fits(self.robot, self.environment)
        instance("shore", self.shore, Ground, type(None))
        if self.shore is not None and (self.tank or isinstance(self.environment, Ground)):
            raise BadArgument("shore", "must be None in the tank or without water, got a Ground")
        if isinstance(self.environment, Ground) and self.root == "free" and not self.gravity:
            raise BadArgument("root", "must be `planar` on the ground without `gravity`, got 'free'")
        if self.shore is not None and not (self.root == "free" and self.gravity):
            raise BadArgument("root", "must be `free`, with `gravity`, for a robot that begins on a shore")
        if self.dt is not None:
            object.__setattr__(self, "dt", within("dt", self.dt, LEAST_DT, 1e3, "s"))
        object.__setattr__(self, "offset_bandwidth", positive("offset_bandwidth", self.offset_bandwidth, "rad/s"))
        object.__setattr__(self, "ballast_depth", finite("ballast_depth", self.ballast_depth, "m"))
        ramp = self.joints.ramp if self.ramp is None else self.ramp
        object.__setattr__(self, "ramp", not_negative("ramp", ramp, "s"))

    @property
    def is_implicit(self) -> bool:
        """Whether any joint is free, so that steps are linearly implicit (`laticauda.spatial.stepping`)."""
        return not self.joints.prescribed or (self.robot.caudal_fin is not None and self.robot.caudal_fin.n_hinges > 0)

    @property
    def settings(self) -> Spatial:
        """How the plant was made."""
        return Spatial(**{name: getattr(self, name) for name in Spatial.__dataclass_fields__})

    @property
    def land(self) -> Ground | None:
        """The ground on which the robot lies with its weight; None: there is none, or it slides on it in the plane."""
        if isinstance(self.environment, Ground) and self.root == "free" and self.gravity:
            return self.environment
        return self.shore
