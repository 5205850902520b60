"""Where the middle of the body is, seen from the head, by the joints' own encoders."""

import math
from collections.abc import Sequence
from typing import NamedTuple


class Posture(NamedTuple):
    """The body as seen from the tip of the head: how far the middle is behind it, how it swings, where it points."""

    head_x: float
    """Tip of the head from the middle of the body, world axes [m]."""
    head_y: float
    """Likewise [m]."""
    swing_x: float
    """Its velocity relative to the middle [m/s]."""
    swing_y: float
    """Likewise [m/s]."""
    heading: float
    """Mean direction of all links [rad]."""


def bend_of_head(joint_values: Sequence[float]) -> float:
    """Return the direction of the head relative to the mean of all links [rad], or of rates [rad/s].

    Args:
        joint_values: Angles of all joints [rad], tail first, or their rates [rad/s].
    """
    n_links = len(joint_values) + 1
    bend = 0.0
    for joint, value in enumerate(joint_values):
        bend += value * (joint + 1) / n_links
    return bend


def find_posture(
    *,
    body_length: float,
    head_heading: float,
    head_rate: float,
    joint_angle: Sequence[float],
    joint_rate: Sequence[float],
) -> Posture:
    """Return the posture of a body of equal links.

    Args:
        body_length: Length of all links [m].
        head_heading: Direction of the head [rad].
        head_rate: How fast it turns [rad/s].
        joint_angle: Angles of all joints, tail first [rad].
        joint_rate: Their rates [rad/s].
    """
    n_links = len(joint_angle) + 1
    link_length = body_length / n_links
    angle = head_heading
    rate = head_rate
    head_x = head_y = swing_x = swing_y = 0.0
    for link in range(n_links - 1, -1, -1):
        lever = link_length * (link + 0.5) / n_links
        along_x = lever * math.cos(angle)
        along_y = lever * math.sin(angle)
        head_x += along_x
        head_y += along_y
        swing_x -= rate * along_y
        swing_y += rate * along_x
        if link > 0:
            angle -= joint_angle[link - 1]
            rate -= joint_rate[link - 1]
    heading = head_heading - bend_of_head(joint_angle)
    return Posture(head_x, head_y, swing_x, swing_y, heading)
