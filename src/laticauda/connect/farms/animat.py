"""What was read of an animat of FARMS."""

import math
from dataclasses import dataclass

from laticauda.control import PhaseOscillators
from laticauda.motion.joints import JointLaw
from laticauda.robot import Robot, Water
from laticauda.values import name_of


@dataclass(frozen=True, kw_only=True)
class FarmsAnimat:
    """What was read of an animat of FARMS. Modules and joints are tail first, as everywhere here, not head first."""

    robot: Robot
    """Its spine: lengths, masses, sections, limits of joints, servos."""
    links: tuple[str, ...]
    """Names of the links that became modules, tail first."""
    joint_names: tuple[str, ...]
    """Names of the joints, tail first."""
    network: PhaseOscillators | None
    """Its oscillators at the drives of the file; None if the file has none with numbers."""
    joints: JointLaw
    """Joint law that goes with it: servos, Ekeberg's muscles, or prescribed joints."""
    robot_with_drag: Robot | None
    """The robot with the drag of FARMS on its modules, for `water`; None if the file has no drag."""
    water: Water | None
    """Water without any load but that drag: quadratic, and no added mass."""
    left_out: tuple[str, ...]
    """What was not taken, or not as it is, in words."""

    @property
    def words(self) -> str:
        """What was read and what was not, in lines."""
        links = ", ".join(self.links)
        joint_names = ", ".join(self.joint_names)
        lines = [self.robot.words]
        lines.append(f"modules, tail first: {links}")
        lines.append(f"joints, tail first: {joint_names}")
        lines.append(f"joint law: {_describe_law(self.joints)}")
        lines.append(f"network: {_describe(self.network)}")
        if self.robot_with_drag is not None:
            lines.append("drag of FARMS: on `robot_with_drag`, for `water`")
        lines.append("not taken, or not as it is:")
        lines += [f"- {remark}" for remark in self.left_out]
        return "\n".join(lines)


def _describe_law(law: JointLaw) -> str:
    """Return a joint law in a line: the name that `--joints` takes, and its numbers."""
    parts = [name_of(type(law))]
    for name, value in vars(law).items():
        if isinstance(value, float):
            parts.append(f"{name} {value:.4g}")
    return ", ".join(parts)


def _describe(network: PhaseOscillators | None) -> str:
    """Return the network in a line."""
    if network is None:
        return "none"
    gait = network.gait
    lag = math.degrees(gait.phase_shift)
    parts = [f"{gait.frequency / math.tau:.4g} Hz"]
    parts.append(f"amplitude {gait.amplitude:.4g} rad")
    parts.append(f"{lag:.4g} deg from joint to joint")
    parts.append(f"offset {gait.offset:.4g} rad")
    parts.append(f"coupling {network.coupling:.4g} 1/s")
    parts.append(f"amplitude rate {network.amplitude_rate:.4g} 1/s")
    return ", ".join(parts)
