"""Shapes on the bodies of a robot in a MuJoCo model, for display and for collision, and their materials.

Shapes are massless; the bodies carry the mass. Collision shapes are in a group of their own, hidden
in MuJoCo's viewer by default.
"""

from pathlib import Path
from typing import Any, NamedTuple

from laticauda.models.spatial.bodies import build_fin_bodies
from laticauda.models.spatial.fin_shapes import Box, build_fin_plate, build_fin_rods
from laticauda.models.spatial.module_shapes import Builder, build_hull, choose_builders
from laticauda.robot import CaudalFin, Module, Robot
from laticauda.values import load_mujoco

SEEN = 1
"""Geom group of the shapes that are displayed."""
HULL = 3
"""Geom group of the collision shapes."""
TOUCHES_WORLD: dict[str, Any] = {"contype": 1, "conaffinity": 0}
"""Modules collide with the world but not with each other: their joint limits keep them apart."""
UNTOUCHED: dict[str, Any] = {"contype": 0, "conaffinity": 0, "group": SEEN, "mass": 0.0}
"""Properties of a shape that is only displayed."""
BELLOWS = 0.87
"""Size of the bellows between two housings, relative to the module [-]."""


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


def add_materials(model: Any) -> None:
    """Add the materials of the shapes to a model."""
    for name, material in MATERIALS.items():
        model.add_material(
            name=name,
            rgba=material.color,
            specular=material.shine,
            shininess=0.5 * material.shine + 0.2,
        )


def add_shapes(model: Any, robot: Robot, files: list[Path], *, visuals: bool) -> None:
    """Add shapes to the bodies of a model.

    Args:
        model: A `MjSpec` with the robot's bodies.
        robot: The robot to which the bodies belong.
        files: One mesh file per module, or none to use the shapes generated here.
        visuals: Whether to add visual shapes in addition to the collision shapes.
    """
    library = _MeshLibrary(model)
    for i, module in enumerate(robot.modules):
        body = model.body(f"module_{i}")
        is_head = i == robot.n_links - 1
        if files:
            hull = library.add_file(files[i])
        else:
            hull = library.add_built("hull", module, build_hull)
        _add_hull(body, f"module_{i}_hull", hull)
        if visuals and files:
            _add_visible_mesh(body, hull, choose_material(is_head=is_head))
        elif visuals:
            for material, build in choose_builders(is_head=is_head).items():
                mesh = library.add_built(material, module, build)
                _add_visible_mesh(body, mesh, material)
            if i > 0:
                _add_bellows(body, module)
    if robot.caudal_fin is not None:
        _add_fin(model, robot.caudal_fin, visuals=visuals)


def choose_material(*, is_head: bool) -> str:
    """Return the material of a module that is shown in one piece."""
    if is_head:
        return "head"
    return "housing"


def _add_hull(body: Any, name: str, mesh: str) -> None:
    body.add_geom(
        name=name,
        type=load_mujoco().mjtGeom.mjGEOM_MESH,
        meshname=mesh,
        group=HULL,
        **TOUCHES_WORLD,
    )


def _add_visible_mesh(body: Any, mesh: str, material: str) -> None:
    kind = load_mujoco().mjtGeom.mjGEOM_MESH
    body.add_geom(type=kind, meshname=mesh, material=material, **UNTOUCHED)


def _add_bellows(body: Any, module: Module) -> None:
    """Add the bellows over the joint at the tail side of a module."""
    height = BELLOWS * module.section.half_height
    width = BELLOWS * module.section.half_width
    kind = load_mujoco().mjtGeom.mjGEOM_ELLIPSOID
    body.add_geom(type=kind, size=(width, width, height), material="bellows", **UNTOUCHED)


class _MeshLibrary:
    """The meshes of one model, each stored once."""

    def __init__(self, model: Any) -> None:
        self._model = model
        self._names: dict[object, str] = {}

    def add_built(self, kind: str, module: Module, build: Builder) -> str:
        """Return the name of a mesh that all modules of the same size share."""
        key = (kind, module.length, module.section)
        if key in self._names:
            return self._names[key]
        n_of_kind = sum(kind in name for name in self._names.values())
        name = f"{kind}_{n_of_kind}"
        self._names[key] = name
        mesh = build(module)
        vertices = mesh.vertices.ravel().tolist()
        faces = mesh.faces.ravel().tolist()
        self._model.add_mesh(name=name, uservert=vertices, userface=faces)
        return name

    def add_file(self, path: Path) -> str:
        """Return the name of the mesh from a file."""
        key = path.resolve()
        if key not in self._names:
            name = f"file_{len(self._names)}"
            self._names[key] = name
            self._model.add_mesh(name=name, file=str(key))
        return self._names[key]


def _add_fin(model: Any, fin: CaudalFin, *, visuals: bool) -> None:
    for fin_body, piece in zip(build_fin_bodies(fin), fin.pieces, strict=True):
        body = model.body(fin_body.name)
        plate = build_fin_plate(fin, piece)
        if plate is not None:
            _add_box(body, plate, name=f"{fin_body.name}_hull", group=HULL, **TOUCHES_WORLD)
        if not visuals:
            continue
        if plate is not None:
            _add_box(body, plate, name=f"{fin_body.name}_shape", material="fin", **UNTOUCHED)
        for rod in build_fin_rods(fin, piece):
            _add_box(body, rod, material="fin", **UNTOUCHED)


def _add_box(body: Any, box: Box, **properties: Any) -> None:
    kind = load_mujoco().mjtGeom.mjGEOM_BOX
    body.add_geom(type=kind, size=box.half_size, pos=box.position, **properties)
