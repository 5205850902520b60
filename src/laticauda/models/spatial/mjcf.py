"""A robot as a MuJoCo model: modules as bodies, joints, sensors, servos, and the surroundings.

Bodies and joints are those of `spatial.bodies`, with exactly the masses and parameters of the
robot.

World axes: z = 0 is the surface in water, and the ground on land. In both cases the robot starts
straight along x with its tail end at x = y = 0.
"""

from collections.abc import Iterable
from pathlib import Path
from typing import Any, Literal

from laticauda.models.spatial.appearance import add_materials, add_shapes
from laticauda.models.spatial.mesh_files import check_meshes, copy_meshes
from laticauda.models.spatial.mjcf_parts import add_bodies, add_sensors, add_servos
from laticauda.models.spatial.surroundings import add_surroundings
from laticauda.robot import Environment, Robot, Scene, Water, check_fits
from laticauda.scenarios import Spatial
from laticauda.values import check_choice, check_instance, load_mujoco, renamed_names, write

ROOTS = ("free", "planar")
"""How module 0 can be held."""
ACTUATORS = ("none", "servo")
"""What can drive the joints of a model."""
TIMESTEP = 2e-3
"""Time step of a model for plain MuJoCo [s]."""
DEPTH = 0.5
"""Initial depth of a robot if its water specifies none: far from surface and floor [m]."""

__getattr__ = renamed_names(__name__, {"spec": "build_spec"})


def build_spec(
    robot: Robot,
    environment: Environment,
    *,
    root: Literal["free", "planar"] = "free",
    actuators: Literal["none", "servo"] = "none",
    sensors: bool = True,
    visuals: bool = True,
    scene: Scene | str | None = None,
    ballast_depth: float | None = None,
    meshes: Iterable[str | Path] = (),
) -> Any:
    """Return a robot and its surroundings as a MuJoCo model to compile, modify or write to a file.

    The water's loads are not included: MuJoCo's own fluid model is off; see
    `laticauda.water.mujoco`. The skin of the joints is included as their stiffness and damping.

    Args:
        robot: The robot.
        environment: The water it swims in or the ground it crawls on.
        root: How module 0 is held: `free` (joint `root`), or `planar`, with fixed height and tilt
            (joints `root_x`, `root_y` and `root_yaw`).
        actuators: `servo` adds an actuator `servo_i` to every joint, with the desired angle [rad]
            as its input, and `fin_servo` to the joint of a driven fin.
        sensors: Whether to add the sensors of the real robot: `joint_angle_i` and `joint_rate_i`;
            `acceleration_i` per module, and `force_i` and `torque_i` between the module and its
            neighbor on the tail side; `fin_angle` and `fin_rate` of a driven fin.
        visuals: Whether to add shapes and colors of the robot, beyond the collision shapes.
        scene: Surroundings of the robot; see `Scene.of`. None: flat ground at z = 0 if the
            environment is ground, else nothing.
        ballast_depth: How far the modules' centers of mass lie below their axes [m]; None: as in a
            simulation (`Spatial.ballast_depth`) for a free root, else 0.
        meshes: One file (STL or OBJ) per module, tail first, in the module's frame and in meters,
            for display and, as its convex hull, for collision; if empty, the shapes provided by
            laticauda are used.

    Returns:
        A `mujoco.MjSpec`.

    Raises:
        MissingExtra: If MuJoCo is not installed.
        ValueError: If an argument is out of range, or robot and environment are incompatible.
    """
    check_instance("robot", robot, Robot)
    check_choice("root", root, ROOTS)
    check_choice("actuators", actuators, ACTUATORS)
    check_fits(robot, environment)
    files = check_meshes(meshes, robot.n_links)
    surroundings = Scene.of(scene)
    if ballast_depth is None:
        ballast_depth = _usual_ballast_depth(root)
    model = _create_empty_model(robot)
    if visuals:
        add_materials(model)
    add_bodies(
        model,
        robot,
        height=start_height(robot, environment, surroundings, root),
        root=root,
        ballast_depth=ballast_depth,
    )
    add_shapes(model, robot, files, visuals=visuals)
    if sensors:
        add_sensors(model, robot)
    if actuators == "servo":
        add_servos(model, robot)
    add_surroundings(model, environment, surroundings, visuals=visuals)
    return model


def write_mjcf(
    path: str | Path,
    robot: Robot,
    environment: Environment,
    *,
    meshes: Iterable[str | Path] = (),
    **options: Any,
) -> None:
    """Write a robot and its surroundings as an MJCF file for plain MuJoCo, with copies of mesh files next to it.

    Args:
        path: The file (.xml); an existing file is replaced.
        robot: The robot.
        environment: The water it swims in or the ground it crawls on.
        meshes: One file (STL or OBJ) per module, tail first, in the module's frame and in meters;
            if empty, the shapes provided by laticauda are used.
        options: Further arguments of `build_spec`.

    Raises:
        MissingExtra: If MuJoCo is not installed.
        ValueError: If an argument is out of range.
        StorageFailed: If the file cannot be written.
    """
    path = Path(path)
    files = check_meshes(meshes, robot.n_links)
    model = build_spec(robot, environment, meshes=files, **options)
    _copy_meshes_of_model(model, path)
    # MuJoCo writes compiled models only.
    model.compile()
    write(path, model.to_xml())


def _copy_meshes_of_model(model: Any, path: Path) -> None:
    """Copy the mesh files of a model next to its file `path`, and let the model refer to the copies."""
    meshes = [mesh for mesh in model.meshes if mesh.file]
    if not meshes:
        return
    copies = copy_meshes([Path(mesh.file) for mesh in meshes], path)
    model.modelfiledir = str(path.parent.resolve())
    for mesh, copy in zip(meshes, copies, strict=True):
        mesh.file = copy


def robot_prefix(k: int) -> str:
    """Return the prefix of names of the k-th robot in a model; it is empty for the first robot, k = 0."""
    if k == 0:
        return ""
    return f"robot_{k}_"


def add_robot(model: Any, alone: Any, k: int) -> None:
    """Add another robot to a model, at its pose in its own model.

    Args:
        model: A `MjSpec`.
        alone: The `MjSpec` of that robot alone.
        k: Number of that robot, starting at 1; see `robot_prefix`.
    """
    frame = model.worldbody.add_frame()
    frame.attach_body(alone.body("module_0"), robot_prefix(k), "")


def start_height(
    robot: Robot, environment: Environment, scene: Scene | None = None, root: str = "free"
) -> float:
    """Return the robot's initial height in the model [m]: with its axis at the water's depth, or on the ground.

    In a flow, a robot with a planar root is at the surface if the water specifies no depth, as in
    the planar model.

    Args:
        robot: The robot.
        environment: The water it swims in or the ground it crawls on.
        scene: Surroundings of the robot.
        root: How module 0 is held.
    """
    has_ground = scene is not None and scene.ground is not None
    if isinstance(environment, Water) and not has_ground:
        level = 0.0 if scene is None else scene.level
        return level - _swimming_depth(environment, root)
    half_heights = [module.section.half_height for module in robot.modules]
    if robot.caudal_fin is not None:
        half_heights.append(0.5 * robot.caudal_fin.height)
    if scene is None or scene.terrain is None:
        return max(half_heights)
    height_of_ground, _, _ = scene.terrain.at(0.0, 0.0)
    return max(half_heights) + height_of_ground


def _swimming_depth(water: Water, root: str) -> float:
    """Return the initial depth of a robot that swims [m]."""
    if water.depth is not None:
        return water.depth
    if root == "planar" and water.flow:
        return 0.0
    return DEPTH


def _usual_ballast_depth(root: str) -> float:
    """Return the depth of the modules' centers of mass in a simulation [m]."""
    if root == "free":
        return Spatial().ballast_depth
    return 0.0


def _create_empty_model(robot: Robot) -> Any:
    """Return an empty model in SI units and radians, without MuJoCo's own fluid."""
    model = load_mujoco().MjSpec()
    model.modelname = robot.name
    model.compiler.degree = False
    model.option.timestep = TIMESTEP
    model.option.density = 0.0
    model.option.viscosity = 0.0
    return model
