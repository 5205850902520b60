"""How far are the loads of a fin from those of an unsteady vortex lattice?

Question: a rigid rectangular plate of height h and chord c swims at u and heaves, pitches about its root, or both.
What do the kernels of the planar model give for mean thrust, side force and moment, by each law of the edge?

    python campaigns/edge_map.py                  # the table, ten seconds
    python campaigns/edge_map.py --figure docs/images/edge-map.png

`edge_map.csv` is the lattice's answer, to which nothing was fitted: vortex rings, harmonic in time, a straight wake,
full suction at the leading edge (thrust by the energy balance in the far wake), extrapolated in the number of rings.
rho = u = h = 1, z = Re[(a + s x) exp(i omega t)] with x aft from the root; `heave` a = 1, `pitchLE` s = 1, `swim` both,
a = 1 and s = -.6 i omega. Phases are those of complex amplitudes; the side force is positive along z. Errors of thrust
are relative to the lattice's thrust or, if that is larger, to a quarter of its power over u.

`edge_map_shapes.csv` is the same for swept, tapered and forked plates, and for plates that have another one, flat and
lower or as high, rigidly ahead of their root; `edge_lattice.py` makes it. Moments are about the root of the one behind.
"""

import argparse
import csv
from itertools import groupby
from pathlib import Path
from typing import Literal, NamedTuple

import numpy as np

from laticauda.models.planar import rows
from laticauda.models.planar.model import PlanarPlant
from laticauda.robot import CaudalFin, Module, Robot, Section, Water, load_robot
from laticauda.robot.silhouettes import outline_of_fin
from laticauda.water.fluid.lattice import Outline, PlateAhead

STORED = Path(__file__).with_suffix(".csv")
STORED_SHAPES = Path(__file__).with_name("edge_map_shapes.csv")
PHASES = 2.0 * np.pi * np.arange(16) / 16.0
"""Moments of a cycle; means of squares are exact."""
SMALL = 1e-9
"""Mass and size of all that is not the plate."""
Edge = Literal["none", "elongated", "finite-span"]


Corners = tuple[tuple[float, float], ...]


class Shape(NamedTuple):
    """A plate 1 m high."""

    chord: float
    """Its length, from the root to the end of its tips [m]."""
    corners: Corners | None = None
    """Of its upper half; None: a rectangle [m]."""
    ahead: PlateAhead | None = None
    """What is ahead of its root; None: nothing."""


def fin_of_the_fish() -> Corners:
    """Return the silhouette of `tendon-fish`, 1 m high."""
    fin = load_robot("tendon-fish").caudal_fin
    assert fin is not None
    assert fin.silhouette is not None
    return tuple((x / fin.height, z / fin.height) for x, z in fin.silhouette)


FISH = fin_of_the_fish()
TRIANGLE = ((0.0, 0.0), (0.6, 0.5), (0.6, 0.0))
SWEPT = ((0.0, 0.0), (0.25, 0.5), (0.4, 0.5), (0.25, 0.0))
TAPERED = ((0.0, 0.0), (0.1, 0.5), (0.3, 0.5), (0.5, 0.0))
SHAPES = {
    "fish": Shape(max(x for x, _ in FISH), FISH),
    "triangle": Shape(0.6, TRIANGLE),
    "swept": Shape(0.4, SWEPT),
    "tapered": Shape(0.5, TAPERED),
    "fish behind 0.4": Shape(max(x for x, _ in FISH), FISH, PlateAhead(0.72, 0.4)),
    "0.18 behind 0.4": Shape(0.18, None, PlateAhead(0.72, 0.4)),
    "0.2 behind 0.25": Shape(0.2, None, PlateAhead(1.0, 0.25)),
    "0.2 behind 0.5": Shape(0.2, None, PlateAhead(1.0, 0.5)),
    "0.5 behind 0.5": Shape(0.5, None, PlateAhead(1.0, 0.5)),
    "0.5 behind 1": Shape(0.5, None, PlateAhead(1.0, 1.0)),
    "2 behind 0.6": Shape(2.0, None, PlateAhead(2.0, 0.6)),
}
"""Plates by their chord, and the height of what is ahead."""


def outline_of(shape: Shape) -> Outline:
    """Return the upper half of a plate, as the lattice needs it."""
    fin = CaudalFin(length=shape.chord, height=1.0, opening_length=0.0, silhouette=shape.corners)
    return outline_of_fin(fin)


class Point(NamedTuple):
    """The errors at one point of the map, relative."""

    aspect: float
    """h/c [-]."""
    frequency: float
    """omega h/u [-]."""
    motion: str
    """heave, pitchLE or swim [-]."""
    thrust: float
    """Error of the mean thrust [-]."""
    side: float
    """Error of the side force's amplitude [-]."""
    moment: float
    """Error of the moment's amplitude [-]."""


class RigidPlate:
    """A plate 1 m high in water of 1 kg/m^3 whose loads are those of the kernels: the fin of a robot without a body.

    Args:
        shape: The plate.
        edge: Law of its trailing edge.
    """

    def __init__(self, shape: Shape, edge: Edge = "finite-span") -> None:
        fin = CaudalFin(
            length=shape.chord,
            height=1.0,
            opening_length=0.0,
            thickness=SMALL,
            density=1e-3,
            silhouette=shape.corners,
        )
        ahead = shape.ahead
        length, height = ahead or (1e-3, 2e-6)
        section = Section(half_height=0.5 * height, half_width=0.05 * height)
        link = Module(length=length, mass=SMALL, inertia=SMALL, section=section)
        water = Water(
            density=1.0,
            tangential_friction=0.0,
            normal_drag=0.0,
            added_mass=1.0,
            plate_drag=None if ahead is None else 0.0,
            plate_added_mass=None if ahead is None else 1.0,
            added_mass_form="kirchhoff",
            trailing_edge=edge,
            rotational="strip",
        )
        robot = Robot(name="plate", modules=(link,), caudal_fin=fin)
        self.plant = PlanarPlant(robot=robot, environment=water)
        self.template = self.plant.layout.template
        self.body = self.template[rows.HEADER_ROWS :][: rows.BODY_ROWS]

    def loads(self, w: float, turning: float, memory: float) -> np.ndarray:
        """Return force along and to the left, moment about the root, dz/dt: at u = 1, without accelerations."""
        S = self.template.copy()  # noqa: N806 - as in the kernels
        S[rows.VX] = 1.0
        S[rows.VY] = w + turning * self.body[rows.FIRST_MOMENT_SHARE]
        S[rows.HEADING_RATE] = turning
        S[rows.EDGE_MEMORY] = memory
        layout = self.plant.layout
        chain = layout.first_strip, layout.first_plate, np.array([False])
        kernels = self.plant.kernels_of(1)
        kernels.evaluate(S, layout.n_bodies, *chain, layout.tail_link, layout.has_extras)
        b = rows.HEADER_ROWS
        along, across, moment = -S[[b + rows.P1, b + rows.P2, b + rows.P0]]
        return np.array((along, across, moment, S[rows.EDGE_MEMORY_RATE]))

    def respond(
        self, omega: float, heave: complex, slope: complex
    ) -> tuple[float, complex, complex]:
        """Return mean thrust, and the complex amplitudes of side force and moment about the root, of a motion."""
        cycle = np.exp(1j * PHASES)

        def in_time(amplitude: complex) -> np.ndarray:
            return (amplitude * cycle).real

        w_root = 1j * omega * heave + slope
        turning = -1j * omega * slope
        w_edge = w_root + turning * self.template[rows.WAKE_POSITION]
        memory = w_edge / (1.0 + 1j * omega * self.template[rows.EDGE_LAG])
        moments = zip(in_time(w_root), in_time(turning), in_time(memory), strict=True)
        along, across, moment, memory_rate = np.array([self.loads(*now) for now in moments]).T
        if self.template[rows.EDGE_LAG] > 0.0:
            np.testing.assert_allclose(
                memory_rate, in_time(1j * omega * memory), atol=1e-9 * (1.0 + omega**2)
            )
        # What accelerations add, by the kernels' own inertia; its axes turn while it swims at 1 m/s.
        sway = in_time(1j * omega * w_root + turning)
        spin = in_time(1j * omega * turning)
        coupling = self.body[rows.COUPLING]
        across = across - self.body[rows.MASS_N] * sway - coupling * spin
        moment = moment - coupling * sway - self.body[rows.INERTIA] * spin
        thrust = float(np.mean(along + across * in_time(slope)))
        to_amplitude = 2.0 * np.conj(cycle) / PHASES.size
        # The lattice's moment is x times the side force: a turn to the right.
        return thrust, complex(across @ to_amplitude), complex(-moment @ to_amplitude)


def motion_of(name: str, omega: float) -> tuple[complex, complex]:
    """Return heave and slope of a motion of the map."""
    if name == "heave":
        return 1.0, 0.0
    if name == "pitchLE":
        return 0.0, 1.0
    return 1.0, -0.6j * omega


def errors(edge: Edge = "finite-span") -> list[Point]:
    """Return the errors of a law at all points of the map."""
    lattice = list(csv.DictReader(STORED.read_text(encoding="utf-8").splitlines()))
    points: list[Point] = []
    for aspect, group in groupby(lattice, key=lambda row: float(row["h_over_c"])):
        plate = RigidPlate(Shape(1.0 / aspect), edge)
        points += [compare(plate, aspect, row, "moment_LE") for row in group]
    return points


def errors_of_shapes(*, behind: bool, edge: Edge = "finite-span") -> list[Point]:
    """Return the errors of a law for plates of other shapes, or for plates behind other plates."""
    lattice = csv.DictReader(STORED_SHAPES.read_text(encoding="utf-8").splitlines())
    points: list[Point] = []
    for name, group in groupby(lattice, key=lambda row: row["shape"]):
        shape = SHAPES[name]
        if (shape.ahead is not None) == behind:
            plate = RigidPlate(shape, edge)
            aspect = 1.0 / shape.chord
            points += [compare(plate, aspect, row, "moment_root") for row in group]
    return points


def compare(plate: RigidPlate, aspect: float, row: dict[str, str], moment_name: str) -> Point:
    """Return the errors of a plate at one point of the lattice's answer."""
    omega = float(row["omega_h_over_u"])
    thrust, side, moment = plate.respond(omega, *motion_of(row["motion"], omega))
    given = float(row["thrust_mean"])
    size = max(abs(given), 0.25 * abs(float(row["power_in_mean"])))
    return Point(
        aspect=aspect,
        frequency=omega,
        motion=row["motion"],
        thrust=abs(thrust - given) / size,
        side=relative_error(side, row, "side"),
        moment=relative_error(moment, row, moment_name),
    )


def relative_error(value: complex, row: dict[str, str], name: str) -> float:
    """Return the error of a complex amplitude."""
    size = float(row[f"{name}_amp"])
    phase = np.deg2rad(float(row[f"{name}_phase_deg"]))
    return float(abs(value - size * np.exp(1j * phase)) / size)


def figure(path: str) -> None:
    """Draw the error of the thrust over the map, by `elongated` and by `finite-span`."""
    from laticauda.show.figures import save_figure, style

    drawn = style.new_figure(style.DOUBLE_COLUMN, 0.42 * style.DOUBLE_COLUMN)
    axes = drawn.subplots(1, 2, sharey=True)
    edges: tuple[Edge, ...] = ("elongated", "finite-span")
    marks = {"heave": "o", "pitchLE": "s", "swim": "^"}
    labels = {"heave": "heave", "pitchLE": "pitch about the root", "swim": "both"}
    for ax, edge in zip(axes, edges, strict=True):
        points = errors(edge)
        for k, (motion, mark) in enumerate(marks.items()):
            chosen = [point for point in points if point.motion == motion]
            place = [point.aspect * 1.06 ** (k - 1) for point in chosen]
            size = [max(100.0 * point.thrust, 0.01) for point in chosen]
            ax.plot(place, size, mark, markersize=2.5, markerfacecolor="none", label=labels[motion])
        mean = 100.0 * np.mean([point.thrust for point in points])
        ax.axhline(10.0, color=style.INK, linewidth=0.6, linestyle=":")
        ax.set_xscale("log")
        ax.set_yscale("log")
        ax.set_title(f"{edge}: {mean:.3g} % on average", fontsize="medium")
        label = "error of the mean thrust [%]" if edge == "elongated" else ""
        style.style_axes(ax, xlabel="height over chord, h/c", ylabel=label)
    style.add_legend(axes[1], loc="upper left")
    save_figure(drawn, path)


def main() -> None:
    """Print the table, or draw."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--figure")
    options = parser.parse_args()
    edges: tuple[Edge, ...] = ("elongated", "finite-span")
    print(
        f"{'law':20} {'thrust: mean':>12} {'most':>6}   side: mean, most   moment: mean, most [%]"
    )
    tables = {edge: errors(edge) for edge in edges}
    tables["finite-span, shaped"] = errors_of_shapes(behind=False)
    tables["finite-span, behind"] = errors_of_shapes(behind=True)
    for name, points in tables.items():
        table = 100.0 * np.array([point[3:] for point in points])
        (thrust, side, moment), most = table.mean(axis=0), table.max(axis=0)
        print(
            f"{name:20} {thrust:12.1f} {most[0]:6.0f} {side:8.1f} {most[1]:8.0f} {moment:12.1f} {most[2]:8.0f}"
        )
    if options.figure:
        figure(options.figure)


if __name__ == "__main__":
    main()
