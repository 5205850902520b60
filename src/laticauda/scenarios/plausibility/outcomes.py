"""How fast a robot swam, judged after the run."""

import math

from laticauda.robot import Environment, Robot, Water
from laticauda.scenarios.plausibility.telling import warn_of_doubt

FASTEST_SWIMMER = 3.0
"""Body lengths per second above which hardly any robot of many joints swims."""


def warn_of_speed(robot: Robot, speed: float, environment: Environment) -> None:
    """Warn if a robot moved many times its own length per second.

    Args:
        robot: The robot.
        speed: Its mean speed over ground [m/s].
        environment: What it swam in; a uniform current is not counted, and no other flow judged.
    """
    if isinstance(environment, Water):
        if environment.flow is not None:
            return
        speed = max(0.0, speed - math.hypot(*environment.uniform))
    lengths = speed / robot.reach
    if not lengths > FASTEST_SWIMMER:
        return
    swam = f"{robot.name} swam {speed:.3g} m/s, {lengths:.2g} body lengths per second"
    hint = "are size, mass, frequency and coefficients in SI units?"
    warn_of_doubt(f"{swam}: no robot of its kind does; {hint}")
