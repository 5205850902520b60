"""How strongly do the waves that a floating box makes damp its heave, roll and pitch?

Question: what are the dampings B_33, B_44 and B_55 of boxes of uniform density that float half
submerged, each at its own resonance, in deep water? The package multiplies them for elements that
`attach` fits to geoms. Computed with the boundary-element code capytaine; roll and pitch are about
the middle of the waterline. A box that has no resonance, as it would turn over, gets the damping at
the resonance of its heave.

    python campaigns/radiation.py          # the table, from the package
    python campaigns/radiation.py --run    # anew, some minutes of one core; needs capytaine

Columns: width over length, draft over width; then the dampings over rho g^(1/2) V^(5/6), and for roll
and pitch over rho g^(1/2) V^(3/2), V being the submerged volume.
"""

import argparse
import csv
import logging
import math
from pathlib import Path
from typing import Any

import numpy as np

import laticauda

STORED = Path(laticauda.__file__).parent / "water" / "mujoco" / "radiation_box.csv"
WIDTHS = (0.1, 0.2, 0.4, 0.7, 1.0)
DRAFTS = (0.1, 0.2, 0.4, 0.7, 1.0)
GRAVITY = 9.81
RHO = 1000.0
COLUMNS = ("width", "draft", "heave", "roll", "pitch")
REPEATS = 2
"""Solutions on the way to the resonance, whose added mass depends on its frequency."""


def solve(body: Any, dof: str, omega: float) -> tuple[float, float]:
    """Return added mass and damping of a motion."""
    import capytaine

    problem = capytaine.RadiationProblem(
        body=body, omega=omega, radiating_dof=dof, rho=RHO, g=GRAVITY
    )
    result = capytaine.BEMSolver().solve(problem)
    return result.added_masses[dof], result.radiation_dampings[dof]


def damping_at_resonance(
    body: Any, dof: str, stiffness: float, mass: float, otherwise: float
) -> tuple[float, float]:
    """Return the damping, and the frequency for which it holds."""
    if stiffness <= 0.0:
        return solve(body, dof, otherwise)[1], otherwise
    omega = math.sqrt(stiffness / (2.0 * mass))
    for _ in range(REPEATS):
        added, _ = solve(body, dof, omega)
        omega = math.sqrt(stiffness / (mass + added))
    return solve(body, dof, omega)[1], omega


def dampings(width: float, draft: float) -> list[float]:
    """Return the dampings of a box of 1 m length, without dimension."""
    import capytaine

    depth = draft * width
    counts = (24, max(6, round(24 * width)), 8)
    mesh = capytaine.mesh_parallelepiped(
        size=(1.0, width, 2.0 * depth), resolution=counts, center=(0.0, 0.0, 0.0)
    ).immersed_part()
    body = capytaine.FloatingBody(
        mesh=mesh, dofs=capytaine.rigid_body_dofs(rotation_center=(0.0, 0.0, 0.0))
    )
    volume = width * depth
    mass = RHO * volume
    height = 2.0 * depth
    heave, omega = damping_at_resonance(body, "Heave", RHO * GRAVITY * width, mass, 0.0)
    found = [heave / volume ** (5.0 / 6.0)]
    for dof, side in (("Roll", width), ("Pitch", 1.0)):
        metacenter = side**2 / (12.0 * depth) - 0.5 * depth
        inertia = mass * (side**2 + height**2) / 12.0
        value, _ = damping_at_resonance(body, dof, mass * GRAVITY * metacenter, inertia, omega)
        found.append(value / volume**1.5)
    return [value / (RHO * math.sqrt(GRAVITY)) for value in found]


def main() -> None:
    """Print or compute the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--run", action="store_true")
    if not parser.parse_args().run:
        print(STORED.read_text(encoding="utf-8"))
        return
    logging.disable(logging.CRITICAL)
    with STORED.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(COLUMNS)
        for width in WIDTHS:
            for draft in DRAFTS:
                row = [width, draft, *np.round(dampings(width, draft), 5)]
                print(*row, flush=True)
                writer.writerow(row)


if __name__ == "__main__":
    main()
