"""Reader of MJCF files, as FARMS writes them of an experiment: MuJoCo compiles the file and says what is in it.

The file may hold an arena too: the animal or robot is the tree of bodies with the most hinges.
"""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from laticauda.connect.farms.bodies import (
    Body,
    Hinge,
    Morphology,
    Placement,
    Solid,
)
from laticauda.values import RobotFileError, load_mujoco
from laticauda.values.files import read_content


def read_mjcf(path: str | Path) -> Morphology:
    """Read the bodies of an MJCF file.

    Args:
        path: Path of the file.

    Raises:
        RobotFileError: If it cannot be read, or holds no hinge.
    """
    read_content(path, RobotFileError)
    return _Reader(Path(path), load_mujoco()).read()


class _Reader:
    """Reader of one file."""

    def __init__(
        self,
        path: Path,
        mujoco: Any,
    ) -> None:
        """Compile the file."""
        self.path = path
        self.mujoco = mujoco
        self.remarks: list[str] = []
        try:
            self.model: Any = mujoco.MjModel.from_xml_path(str(path))
        except ValueError as failure:
            first_line = str(failure).strip().splitlines()[0]
            raise RobotFileError(f"{path}: MuJoCo refuses it: {first_line}") from None
        self.data: Any = mujoco.MjData(self.model)
        self.data.qpos[:] = self.model.qpos0
        mujoco.mj_kinematics(self.model, self.data)

    def read(self) -> Morphology:
        """Read the bodies."""
        model = self.model
        hinges = self._find_hinges()
        roots = [int(model.body_rootid[model.jnt_bodyid[joint]]) for joint in hinges.values()]
        if not roots:
            raise RobotFileError(f"{self.path}: has no hinges, so there is nothing that bends")
        root = max(set(roots), key=roots.count)
        numbers = [number for number in range(model.nbody) if model.body_rootid[number] == root]
        arena = [number for number in range(1, model.nbody) if number not in numbers]
        if arena:
            listed = ", ".join(self._name_of(number) for number in arena)
            self.remarks.append(f"bodies that are not the animal's: {listed}")
        bodies = [self._read_body(number, root, hinges) for number in numbers]
        return Morphology(
            name=self.path.stem,
            bodies={body.name: body for body in bodies},
            remarks=self.remarks,
        )

    def _find_hinges(self) -> dict[int, int]:
        """Return the numbers of the hinges, by the numbers of their bodies."""
        hinges: dict[int, int] = {}
        for joint in range(self.model.njnt):
            kind = self.model.jnt_type[joint]
            body = int(self.model.jnt_bodyid[joint])
            name = self.model.joint(joint).name
            if kind == self.mujoco.mjtJoint.mjJNT_FREE:
                continue
            if kind != self.mujoco.mjtJoint.mjJNT_HINGE:
                self.remarks.append(f"joint `{name}`, which is no hinge: it is held")
            elif body in hinges:
                self.remarks.append(f"joint `{name}`, the second one of its body: it is held")
            else:
                hinges[body] = joint
        return hinges

    def _read_body(
        self,
        number: int,
        root: int,
        hinges: Mapping[int, int],
    ) -> Body:
        """Return a body in the frame of the world."""
        model, data = self.model, self.data
        parent = None
        hinge = None
        if number != root:
            parent = self._name_of(int(model.body_parentid[number]))
        if number != root and number in hinges:
            hinge = self._read_hinge(hinges[number])
        principal_axes = data.ximat[number].reshape(3, 3)
        principal_moments = np.diag(model.body_inertia[number])
        return Body(
            name=self._name_of(number),
            parent=parent,
            hinge=hinge,
            placement=_placement(data.xpos[number], data.xmat[number]),
            mass=float(model.body_mass[number]),
            center=data.xipos[number].copy(),
            inertia=principal_axes @ principal_moments @ principal_axes.T,
            solids=self._read_solids(number),
        )

    def _name_of(self, number: int) -> str:
        """Return the name of a body, or one of our own."""
        return self.model.body(number).name or f"body_{number}"

    def _read_hinge(self, number: int) -> Hinge:
        """Return a hinge in the frame of the world."""
        joint = self.model.joint(number)
        lower = -math.inf
        upper = math.inf
        if self.model.jnt_limited[number]:
            lower, upper = joint.range.tolist()
        return Hinge(
            name=joint.name or f"joint_{number}",
            anchor=self.data.xanchor[number].copy(),
            axis=self.data.xaxis[number].copy(),
            lower=lower,
            upper=upper,
            stiffness=float(joint.stiffness.flat[0]),
            damping=float(joint.damping.flat[0]),
        )

    # ---- shapes ----------------------------------------------------------------------------------

    def _read_solids(self, number: int) -> Sequence[Solid]:
        """Return the shapes of a body that touch something; those that are only seen do not."""
        model = self.model
        first = int(model.body_geomadr[number])
        solids: list[Solid] = []
        for geom in range(first, first + int(model.body_geomnum[number])):
            is_seen_only = not model.geom_contype[geom] and not model.geom_conaffinity[geom]
            solid = None
            if not is_seen_only:
                solid = self._read_solid(geom)
            if solid is not None:
                solids.append(solid)
        return solids

    def _read_solid(self, geom: int) -> Solid | None:
        """Return a shape; None for one without a size, such as a plane."""
        model, data, kinds = self.model, self.data, self.mujoco.mjtGeom
        frame = _placement(data.geom_xpos[geom], data.geom_xmat[geom])
        kind = model.geom_type[geom]
        size = model.geom_size[geom].astype(float)
        radius_and_length = np.array([size[0], size[0], size[1]])
        if kind == kinds.mjGEOM_MESH:
            vertices = self._vertices_of(int(model.geom_dataid[geom]))
            return Solid(
                kind="mesh",
                placement=frame,
                half_size=size,
                vertices=vertices,
            )
        if kind == kinds.mjGEOM_BOX:
            return Solid(kind="box", placement=frame, half_size=size)
        if kind == kinds.mjGEOM_ELLIPSOID:
            return Solid(kind="ellipsoid", placement=frame, half_size=size)
        if kind == kinds.mjGEOM_SPHERE:
            return Solid(kind="ellipsoid", placement=frame, half_size=np.full(3, size[0]))
        if kind == kinds.mjGEOM_CYLINDER:
            return Solid(kind="cylinder", placement=frame, half_size=radius_and_length)
        if kind == kinds.mjGEOM_CAPSULE:
            return Solid(kind="capsule", placement=frame, half_size=radius_and_length)
        return None

    def _vertices_of(self, number: int) -> np.ndarray:
        """Return the vertices of a mesh in the frame of its shape [m]."""
        model = self.model
        first = int(model.mesh_vertadr[number])
        count = int(model.mesh_vertnum[number])
        vertices = model.mesh_vert[first : first + count]
        return vertices.astype(float)


def _placement(position: np.ndarray, rotation: np.ndarray) -> Placement:
    """Return a frame of MuJoCo's data, which change later."""
    return Placement(position.copy(), rotation.reshape(3, 3).copy())
