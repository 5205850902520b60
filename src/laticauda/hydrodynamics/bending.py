"""How fast a fin that bends would swing by itself."""

import math

import numpy as np
from jaxtyping import Float

from laticauda.errors import BadArgument
from laticauda.hydrodynamics.coefficients import link_coefficients
from laticauda.robot import Environment, Robot


def bending_frequencies(robot: Robot, environment: Environment) -> Float[np.ndarray, " n_hinges"]:
    """Natural frequencies of a robot's fin with its root held still, without drag and damping.

    Small deflections: (K - (2 pi f)^2 M) phi = 0 for the hinges' angles phi, with K the hinges' stiffness and M the
    inertia of plate and added mass behind them, m (x - s_i)(x - s_j) for a mass m at x behind the hinges i and j.

    Args:
        robot: Its fin has hinges.
        environment: The water around it; on the ground there is no added mass.

    Returns:
        f of every mode, lowest first [Hz].

    Raises:
        ValueError: If there is no fin that bends.

    Example:
        >>> from dataclasses import replace
        >>> from laticauda.robot import load_robot, load_water
        >>> robot = load_robot("mamba-fin")
        >>> fin = replace(robot.caudal_fin, n_hinges=2, flexural_rigidity=2.0)
        >>> bending_frequencies(replace(robot, caudal_fin=fin), load_water("paper-lateral")).round(2).tolist()
        [1.22, 7.85]
    """
    fin, strips = robot.caudal_fin, link_coefficients(robot, environment).fin
    if fin is None or strips is None or not fin.hinges:
        raise BadArgument("robot", "must have a fin that bends (`caudal_fin.n_hinges` > 0), got one that does not")
    hinge = np.array([one.position for one in fin.hinges])
    pieces = [(0.5 * (p.begin + p.end), p.mass, p.mass * p.length**2 / 12.0) for p in fin.pieces]
    water = zip(-strips.position, strips.mu_n, strips.lambda_1, strict=True)
    mass_matrix = np.zeros((hinge.size, hinge.size))
    for place, mass, inertia in [*pieces, *water]:
        behind = hinge < place
        arm = np.where(behind, place - hinge, 0.0)
        mass_matrix += mass * np.outer(arm, arm) + inertia * np.outer(behind, behind)
    root = np.diag([math.sqrt(one.stiffness) for one in fin.hinges])
    flexibility = np.linalg.eigvalsh(np.linalg.inv(root) @ mass_matrix @ np.linalg.inv(root))
    return np.asarray(1.0 / (2.0 * math.pi * np.sqrt(flexibility[::-1])))
