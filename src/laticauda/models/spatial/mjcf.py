"""A Robot as a MuJoCo model: modules as bodies, joints, sensors, servos, and the surroundings.

Bodies and joints are those of `spatial.bodies`, with exactly the masses and parameters of the
robot.

World axes: z = 0 is the surface in water, and the ground on land. In both cases the robot starts
straight along x with its tail end at x = y = 0.
"""

from collections.abc import Iterable
from pathlib import Path
from typing import Any, Literal

from laticauda.models.spatial import appearance, scene as scenes
from laticauda.models.spatial.bodies import build_bodies, mounts
from laticauda.robot import Environment, Joint, Module, Robot, Scene, Water, check_fits
from laticauda.scenarios import Spatial
from laticauda.values import check_choice, check_instance, load_mujoco, write

ROOTS = ("free", "planar")
ACTUATORS = ("none", "servo")
TIMESTEP = 2e-3  # [s]
# Initial depth of a robot if its water specifies none: far from surface and floor [m].
DEPTH = 0.5


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
    files, around = appearance.check_meshes(meshes, robot.n_links), Scene.of(scene)
    model = _empty(robot)
    if visuals:
        appearance.add_materials(model)
    if ballast_depth is None:
        ballast_depth = Spatial().ballast_depth if root == "free" else 0.0
    _add_bodies(model, robot, start_height(robot, environment, around, root), root, ballast_depth)
    appearance.add_shapes(model, robot, files, visuals=visuals)
    if sensors:
        _add_sensors(model, robot)
    if actuators == "servo":
        for i, joint in enumerate(robot.joints):
            _add_servo(model, f"servo_{i}", f"joint_{i}", joint)
        for joint in robot.driven_joints[robot.n_joints :]:
            _add_servo(model, "fin_servo", "fin_joint", joint)
    scenes.add_scene(model, environment, around, visuals=visuals)
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
        options: Further arguments of `spec`.

    Raises:
        MissingExtra: If MuJoCo is not installed.
        ValueError: If an argument is out of range.
        StorageFailed: If the file cannot be written.
    """
    path = Path(path)
    model = build_spec(
        robot, environment, meshes=appearance.check_meshes(meshes, robot.n_links), **options
    )
    files = [Path(mesh.file) for mesh in model.meshes if mesh.file]
    if files:
        names = dict(zip(files, appearance.copied(files, path), strict=True))
        model.modelfiledir = str(path.parent.resolve())
        for mesh in model.meshes:
            if mesh.file:
                mesh.file = names[Path(mesh.file)]
    model.compile()  # MuJoCo writes compiled models only
    write(path, model.to_xml())


def robot_prefix(k: int) -> str:
    """Return the prefix of names of the k-th robot in a model; it is empty for the first robot, k = 0."""
    return f"robot_{k}_" if k else ""


def add_robot(model: Any, alone: Any, k: int) -> None:
    """Add another robot to a model, at its pose in its own model.

    Args:
        model: A `MjSpec`.
        alone: The `MjSpec` of that robot alone.
        k: Number of that robot, starting at 1; see `prefix`.
    """
    model.worldbody.add_frame().attach_body(alone.body("module_0"), robot_prefix(k), "")


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
    if isinstance(environment, Water) and (scene is None or scene.ground is None):
        deep = 0.0 if root == "planar" and environment.flow else DEPTH
        return (0.0 if scene is None else scene.level) - (
            deep if environment.depth is None else environment.depth
        )
    heights = [module.section.half_height for module in robot.modules]
    fin = robot.caudal_fin
    highest = max([*heights, 0.5 * fin.height] if fin else heights)
    terrain = None if scene is None else scene.terrain
    return highest + (0.0 if terrain is None else terrain.at(0.0, 0.0)[0])


def _empty(robot: Robot) -> Any:
    """Return an empty model in SI units and radians, without MuJoCo's own fluid."""
    model = load_mujoco().MjSpec()
    model.modelname = robot.name
    model.compiler.degree = False
    model.option.timestep = TIMESTEP
    model.option.density = model.option.viscosity = 0.0
    return model


def _add_bodies(model: Any, robot: Robot, height: float, root: str, ballast: float) -> None:
    """Add all bodies with their masses, joints and sites; module 0 has its tail end at x = y = 0."""
    kind = load_mujoco().mjtJoint
    for one in build_bodies(robot):
        parent = model.body(one.parent) if one.parent else model.worldbody
        body = parent.add_body(
            name=one.name, pos=one.position if one.parent else (0.0, 0.0, height)
        )
        body.mass, body.inertia, body.explicitinertial = one.mass, one.inertia, True
        body.ipos = (one.center, 0.0, -ballast if isinstance(one.part, Module) else 0.0)
        if not one.parent:
            _add_root(body, root)
        if one.joint is not None:
            limit = one.joint.limit if isinstance(one.joint, Joint) else None
            body.add_joint(
                name=one.joint_name,
                type=kind.mjJNT_HINGE,
                axis=one.axis,
                stiffness=_linear(one.joint.stiffness),
                damping=_linear(one.joint.damping),
                **({} if limit is None else {"range": (-limit, limit), "limited": True}),
            )
        if isinstance(one.part, Module):
            body.add_site(name=f"{one.name}_center", pos=(one.part.half_length, 0.0, 0.0))
            body.add_site(name=f"{one.name}_tail")
    for mount in mounts(robot):
        model.body(mount.body).add_site(name=mount.name, pos=mount.position, quat=mount.orientation)


def _add_root(body: Any, root: str) -> None:
    if root == "free":
        body.add_freejoint(name="root")
        return
    kind = load_mujoco().mjtJoint
    body.add_joint(name="root_x", type=kind.mjJNT_SLIDE, axis=(1.0, 0.0, 0.0))
    body.add_joint(name="root_y", type=kind.mjJNT_SLIDE, axis=(0.0, 1.0, 0.0))
    body.add_joint(name="root_yaw", type=kind.mjJNT_HINGE, axis=(0.0, 0.0, 1.0))


def _add_sensors(model: Any, robot: Robot) -> None:
    sensor, thing = load_mujoco().mjtSensor, load_mujoco().mjtObj
    found = [(f"joint_angle_{i}", f"joint_rate_{i}", f"joint_{i}") for i in range(robot.n_joints)]
    if 0 in robot.fin_joints:
        found.append(("fin_angle", "fin_rate", "fin_joint"))
    for angle, rate, joint in found:
        for name, kind in ((angle, sensor.mjSENS_JOINTPOS), (rate, sensor.mjSENS_JOINTVEL)):
            model.add_sensor(name=name, type=kind, objtype=thing.mjOBJ_JOINT, objname=joint)
    for i in range(robot.n_links):
        found = [("acceleration", sensor.mjSENS_ACCELEROMETER, "center")]
        if i:
            found += [
                ("force", sensor.mjSENS_FORCE, "tail"),
                ("torque", sensor.mjSENS_TORQUE, "tail"),
            ]
        for name, kind, site in found:
            model.add_sensor(
                name=f"{name}_{i}",
                type=kind,
                objtype=thing.mjOBJ_SITE,
                objname=f"module_{i}_{site}",
            )


def _add_servo(model: Any, name: str, target: str, joint: Joint) -> None:
    """Add the law `joints.laws.servo`: its clipped duty in the actuator, its other terms in the joint.

    Dry friction is MuJoCo's own, a constraint instead of a steep function of the rate.
    """
    motor = joint.actuator
    actuator = model.add_actuator(name=name, target=target)
    actuator.trntype = load_mujoco().mjtTrn.mjTRN_JOINT
    actuator.set_to_position(kp=motor.servo_gain * motor.stall_torque)
    actuator.forcelimited = True
    actuator.forcerange = (-motor.stall_torque, motor.stall_torque)
    actuator.ctrllimited = True
    actuator.ctrlrange = (-joint.limit, joint.limit)
    hinge = model.joint(target)
    hinge.damping = _linear(
        joint.damping + motor.stall_torque / motor.no_load_speed + motor.viscous_friction
    )
    hinge.frictionloss = motor.friction_torque


def _linear(coefficient: float) -> tuple[float, float, float]:
    """Return a stiffness or damping as the polynomial coefficients that MuJoCo expects."""
    return coefficient, 0.0, 0.0
