"""What loads does an unsteady vortex lattice find on plates of other shapes? The oracle of `edge_map.py`.

Question: mean thrust, side force and moment of a rigid plate, swept, forked or behind another one, that heaves,
pitches about its root, or both.

    python campaigns/edge_lattice.py            # makes edge_map_shapes.csv anew (some minutes)
    python campaigns/edge_lattice.py --check    # compares rectangles with edge_map.csv, which another code made

The cells are those of `laticauda.water.fluid.lattice`. All is harmonic in time, which is the limit of small steps:
behind every row a straight wake of rings goes aft at u and keeps the strength that it was shed with. The thrust, with
full suction at the leading edge, is what the plate's power leaves over from the energy in the far wake. Results at
n and 2 n cells along the chord are extrapolated. rho = u = h = 1; phases and moments as in `edge_map.py`.

Last answer (2026-11-29): --check agrees within 2.2 % in thrust, 0.1 % in side force and 0.4 % in moment.
"""

import argparse
import csv
from typing import NamedTuple

import numpy as np
from edge_map import SHAPES, STORED, STORED_SHAPES, motion_of, outline_of

from laticauda.water.fluid.lattice import (
    Cells,
    Outline,
    PlateAhead,
    Rings,
    build_cells,
    influence,
    shift_by_a_quarter,
)

FREQUENCIES = (0.3, 1.0, 3.0, 8.0, 16.0, 25.0)
"""omega h/u [-]."""
MOTIONS = ("heave", "pitchLE", "swim")
FINE_FROM = 1.5
"""omega c/u from which on there are twice as many cells."""
HIGHEST = 8.0
"""omega c/u up to which the cells are short enough."""
WAKE_PERIODS = 6.0
"""Wavelengths of wake behind the plate at least."""
WAKE_SPANS = 8.0
"""Heights of wake at least."""
LONGEST_WAKE = 60.0
"""Heights of wake at most."""
COLUMNS = (
    *("shape", "omega_h_over_u", "motion", "thrust_mean", "power_in_mean"),
    *("side_amp", "side_phase_deg", "moment_root_amp", "moment_root_phase_deg"),
)
CHECKED = {"0.5": (0.3, 1.0, 3.0), "1.0": (0.3, 1.0, 3.0, 8.0), "5.562": (0.3, 3.0, 8.0, 22.0)}
"""Rectangles, by h/c as edge_map.csv writes it, and their frequencies."""


class Response(NamedTuple):
    """Loads by heave and slope of 1; sums of waves are linear in them, means are quadratic."""

    loads: np.ndarray
    """Side force and moment about the root (rows) by heave and slope (columns), complex."""
    power: np.ndarray
    """Mean power q* P q of a motion q = (heave, slope)."""
    thrust: np.ndarray
    """Mean thrust, likewise."""


class Wake(NamedTuple):
    """Where rings lie along the wake."""

    length: float
    """Length of a ring."""
    fading: np.ndarray
    """Factors of the rings' strengths, which end the wake softly."""


def respond(outline: Outline, ahead: PlateAhead | None, omega_c: float, omega: float) -> Response:
    """Return the response at a frequency, extrapolated in the number of cells."""
    refinement = 1 if omega_c < FINE_FROM else 2
    coarse = _respond(build_cells(outline, ahead, refinement=refinement), omega)
    fine = _respond(build_cells(outline, ahead, refinement=2 * refinement), omega)
    return Response(*(2.0 * at_2n - at_n for at_n, at_2n in zip(coarse, fine, strict=True)))


def _respond(cells: Cells, omega: float) -> Response:
    sides = cells.sides
    share = (cells.middle - sides.below) / (sides.above - sides.below)
    front = sides.front_below + share * (sides.front_above - sides.front_below)
    back = sides.back_below + share * (sides.back_above - sides.back_below)
    chord = back - front
    breadth = 2.0 * (sides.above - sides.below)
    rings = _end_at_a_quarter(cells)
    middle = 0.25 * (rings.front_below + rings.front_above + rings.back_below + rings.back_above)
    last = np.flatnonzero(cells.is_last)
    wake = _build_wake(cells, omega, float(np.max(chord[last])))

    x = front + 0.75 * chord
    matrix = influence(x, cells.middle, rings).astype(complex)
    for i in last:
        shed = _rings_behind(rings, int(i), wake)
        places = 0.25 * (shed.front_below + shed.front_above + shed.back_below + shed.back_above)
        phases = wake.fading * np.exp(-1j * omega * (places - middle[i]))
        matrix[:, i] += influence(x, cells.middle, shed) @ phases
    speeds = np.stack((1j * omega * np.ones_like(x), 1j * omega * x + 1.0), axis=1)
    strengths = np.linalg.solve(matrix, speeds)

    before = np.where(cells.is_first[:, np.newaxis], 0.0, np.roll(strengths, 1, axis=0))
    area = (chord * breadth)[:, np.newaxis]
    of_vortices = (strengths - before) * breadth[:, np.newaxis]
    of_change_ahead = 0.25j * omega * before * area
    of_change_behind = 0.75j * omega * strengths * area
    parts = (
        (of_vortices, front + 0.25 * chord),
        (of_change_ahead, front + 0.125 * chord),
        (of_change_behind, front + 0.625 * chord),
    )
    side = np.sum([force.sum(axis=0) for force, _ in parts], axis=0)
    moment = np.sum([place @ force for force, place in parts], axis=0)
    loads = np.stack((side, moment))
    power = _hermitian(0.5j * omega * loads)
    shed_strengths = strengths[last] * np.exp(1j * omega * middle[last])[:, np.newaxis]
    energy = _energy_of_far_wake(cells, omega, wake, shed_strengths)
    return Response(loads=loads, power=power, thrust=power - energy)


def _hermitian(form: np.ndarray) -> np.ndarray:
    return 0.5 * (form + form.conj().T)


def _end_at_a_quarter(cells: Cells) -> Rings:
    """Return the bound rings; the last one of a row ends a quarter of a cell behind the plate."""
    sides, rings = cells.sides, shift_by_a_quarter(cells)
    below = sides.back_below + 0.25 * (sides.back_below - sides.front_below)
    above = sides.back_above + 0.25 * (sides.back_above - sides.front_above)
    return rings._replace(
        back_below=np.where(cells.is_last, below, rings.back_below),
        back_above=np.where(cells.is_last, above, rings.back_above),
    )


def _build_wake(cells: Cells, omega: float, length_of_ring: float) -> Wake:
    reach = 2.0 * float(np.max(np.abs(cells.sides.back_below)))
    length = max(WAKE_SPANS * cells.height + reach, WAKE_PERIODS * 2.0 * np.pi / omega)
    length = min(length, LONGEST_WAKE * cells.height)
    n = int(length / length_of_ring)
    return Wake(length_of_ring, _fade(np.arange(1, n + 1), n))


def _fade(places: np.ndarray, n: int) -> np.ndarray:
    """Return factors that fall smoothly to 0 in the second half of n places."""
    distance = np.abs(places) - 0.5 * n
    return np.where(distance > 0.0, 0.5 * (1.0 + np.cos(2.0 * np.pi * distance / n)), 1.0)


def _rings_behind(rings: Rings, i: int, wake: Wake) -> Rings:
    """Return the rings of the wake behind a last bound ring."""
    n = wake.fading.size
    begin = np.arange(n) * wake.length
    below, above = rings.back_below[i] + begin, rings.back_above[i] + begin
    return Rings(
        front_below=below,
        back_below=below + wake.length,
        front_above=above,
        back_above=above + wake.length,
        below=np.full(n, rings.below[i]),
        above=np.full(n, rings.above[i]),
    )


def _energy_of_far_wake(
    cells: Cells, omega: float, wake: Wake, strengths: np.ndarray
) -> np.ndarray:
    """Return the mean energy per length of a wake without ends, by the strengths that its rings have at x = 0."""
    last = np.flatnonzero(cells.is_last)
    n = wake.fading.size
    places = np.arange(-n, n + 1)
    phases = _fade(places, n) * np.exp(-1j * omega * wake.length * places)
    front = (places - 0.5) * wake.length
    at_middle, heights = np.zeros(last.size), cells.middle[last]
    velocity = np.zeros((last.size, last.size), complex)
    for column, i in enumerate(last):
        rows = Rings(
            front_below=front,
            back_below=front + wake.length,
            front_above=front,
            back_above=front + wake.length,
            below=np.full(places.size, cells.sides.below[i]),
            above=np.full(places.size, cells.sides.above[i]),
        )
        velocity[:, column] = influence(at_middle, heights, rows) @ phases
    breadth = 2.0 * (cells.sides.above - cells.sides.below)[last]
    impulses = strengths * breadth[:, np.newaxis]
    return _hermitian(-0.25 * (impulses.conj().T @ (velocity @ strengths)))


def figures_of(response: Response, motion: np.ndarray) -> list[float]:
    """Return a row's numbers: mean thrust and power, amplitudes and phases of side force and moment."""
    side, moment = response.loads @ motion
    return [
        float(np.real(motion.conj() @ response.thrust @ motion)),
        float(np.real(motion.conj() @ response.power @ motion)),
        *(float(np.abs(side)), float(np.degrees(np.angle(side)))),
        *(float(np.abs(moment)), float(np.degrees(np.angle(moment)))),
    ]


def record() -> None:
    """Write the table of the shapes."""
    with STORED_SHAPES.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(COLUMNS)
        for name, shape in SHAPES.items():
            for omega in FREQUENCIES:
                if omega * shape.chord > HIGHEST:
                    continue
                response = respond(outline_of(shape), shape.ahead, omega * shape.chord, omega)
                for motion in MOTIONS:
                    figures = figures_of(response, np.array(motion_of(motion, omega)))
                    writer.writerow([name, omega, motion, *(f"{x:.5g}" for x in figures)])


def check() -> None:
    """Print how far rectangles are from the other code's answer, at most."""
    stored = list(csv.DictReader(STORED.read_text(encoding="utf-8").splitlines()))
    worst = np.zeros(3)
    for aspect, frequencies in CHECKED.items():
        for omega in frequencies:
            chord = 1.0 / float(aspect)
            response = respond(Outline.rectangle(chord, 1.0), None, omega * chord, omega)
            for row in stored:
                if row["h_over_c"] == aspect and float(row["omega_h_over_u"]) == omega:
                    motion = np.array(motion_of(row["motion"], omega))
                    thrust, _, side, _, moment, _ = figures_of(response, motion)
                    others = [row[name] for name in ("thrust_mean", "side_amp", "moment_LE_amp")]
                    ratios = np.array((thrust, side, moment)) / np.array(others, dtype=float)
                    worst = np.maximum(worst, np.abs(ratios - 1.0))
    print("at most {:.1%} in thrust, {:.1%} in side force, {:.1%} in moment".format(*worst))


def main() -> None:
    """Make the table, or check."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--check", action="store_true")
    if parser.parse_args().check:
        check()
    else:
        record()


if __name__ == "__main__":
    main()
