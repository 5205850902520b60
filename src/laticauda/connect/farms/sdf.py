"""Reader of SDF files as FARMS uses them: links with poses, inertias and collision shapes; hinges and fixed joints.

As in FARMS, a link without an inertial has no mass, and the axis of a joint has the directions of
its child link. Sensors, plugins, friction and what is only seen are left out.
"""

import math
import xml.etree.ElementTree as ET
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from laticauda.connect.farms.bodies import (
    UNMOVED,
    Body,
    Hinge,
    Limits,
    Morphology,
    Placement,
    Solid,
    SolidKind,
    Vector,
    normalize,
    rotate_by_rpy,
)
from laticauda.connect.farms.mesh_points import read_vertices
from laticauda.connect.farms.trees import order_by_tree
from laticauda.values import RobotFileError
from laticauda.values.files import read_text

HINGES = ("revolute", "continuous")
"""Types of joints that bend."""
WORLD = "world"
"""Parent of what is fixed in space."""
MOMENTS = ("xx", "yy", "zz", "xy", "xz", "yz")
"""Axes of the moments of inertia."""
ENDLESS = 1e15
"""Angle from which on a limit is none [rad]."""
SOLID_OF_SHAPE: Mapping[str, SolidKind] = {
    "box": "box",
    "sphere": "ellipsoid",
    "ellipsoid": "ellipsoid",
    "cylinder": "cylinder",
    "capsule": "capsule",
}
"""Kinds of the shapes that have a size of their own, by their tags."""


class Joint(NamedTuple):
    """Joint as the file states it."""

    name: str
    kind: str
    parent: str
    child: str
    element: ET.Element


def read_sdf(path: str | Path) -> Morphology:
    """Read the first model of an SDF file.

    Args:
        path: Path of the file.

    Raises:
        RobotFileError: If it cannot be read, or says something that is not understood.
    """
    return _Reader(Path(path)).read()


class _Reader:
    """Reader of one file."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.remarks: list[str] = []

    def read(self) -> Morphology:
        """Read the file."""
        model = self._find_model()
        links = {str(link.get("name")): link for link in model.findall("link")}
        if not links:
            raise self._error("its model has no links")
        joints = self._read_joints(model, links)
        parents = {joint.child: joint.parent for joint in joints.values()}
        tree = order_by_tree(list(links), parents, self.path)
        if tree.loose:
            names = ", ".join(tree.loose)
            self.remarks.append(f"links that no joint ties to `{tree.names[0]}`: {names}")
        bodies = {name: self._read_body(name, links[name], joints.get(name)) for name in tree.names}
        name = model.get("name") or self.path.stem
        return Morphology(name=name, bodies=bodies, remarks=self.remarks)

    def _error(self, sentence: str) -> RobotFileError:
        return RobotFileError(f"{self.path}: {sentence}")

    def _find_model(self) -> ET.Element:
        try:
            root = ET.fromstring(read_text(self.path, RobotFileError))
        except ET.ParseError as failure:
            raise self._error(f"is not XML: {failure}") from None
        model = root.find(".//model")
        if root.tag != "sdf" or model is None:
            raise self._error(f"must be an SDF file with a model, but is <{root.tag}>")
        return model

    # ---- joints ----------------------------------------------------------------------------------

    def _read_joints(
        self,
        model: ET.Element,
        links: Mapping[str, ET.Element],
    ) -> dict[str, Joint]:
        """Return the joints between links, by their child."""
        joints: dict[str, Joint] = {}
        for element in model.findall("joint"):
            name = str(element.get("name"))
            parent = self._text(element, "parent")
            child = self._text(element, "child")
            if parent == WORLD:
                self.remarks.append(f"joint `{name}`, which fixes `{child}` in space")
                continue
            for link in (parent, child):
                if link not in links:
                    raise self._error(f"joint `{name}` names `{link}`, which is no link")
            if child in joints:
                raise self._error(f"link `{child}` is the child of two joints")
            joints[child] = Joint(
                name=name,
                kind=str(element.get("type")),
                parent=parent,
                child=child,
                element=element,
            )
        return joints

    def _read_hinge(
        self,
        joint: Joint,
        link: Placement,
    ) -> Hinge | None:
        """Return a hinge; None for a joint that is held."""
        if joint.kind not in HINGES:
            if joint.kind != "fixed":
                self.remarks.append(f"joint `{joint.name}` of type {joint.kind}: it is held")
            return None
        anchor = link.place(self._pose(joint.element)).position
        axis = joint.element.find("axis")
        if axis is None:
            raise self._error(f"joint `{joint.name}` must have an <axis>")
        direction = self._numbers(axis, "xyz", 3)
        if not np.any(direction):
            raise self._error(f"the axis of joint `{joint.name}` must not be 0 0 0")
        limits = self._read_limits(axis)
        return Hinge(
            name=joint.name,
            anchor=anchor,
            axis=normalize(link.rotation @ direction),
            lower=limits.low,
            upper=limits.high,
            stiffness=self._number(axis, "dynamics/spring_stiffness", 0.0),
            damping=self._number(axis, "dynamics/damping", 0.0),
        )

    def _read_limits(self, axis: ET.Element) -> Limits:
        """Return the angles between which a hinge bends; infinite ones beyond `ENDLESS`."""
        lower = self._number(axis, "limit/lower", -math.inf)
        upper = self._number(axis, "limit/upper", math.inf)
        if lower <= -ENDLESS:
            lower = -math.inf
        if upper >= ENDLESS:
            upper = math.inf
        return Limits(low=lower, high=upper)

    # ---- links -----------------------------------------------------------------------------------

    def _read_body(
        self,
        name: str,
        link: ET.Element,
        joint: Joint | None,
    ) -> Body:
        placement = self._pose(link)
        mass = 0.0
        center = placement.position
        inertia = np.zeros((3, 3))
        inertial = link.find("inertial")
        if inertial is not None:
            frame = placement.place(self._pose(inertial))
            mass = self._number(inertial, "mass", 0.0)
            if not 0.0 <= mass < math.inf:
                raise self._error(f"the mass of link `{name}` must be positive, got {mass:g} kg")
            center = frame.position
            inertia = frame.turn(self._read_inertia(inertial))
        hinge = None
        parent = None
        if joint is not None:
            hinge = self._read_hinge(joint, placement)
            parent = joint.parent
        return Body(
            name=name,
            parent=parent,
            hinge=hinge,
            placement=placement,
            mass=mass,
            center=center,
            inertia=inertia,
            solids=self._read_solids(link, placement),
        )

    def _read_inertia(self, inertial: ET.Element) -> np.ndarray:
        moments = [self._number(inertial, f"inertia/i{axes}", 0.0) for axes in MOMENTS]
        if not np.all(np.isfinite(moments)):
            raise self._error("moments of inertia must be finite")
        xx, yy, zz, xy, xz, yz = moments
        return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])

    def _read_solids(
        self,
        link: ET.Element,
        placement: Placement,
    ) -> Sequence[Solid]:
        solids: list[Solid] = []
        for collision in link.findall("collision"):
            frame = placement.place(self._pose(collision))
            for shape in collision.findall("geometry/*"):
                solid = self._read_solid(shape, frame)
                if solid is not None:
                    solids.append(solid)
        return solids

    def _read_solid(
        self,
        shape: ET.Element,
        frame: Placement,
    ) -> Solid | None:
        """Return a shape; None for one that has no size, or that cannot be read."""
        if shape.tag == "mesh":
            return self._read_mesh(shape, frame)
        size = self._read_half_size(shape)
        if size is None:
            return None
        return Solid(kind=SOLID_OF_SHAPE[shape.tag], placement=frame, half_size=size)

    def _read_half_size(self, shape: ET.Element) -> Vector | None:
        if shape.tag == "box":
            return 0.5 * self._numbers(shape, "size", 3)
        if shape.tag == "sphere":
            return np.full(3, self._numbers(shape, "radius", 1)[0])
        if shape.tag == "ellipsoid":
            return self._numbers(shape, "radii", 3)
        if shape.tag in ("cylinder", "capsule"):
            radius = float(self._numbers(shape, "radius", 1)[0])
            length = float(self._numbers(shape, "length", 1)[0])
            return np.array([radius, radius, 0.5 * length])
        return None

    def _read_mesh(
        self,
        shape: ET.Element,
        frame: Placement,
    ) -> Solid | None:
        file = self.path.parent / self._text(shape, "uri")
        try:
            vertices = read_vertices(file)
        except ValueError:
            vertices = None
        if vertices is None:
            self.remarks.append(f"mesh {file.name}: no OBJ or binary STL file that can be read")
            return None
        scale = np.ones(3)
        if shape.find("scale") is not None:
            scale = self._numbers(shape, "scale", 3)
        return Solid(
            kind="mesh",
            placement=frame,
            half_size=np.zeros(3),
            vertices=vertices * scale,
        )

    # ---- numbers ---------------------------------------------------------------------------------

    def _pose(self, element: ET.Element) -> Placement:
        """Return where an element is in what holds it."""
        pose = element.find("pose")
        if pose is None:
            return UNMOVED
        if pose.get("relative_to"):
            name = element.get("name") or element.tag
            raise self._error(
                f"the pose of `{name}` is relative to `{pose.get('relative_to')}`, which is not read; "
                "write it in the frame of the model (links) or of the child link (joints)"
            )
        numbers = self._numbers(element, "pose", 6)
        roll, pitch, yaw = numbers[3:].tolist()
        return Placement(numbers[:3], rotate_by_rpy(roll, pitch, yaw))

    def _text(
        self,
        element: ET.Element,
        tag: str,
    ) -> str:
        text = element.findtext(tag)
        if text is None or not text.strip():
            name = element.get("name") or element.tag
            raise self._error(f"`{name}` must have a <{tag}>")
        return text.strip()

    def _numbers(
        self,
        element: ET.Element,
        tag: str,
        count: int,
    ) -> np.ndarray:
        """Return a given number of finite numbers."""
        text = self._text(element, tag)
        name = element.get("name") or element.tag
        try:
            numbers = np.array(text.split(), dtype=float)
        except ValueError:
            numbers = np.empty(0)
        if numbers.size != count or not np.all(np.isfinite(numbers)):
            raise self._error(f"<{tag}> of `{name}` must hold {count} numbers, got {text!r}")
        return numbers

    def _number(
        self,
        element: ET.Element,
        tag: str,
        default: float,
    ) -> float:
        """Return a number, which may be infinite."""
        text = element.findtext(tag)
        if text is None:
            return default
        try:
            number = float(text)
        except ValueError:
            number = math.nan
        if math.isnan(number):
            raise self._error(f"<{tag}> must hold a number, got {text!r}")
        return number
