"""The person at the tank: does what one line of text says."""

import math

from laticauda.errors import BadArgument
from laticauda.interfaces import Start
from laticauda.lab.faults import KINDS, fault_from_words
from laticauda.lab.tank import Tank

HELP = (
    "Lines: a fault (" + ", ".join(KINDS) + ") with node=, duration=, share=, delay=, temperature=; `clear` ends all "
    "faults; `carry X Y HEADING_DEG` puts the robot back; `truth` says where it is."
)


def assist(tank: Tank, line: str) -> str:
    """Do what a line says, and tell what was done.

    Args:
        tank: Where.
        line: What, in the words of `HELP`.

    Raises:
        ValueError: If it says nothing that can be done.
    """
    words = line.split()
    if not words or words[0] == "help":
        return HELP
    if words[0] == "clear":
        tank.faults.clear()
        return "no faults"
    if words[0] == "carry":
        return _carry(tank, words[1:])
    if words[0] == "truth":
        truth = tank.truth
        x, y, z = truth.center_of_mass.tolist()
        heading = math.degrees(truth.heading)
        return f"time {tank.time:.2f} s, center of mass {x:.4f} {y:.4f} {z:.4f} m, heading {heading:.2f} deg"
    fault = fault_from_words(line, tank.time)
    tank.inject(fault)
    where = f" at node {fault.node}" if fault.node else ""
    return f"{fault.kind}{where}: {KINDS[fault.kind]}"


def _carry(tank: Tank, words: list[str]) -> str:
    try:
        x, y, heading = (float(word) for word in words)
    except ValueError:
        got = " ".join(words)
        raise BadArgument("carry", f"must have three numbers, x y [m] and heading [deg], got {got!r}") from None
    tank.carry(Start(center_of_mass=(x, y), heading=math.radians(heading)))
    return f"the robot lies straight at {x:g} {y:g} m, heading {heading:g} deg"
