"""Shapes on the bodies of a robot, for display and for collision.

Shapes are massless; the bodies carry the mass. Collision shapes are in group 3, hidden in MuJoCo's
viewer by default.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float, Int

from laticauda.models.spatial.bodies import fin_bodies
from laticauda.robot import CaudalFin, Module, Piece, Robot
from laticauda.values import BadArgument, load_mujoco, write

SEEN, HULL = 1, 3  # geom groups
# Modules collide with the world but not with each other: their joint limits keep them apart.
TOUCHES_WORLD: dict[str, Any] = {"contype": 1, "conaffinity": 0}
UNTOUCHED: dict[str, Any] = {"contype": 0, "conaffinity": 0, "group": SEEN, "mass": 0.0}
SHORTEST = 1e-3  # minimum length of a shape [m]
SUFFIXES = (".stl", ".obj")
PITCH = 1.64  # length of one housing in half heights, as on Mamba's modules
GAP = 0.012  # gap between two housings, filled by the bellows [m]
CORE, BELLOWS, PROUD = (
    0.84,
    0.87,
    1.012,
)  # sizes of parts inside and outside a housing, relative to the housing
AROUND = 20  # vertices around a section, enough to look smooth
NOSE = 1.5  # length of the rounded front, in half heights


class Material(NamedTuple):
    """What a shape is made of."""

    color: tuple[float, float, float, float]
    """Red, green, blue and opacity [-]."""
    shine: float
    """How much it reflects [-]."""


MATERIALS = {
    "housing": Material((0.075, 0.085, 0.1, 1.0), 0.45),
    "band": Material((1.0, 0.62, 0.05, 1.0), 0.25),
    "bellows": Material((0.16, 0.17, 0.18, 1.0), 0.05),
    "head": Material((0.95, 0.3, 0.04, 1.0), 0.45),
    "collar": Material((0.03, 0.035, 0.045, 1.0), 0.45),
    "fin": Material((0.13, 0.15, 0.17, 1.0), 0.4),
}
"""What the shapes of a robot are made of."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Mesh:
    """A closed triangle mesh, with faces counterclockwise when seen from outside."""

    vertices: Float[np.ndarray, "n_vertices 3"]
    """Coordinates [m]."""
    faces: Int[np.ndarray, "n_faces 3"]
    """Three vertex indices per face [-]."""


def loft(stations: Sequence[tuple[float, float, float]], *, around: int = AROUND) -> Mesh:
    """Return a surface through elliptic sections centered on the x axis, closed at both ends.

    Args:
        stations: Position x, half height and half width of each section [m], with x nondecreasing.
        around: Number of vertices per section.
    """
    angle = np.linspace(0.0, 2.0 * np.pi, around, endpoint=False)
    side, up = np.cos(angle), np.sin(angle)
    rings = [np.stack((np.full(around, x), b * side, a * up), axis=1) for x, a, b in stations]
    ends = [(stations[0][0], 0.0, 0.0), (stations[-1][0], 0.0, 0.0)]
    first = np.arange(around)
    second = (first + 1) % around
    faces: list[np.ndarray] = []
    for k in range(len(stations) - 1):
        low, high = k * around, (k + 1) * around
        faces.append(np.stack((low + first, low + second, high + second), axis=1))
        faces.append(np.stack((low + first, high + second, high + first), axis=1))
    last, n = (len(stations) - 1) * around, len(stations) * around
    faces.append(np.stack((np.full(around, n), second, first), axis=1))
    faces.append(np.stack((np.full(around, n + 1), last + first, last + second), axis=1))
    return Mesh(vertices=np.vstack([*rings, ends]), faces=np.vstack(faces))


def joined(*meshes: Mesh) -> Mesh:
    """Merge several meshes into one."""
    shifts = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes[:-1])])
    faces = [mesh.faces + shift for mesh, shift in zip(meshes, shifts, strict=True)]
    return Mesh(vertices=np.vstack([mesh.vertices for mesh in meshes]), faces=np.vstack(faces))


def check_meshes(meshes: Iterable[str | Path], n_links: int) -> list[Path]:
    """Return the paths of mesh files, after checking that there is none, or one readable file per module.

    Raises:
        ValueError: If the number of files is wrong, or a file is missing or of another type.
    """
    files = [Path(file) for file in meshes]
    if files and len(files) != n_links:
        raise BadArgument(
            "meshes", f"must be one file per module ({n_links}) or none, got {len(files)}"
        )
    for file in files:
        if file.suffix.lower() not in SUFFIXES or not file.is_file():
            raise BadArgument("meshes", f"must be existing .stl or .obj files, got {file}")
    return files


def copied(files: Sequence[Path], beside: Path) -> list[str]:
    """Copy mesh files into a folder next to a model's file, and return their paths relative to that file.

    Args:
        files: The mesh files.
        beside: The model's file.
    """
    folder = beside.with_name(f"{beside.stem}_meshes")
    places: dict[Path, str] = {}
    for file in files:
        source = file.resolve()
        if source not in places:
            folder.mkdir(exist_ok=True)
            name = f"{len(places)}_{file.name}"  # files in different folders may have the same name
            write(folder / name, source.read_bytes())
            places[source] = f"{folder.name}/{name}"
    return [places[file.resolve()] for file in files]


def add_materials(model: Any) -> None:
    """Add the materials of the shapes to a model."""
    for name, (color, shine) in MATERIALS.items():
        model.add_material(name=name, rgba=color, specular=shine, shininess=0.5 * shine + 0.2)


def add_shapes(model: Any, robot: Robot, files: list[Path], *, visuals: bool) -> None:
    """Add shapes to the bodies of a model.

    Args:
        model: A `MjSpec` with the robot's bodies.
        robot: The robot to which the bodies belong.
        files: One mesh file per module, or none to use the shapes generated here.
        visuals: Whether to add visual shapes in addition to the collision shapes.
    """
    library, kind = _Library(model), load_mujoco().mjtGeom
    for i, module in enumerate(robot.modules):
        body, is_head = model.body(f"module_{i}"), i == robot.n_links - 1
        mesh = library.file(files[i]) if files else library.made("hull", module, hull)
        body.add_geom(
            name=f"module_{i}_hull",
            type=kind.mjGEOM_MESH,
            meshname=mesh,
            group=HULL,
            **TOUCHES_WORLD,
        )
        if not visuals:
            continue
        looks = {"head" if is_head else "housing": mesh}
        if not files:
            looks = {
                what: library.made(what, module, build)
                for what, build in mesh_builders(is_head=is_head).items()
            }
        for material, mesh in looks.items():
            body.add_geom(type=kind.mjGEOM_MESH, meshname=mesh, material=material, **UNTOUCHED)
        if i and not files:  # the bellows over the joint on the tail side
            high, wide = (
                BELLOWS * half for half in (module.section.half_height, module.section.half_width)
            )
            body.add_geom(
                type=kind.mjGEOM_ELLIPSOID, size=(wide, wide, high), material="bellows", **UNTOUCHED
            )
    if robot.caudal_fin is not None:
        _add_fin(model, robot.caudal_fin, visuals=visuals)


class _Library:
    """The meshes of one model, each stored once."""

    def __init__(self, model: Any) -> None:
        self._model = model
        self._names: dict[object, str] = {}

    def made(self, kind: str, module: Module, build: Callable[[Module], Mesh]) -> str:
        """Return the name of a shape that all modules of the same size share."""
        key = kind, module.length, module.section
        if key not in self._names:
            self._names[key] = f"{kind}_{sum(kind in name for name in self._names.values())}"
            mesh = build(module)
            vertices, faces = mesh.vertices.ravel().tolist(), mesh.faces.ravel().tolist()
            self._model.add_mesh(name=self._names[key], uservert=vertices, userface=faces)
        return self._names[key]

    def file(self, path: Path) -> str:
        """Return the name of the mesh from a file."""
        key = path.resolve()
        if key not in self._names:
            self._names[key] = f"file_{len(self._names)}"
            self._model.add_mesh(name=self._names[key], file=str(key))
        return self._names[key]


def mesh_builders(*, is_head: bool) -> dict[str, Callable[[Module], Mesh]]:
    """Return the functions that build a module's parts, by material."""
    return (
        {"head": build_head, "collar": collar} if is_head else {"housing": housing, "band": bands}
    )


def hull(module: Module) -> Mesh:
    """Return the module's shape in the models: an elliptic cylinder."""
    a, b = module.section.half_height, module.section.half_width
    return loft([(0.0, a, b), (module.length, a, b)], around=24)


def housing(module: Module) -> Mesh:
    """Return a row of housings with beveled ends, and the core that holds them together."""
    rings: list[tuple[float, float]] = []
    for start, stop in _housings(module):
        bevel = 0.08 * (stop - start)
        rings += [
            (start, CORE),
            (start, 0.9),
            (start + bevel, 1.0),
            (stop - bevel, 1.0),
            (stop, 0.9),
            (stop, CORE),
        ]
    return _around(module, rings)


def bands(module: Module) -> Mesh:
    """Return a band around every housing."""
    return joined(
        *(_band(module, start, stop - start, 0.40, 0.62) for start, stop in _housings(module))
    )


def build_head(module: Module) -> Mesh:
    """Return a housing with a rounded front."""
    start, stop = 0.5 * min(GAP, 0.2 * module.length), module.length
    nose = min(NOSE * module.section.half_height, 0.75 * (stop - start))
    turns = np.linspace(0.0, 0.5 * np.pi, 15)
    front = [
        (stop - nose * (1.0 - float(np.sin(turn))), max(float(np.cos(turn)), 0.0) ** 0.8)
        for turn in turns
    ]
    return _around(module, [(start, 0.9), (start + 0.06 * (stop - start), 1.0), *front])


def collar(module: Module) -> Mesh:
    """Return the dark band around the neck of the head."""
    return _band(module, 0.0, module.length, 0.16, 0.26)


def _band(module: Module, start: float, length: float, low: float, high: float) -> Mesh:
    """Return a band around a housing, between two fractions of its length [m]."""
    low, high = start + low * length, start + high * length
    return _around(module, [(low, 0.9), (low, PROUD), (high, PROUD), (high, 0.9)])


def _around(module: Module, rings: list[tuple[float, float]]) -> Mesh:
    """Return a surface through sections at these positions [m], each scaling the module's own by a factor."""
    a, b = module.section.half_height, module.section.half_width
    return loft([(x, scale * a, scale * b) for x, scale in rings])


def _housings(module: Module) -> list[tuple[float, float]]:
    """Return where the housings of a module begin and end [m]; their number follows Mamba's proportions."""
    n = max(1, round(module.length / (PITCH * module.section.half_height)))
    gap = min(GAP, 0.2 * module.length / n)
    pitch = module.length / n
    return [(k * pitch + 0.5 * gap, (k + 1) * pitch - 0.5 * gap) for k in range(n)]


class Box(NamedTuple):
    """A box-shaped part of the fin, in the frame of its piece."""

    half_size: tuple[float, float, float]
    """Half size along x, y and z [m]."""
    position: tuple[float, float, float]
    """Position of its center [m]."""


def build_fin_plate(fin: CaudalFin, piece: Piece) -> Box | None:
    """Return the part of a piece of the fin that lies behind the opening, or None if there is none."""
    begin = max(_opening(fin), piece.begin)
    return _box(fin, piece, begin, piece.end, 0.0, 0.5) if begin < piece.end else None


def rods(fin: CaudalFin, piece: Piece) -> list[Box]:
    """Return a piece's part of the two rods that hold the plate, above and below the opening."""
    end = min(_opening(fin), piece.end)
    return [
        _box(fin, piece, piece.begin, end, 0.4 * sign, 0.06)
        for sign in (-1.0, 1.0)
        if piece.begin < end
    ]


def _opening(fin: CaudalFin) -> float:
    """Return the visible length of the opening [m]: 0 if it is closed, or too short for a shape."""
    return 0.0 if fin.opening == "closed" or fin.opening_length < SHORTEST else fin.opening_length


def _box(fin: CaudalFin, piece: Piece, begin: float, end: float, up: float, half: float) -> Box:
    """Return the box from `begin` to `end` behind the root; `up` and `half` are fractions of the fin's height."""
    half_size = (0.5 * (end - begin), 0.5 * fin.thickness, half * fin.height)
    return Box(half_size, (piece.begin - 0.5 * (begin + end), 0.0, up * fin.height))


def _add_fin(model: Any, fin: CaudalFin, *, visuals: bool) -> None:
    box = load_mujoco().mjtGeom.mjGEOM_BOX
    for body, piece in zip(fin_bodies(fin), fin.pieces, strict=True):
        there, behind = model.body(body.name), build_fin_plate(fin, piece)
        if behind is not None:
            size, pos = behind
            there.add_geom(
                name=f"{body.name}_hull", group=HULL, type=box, size=size, pos=pos, **TOUCHES_WORLD
            )
            if visuals:
                name = f"{body.name}_shape"
                there.add_geom(name=name, material="fin", type=box, size=size, pos=pos, **UNTOUCHED)
        for size, pos in rods(fin, piece) if visuals else ():
            there.add_geom(material="fin", type=box, size=size, pos=pos, **UNTOUCHED)
