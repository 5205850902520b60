"""Where the thrusters and pectoral fins of a robot are mounted on its bodies, and how they are turned."""

from typing import NamedTuple

from laticauda.models.spatial.bodies import Three
from laticauda.robot import PectoralFin, Robot, Thruster, to_quaternion, turn

Quaternion = tuple[float, float, float, float]


class Mount(NamedTuple):
    """Mounting pose of a thruster or a pectoral fin."""

    name: str
    """Name: `thruster_k` or `pectoral_fin_k`."""
    body: str
    """Body on which it is mounted."""
    position: Three
    """Position in the body's frame [m]."""
    orientation: Quaternion
    """Orientation of its axes in the body's frame, as a quaternion (w, x, y, z) [-]."""


def build_mounts(robot: Robot) -> list[Mount]:
    """Return the mounts of the robot's thrusters, then those of its pectoral fins."""
    mounts = [
        _build_mount(robot, f"thruster_{k}", thruster) for k, thruster in enumerate(robot.thrusters)
    ]
    for k, fin in enumerate(robot.pectoral_fins):
        mounts.append(_build_mount(robot, f"pectoral_fin_{k}", fin))
    return mounts


def _build_mount(robot: Robot, name: str, effector: Thruster | PectoralFin) -> Mount:
    middle = robot.modules[effector.link].half_length
    return Mount(
        name=name,
        body=f"module_{effector.link}",
        position=(middle + effector.x, effector.y, effector.z),
        orientation=_orientation(effector),
    )


def _orientation(effector: Thruster | PectoralFin) -> Quaternion:
    """Return the orientation: rotation about z, tilt, roll about x and, for a fin, deflection about its own z."""
    tilted = turn("yaw", effector.angle) @ turn("pitch", -effector.elevation)
    mounted = tilted @ turn("roll", effector.roll)
    deflection = effector.deflection if isinstance(effector, PectoralFin) else 0.0
    return to_quaternion(mounted @ turn("yaw", deflection))
