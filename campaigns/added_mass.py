"""What mass of water do boxes, cylinders and capsules carry along? The numbers of `laticauda.water.mujoco`.

Question: added mass and inertia in unbounded water of every box, cylinder and capsule, from a plate
to a rod, to a few per cent, without a formula for each case.

    python campaigns/added_mass.py            # makes both tables anew (some ten minutes)
    python campaigns/added_mass.py --check    # only compares: with shapes between the rows, and with others

A boundary-element code (_panels.py) is run on a grid of proportions with n and 2 n panels a side and
extrapolated to panels of no size. What is stored are shares of the simple expressions of
`laticauda.water.mujoco.shape_mass`, which are never zero or infinite; the rows of proportions 0
continue the two smallest ones by straight lines.

Last answer (2026-11-29): added_mass.txt, beside numbers of others: Lamb (1932), DNV-RP-H103 (2011; as
it is quoted), and capytaine 3.0.0 as a second boundary-element code. Within 2 % of the code and 8 % of
the handbook; between the rows within 2.4 %. What a box without thickness carries across itself is a plate's, by the
vortex lattice (`laticauda.water.fluid.edges`), from which these panels differ by 1.5 % at most.
"""

import argparse
import csv
import itertools
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
from _panels import Panels, box_panels, capsule_panels, cylinder_panels, extrapolated

from laticauda.water.mujoco import shape_mass

FOLDER = Path(shape_mass.__file__).parent
ANSWER = Path(__file__).with_suffix(".txt")
PROPORTIONS = (0.01, 0.05, 0.1, 0.15, 0.2, 0.27, 0.35, 0.42, 0.5, 0.6, 0.7, 0.85, 1.0)
"""Short over middle, and middle over long side of a box; of these the smallest is left out."""
LENGTHS = (
    *(0.005, 0.02, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.34, 0.38, 0.42, 0.46, 0.5),
    *(0.54, 0.58, 0.62, 0.66, 0.7, 0.75, 0.8, 0.85, 0.9, 0.95),
)
"""h / (h + r) of a cylinder that is 2 h long, or of a capsule whose cylinder is."""
SHORTEST_CAPSULE = 0.05
"""The same; the inertia of shorter capsules, nearly spheres, is lost in the error of the panels [-]."""
COARSE = 6
"""Panels along the middle side of a box, or along a radius, in the coarser of two computations."""
N_BETWEEN = 12
"""Shapes between the rows, of each kind."""
SEED = 1
WATER = 1000.0
"""Density of the water of others' numbers [kg/m^3]."""


def compute_box(half: tuple[float, float, float]) -> np.ndarray:
    """Return added mass and inertia of a box with short, middle and long half sizes."""
    short, middle, long = half

    def make(n: int) -> Panels:
        n_short = max(2, round(n * np.sqrt(short / middle)))
        n_long = round(n * min(3.0, np.sqrt(long / middle)))
        return box_panels(half, (n_short, n, n_long))

    return extrapolated(make, COARSE)


def compute_cylinder(half_length: float) -> np.ndarray:
    """Return added mass and inertia of a cylinder along x with radius 1 m."""
    return _compute_round(cylinder_panels, half_length)


def compute_capsule(half_length: float) -> np.ndarray:
    """Return added mass and inertia of a capsule along x with radius 1 m."""
    return _compute_round(capsule_panels, half_length)


def _compute_round(make_round: Callable[..., Panels], half_length: float) -> np.ndarray:
    def make(n: int) -> Panels:
        n_side = max(2, round(n * min(3.0, np.sqrt(half_length))))
        return make_round(1.0, half_length, (n_side, n), n // 2 + 2)

    return extrapolated(make, COARSE)


def box_rows() -> Iterator[list[float]]:
    """Yield short/middle, middle/long and the six shares."""
    for thin, slender in itertools.product(PROPORTIONS, PROPORTIONS[1:]):
        half = (thin * slender, slender, 1.0)
        shares = compute_box(half) / shape_mass.box_scale(half)
        print(f"box {thin:g} {slender:g}: {shares.round(4)}", flush=True)
        yield [thin, slender, *shares]


def round_rows() -> Iterator[list[float | str]]:
    """Yield the shape, h / (h + r), and the shares along, across and about an axis across."""
    for share_of_length in LENGTHS:
        half_length = share_of_length / (1.0 - share_of_length)
        for name, compute, scale in (
            ("cylinder", compute_cylinder, shape_mass.cylinder_scale),
            ("capsule", compute_capsule, shape_mass.capsule_scale),
        ):
            if name == "capsule" and share_of_length < SHORTEST_CAPSULE:
                continue
            values = compute(half_length)
            shares = values[[0, 1, 4]] / scale(1.0, half_length)
            print(f"{name} {share_of_length:g}: {shares.round(4)}", flush=True)
            yield [name, share_of_length, *shares]


def continued(rows: np.ndarray, column: int) -> np.ndarray:
    """Return rows sorted by a column, and before them one of 0 there, on the line through the two smallest."""
    ordered = rows[np.argsort(rows[:, column])]
    slope = (ordered[1] - ordered[0]) / (ordered[1, column] - ordered[0, column])
    return np.vstack([ordered[0] - slope * ordered[0, column], ordered])


def complete_boxes(rows: np.ndarray) -> np.ndarray:
    """Return the table of boxes with rows for proportions of 0."""
    by_slender = [continued(rows[rows[:, 1] == slender], 0) for slender in np.unique(rows[:, 1])]
    with_thin = np.vstack(by_slender)
    by_thin = [
        continued(with_thin[with_thin[:, 0] == thin], 1) for thin in np.unique(with_thin[:, 0])
    ]
    return np.vstack(by_thin)


def complete_round(rows: np.ndarray) -> np.ndarray:
    """Return a table of a round shape with rows for no length and for an infinite one."""
    first = continued(rows, 0)
    mirrored = (
        first * np.r_[-1.0, np.ones(rows.shape[1] - 1)] + np.r_[1.0, np.zeros(rows.shape[1] - 1)]
    )
    both = continued(mirrored, 0)
    both[:, 0] = 1.0 - both[:, 0]
    return both[::-1]


def write(path: Path, header: Iterable[str], rows: Iterable[Iterable[object]]) -> None:
    """Write a table with six decimals."""
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(header)
        for row in rows:
            writer.writerow(f"{v:.6g}" if isinstance(v, float) else v for v in row)


def make_tables() -> None:
    """Compute both tables and store them in the package."""
    boxes = complete_boxes(np.array(list(box_rows())))
    write(
        FOLDER / "shape_mass_box.csv",
        shape_mass.BOX_COLUMNS,
        ([float(v) for v in row] for row in boxes),
    )
    rows = list(round_rows())
    stored: list[list[object]] = []
    for name in ("cylinder", "capsule"):
        numbers = np.array([row[1:] for row in rows if row[0] == name], dtype=float)
        stored += [[name, *(float(v) for v in row)] for row in complete_round(numbers)]
    write(FOLDER / "shape_mass_round.csv", shape_mass.ROUND_COLUMNS, stored)


class Known(NamedTuple):
    """A number of others, in water of 1000 kg/m^3."""

    what: str
    """The shape and its motion."""
    source: str
    """Who says it."""
    right: float
    """The number [kg] or [kg m^2]."""
    shape: shape_mass.MassShape
    """The shape."""
    half: tuple[float, float, float]
    """Its half sizes [m]."""
    quantity: int
    """Which it is: mass along x, y or z, or inertia about them."""
    tolerance: float
    """Relative difference that the tests accept [-]."""


KNOWN = (
    Known(
        "sphere, r 0.1",
        "Lamb (1932), art. 92",
        2.0 / 3.0 * np.pi,
        "capsule",
        (0.1, 0.1, 0.1),
        0,
        0.02,
    ),
    Known(
        "sphere, r 0.1, across",
        "Lamb (1932), art. 92",
        2.0 / 3.0 * np.pi,
        "capsule",
        (0.1, 0.1, 0.1),
        1,
        0.02,
    ),
    Known(
        "disc r 0.25",
        "Lamb (1932), art. 108: 8/3 r^3",
        8.0 / 3.0 * 0.25**3 * WATER,
        "cylinder",
        (2.5e-4, 0.25, 0.25),
        0,
        0.01,
    ),
    Known(
        "disc r 0.25 about a diameter",
        "Lamb (1932), art. 108: 16/45 r^5",
        16.0 / 45.0 * 0.25**5 * WATER,
        "cylinder",
        (2.5e-4, 0.25, 0.25),
        4,
        0.05,
    ),
    Known(
        "square plate, side 0.5",
        "DNV-RP-H103: C_A 0.579",
        0.579 * np.pi / 4.0 * 0.5**3 * WATER,
        "box",
        (2.5e-4, 0.25, 0.25),
        0,
        0.02,
    ),
    Known(
        "plate 0.5 x 0.25",
        "DNV-RP-H103: C_A 0.757",
        0.757 * np.pi / 4.0 * 0.25**2 * 0.5 * WATER,
        "box",
        (2e-4, 0.125, 0.25),
        0,
        0.02,
    ),
    Known(
        "plate 1 x 0.1",
        "DNV-RP-H103: C_A 0.947",
        0.947 * np.pi / 4.0 * 0.1**2 * WATER,
        "box",
        (1e-4, 0.05, 0.5),
        0,
        0.02,
    ),
    Known(
        "cube, side 0.2",
        "DNV-RP-H103: C_A 0.68",
        0.68 * 0.2**3 * WATER,
        "box",
        (0.1, 0.1, 0.1),
        0,
        0.10,
    ),
    Known(
        "prism 1:5, end on (0.2 x 0.2 x 1)",
        "DNV-RP-H103: C_A 0.15",
        0.15 * 0.2 * 0.2 * 1.0 * WATER,
        "box",
        (0.5, 0.1, 0.1),
        0,
        0.10,
    ),
    Known(
        "cylinder r 0.05, L 1, across",
        "DNV-RP-H103: 0.96 of the strip",
        0.96 * np.pi * 0.05**2 * WATER,
        "cylinder",
        (0.5, 0.05, 0.05),
        1,
        0.02,
    ),
    Known(
        "cylinder r 0.05, L 0.5, end on",
        "capytaine 3.0.0",
        0.50,
        "cylinder",
        (0.25, 0.05, 0.05),
        0,
        0.03,
    ),
    Known(
        "capsule r 0.05, half 0.2, end on",
        "capytaine 3.0.0",
        0.33,
        "capsule",
        (0.25, 0.05, 0.05),
        0,
        0.03,
    ),
    Known(
        "prism 0.5 x 0.1 x 0.1, across", "capytaine 3.0.0", 5.17, "box", (0.25, 0.05, 0.05), 1, 0.03
    ),
    Known(
        "box .457 x .338 x .254, along x",
        "capytaine 3.0.0",
        16.5,
        "box",
        (0.2285, 0.169, 0.127),
        0,
        0.03,
    ),
    Known(
        "box .457 x .338 x .254, along y",
        "capytaine 3.0.0",
        24.4,
        "box",
        (0.2285, 0.169, 0.127),
        1,
        0.03,
    ),
    Known(
        "box .457 x .338 x .254, along z",
        "capytaine 3.0.0",
        37.1,
        "box",
        (0.2285, 0.169, 0.127),
        2,
        0.03,
    ),
    Known(
        "cylinder r 0.05, L 0.5, about y",
        "capytaine 3.0.0",
        0.0579,
        "cylinder",
        (0.25, 0.05, 0.05),
        4,
        0.05,
    ),
    Known(
        "cylinder r 0.05, L 0.2, about y",
        "capytaine 3.0.0",
        0.00241,
        "cylinder",
        (0.1, 0.05, 0.05),
        4,
        0.05,
    ),
    Known(
        "capsule r 0.05, half 0.2, about y",
        "capytaine 3.0.0",
        0.0455,
        "capsule",
        (0.25, 0.05, 0.05),
        4,
        0.05,
    ),
    Known(
        "capsule r 0.0955, half 0.5695, about y",
        "capytaine 3.0.0",
        3.74,
        "capsule",
        (0.665, 0.0955, 0.0955),
        4,
        0.05,
    ),
    Known(
        "box .457 x .338 x .254, about x",
        "capytaine 3.0.0",
        0.171,
        "box",
        (0.2285, 0.169, 0.127),
        3,
        0.05,
    ),
    Known(
        "box .457 x .338 x .254, about y",
        "capytaine 3.0.0",
        0.340,
        "box",
        (0.2285, 0.169, 0.127),
        4,
        0.05,
    ),
    Known(
        "box .457 x .338 x .254, about z",
        "capytaine 3.0.0",
        0.266,
        "box",
        (0.2285, 0.169, 0.127),
        5,
        0.05,
    ),
    Known(
        "cube, side 0.2, about an axis", "capytaine 3.0.0", 0.0127, "box", (0.1, 0.1, 0.1), 5, 0.05
    ),
    Known(
        "prism 0.5 x 0.1 x 0.1, about x",
        "capytaine 3.0.0",
        0.00233,
        "box",
        (0.25, 0.05, 0.05),
        3,
        0.05,
    ),
    Known(
        "prism 0.5 x 0.1 x 0.1, about y",
        "capytaine 3.0.0",
        0.0833,
        "box",
        (0.25, 0.05, 0.05),
        4,
        0.05,
    ),
)


def from_tables(shape: shape_mass.MassShape, half: tuple[float, float, float]) -> np.ndarray:
    """Return the six numbers of the package for water of 1 kg/m^3."""
    loads = shape_mass.added_mass(shape, half)
    return np.r_[loads.mass, loads.inertia]


def check_known() -> Iterator[str]:
    """Yield a line for each number of others."""
    for known in KNOWN:
        value = WATER * from_tables(known.shape, known.half)[known.quantity]
        difference = 100.0 * (value / known.right - 1.0)
        yield f"{known.what:40} {value:9.4g} {known.right:9.4g} {difference:+6.1f} %   {known.source}"


def check_between() -> Iterator[str]:
    """Yield the largest differences of shapes between the rows, computed by panels."""
    random = np.random.default_rng(SEED)
    worst: dict[str, np.ndarray] = {}
    for _ in range(N_BETWEEN):
        thin = random.uniform(0.02, 1.0)
        slender = random.uniform(0.06, 1.0)
        half = (thin * slender, slender, 1.0)
        ratio = np.abs(from_tables("box", half) / compute_box(half) - 1.0)
        worst["box"] = np.maximum(worst.get("box", 0.0), ratio)
        length = random.uniform(0.06, 0.95)
        half_length = length / (1.0 - length)
        ratio = np.abs(
            from_tables("cylinder", (half_length, 1.0, 1.0)) / compute_cylinder(half_length) - 1.0
        )
        worst["cylinder"] = np.maximum(worst.get("cylinder", 0.0), ratio[[0, 1, 4]])
        capsule = compute_capsule(half_length)
        ratio = np.abs(from_tables("capsule", (half_length + 1.0, 1.0, 1.0)) / capsule - 1.0)
        worst["capsule"] = np.maximum(worst.get("capsule", 0.0), ratio[[0, 1, 4]])
    for shape, ratios in worst.items():
        yield f"{shape}: {N_BETWEEN} between the rows differ by at most {np.round(100.0 * ratios, 1)} %"


def main() -> None:
    """Make the tables, or check them."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--check", action="store_true", help="compare, and make nothing")
    if not parser.parse_args().check:
        make_tables()
    lines = [*check_known(), *check_between()]
    ANSWER.write_text("\n".join(lines) + "\n", encoding="utf-8")
    print("\n".join(lines))


if __name__ == "__main__":
    main()
