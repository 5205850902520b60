"""What of the shape of a robot with prescribed joints concerns all its bodies, see `prescribed`."""

from typing import NamedTuple


class Shape(NamedTuple):
    """How heading, center of mass and inertia follow from body 0, the tail-most, in its axes."""

    turn: float
    """Mean angle of the links from body 0 [rad]."""
    turn_rate: float
    """Its rate [rad/s]."""
    turn_acceleration: float
    """The rate of that [rad/s^2]."""
    mean_x: float
    """Center of mass from the tail end of body 0 [m]."""
    mean_y: float
    """The same across [m]."""
    mean_vx: float
    """Its rate while body 0 is held [m/s]."""
    mean_vy: float
    """The same across [m/s]."""
    mean_ax: float
    """The rate of that [m/s^2]."""
    mean_ay: float
    """The same across [m/s^2]."""
    a00: float
    """Inertia of the stiff robot about the tail end of body 0, added mass included: of rotation [kg m^2]."""
    a01: float
    """Of rotation and x [kg m]."""
    a02: float
    """Of rotation and y [kg m]."""
    a11: float
    """Of x [kg]."""
    a12: float
    """Of x and y [kg]."""
    a22: float
    """Of y [kg]."""
