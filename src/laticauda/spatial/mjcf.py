"""A Robot as a MuJoCo model: modules as bodies, joints, sensors, servos, and the place that it is in.

Bodies are `module_0` (tail) to `module_{n-1}` (head). A module's frame has its origin at its tail end, x toward the
head, y to the left and z up. `joint_i` is at the head end of module i and turns module i + 1 about z (yaw) or y
(pitch), so joint angles and all numbering are those of `Robot`: a positive yaw angle turns the head side left, a
positive pitch angle turns it down. The fin is the body `caudal_fin`, fixed to module 0, or on `fin_joint` if it is
driven. If it bends, piece k of it is the body `caudal_fin_k` on the passive hinge `fin_hinge_k`, counted from the root.
The fin's angles count as those of the body do: positive ones turn what is behind the hinge to the right.

World axes: in water z = 0 is the surface, on ground z = 0 is the ground. In both the robot begins straight along x with
its tail end at x = y = 0.
"""

import math
from collections.abc import Iterable
from pathlib import Path
from typing import Any, Literal

from laticauda.errors import instance, one_of
from laticauda.extras import load_mujoco
from laticauda.robot import CaudalFin, Environment, Ground, Joint, Module, Piece, Robot, Water, check_fits
from laticauda.spatial import appearance, scene
from laticauda.spatial.fin import fin_bodies

ROOTS = ("free", "planar")
ACTUATORS = ("none", "servo")
TIMESTEP = 2e-3  # [s]
# Where a robot starts whose water gives no depth: far from surface and floor, as seen by the planar model [m].
DEPTH = 0.5
AXES = {"yaw": (0.0, 0.0, 1.0), "pitch": (0.0, 1.0, 0.0)}
FIN_AXIS = (0.0, 0.0, -1.0)  # its bodies hang behind their hinges, those of the body ahead


def spec(
    robot: Robot,
    environment: Environment,
    *,
    root: Literal["free", "planar"] = "free",
    actuators: Literal["none", "servo"] = "none",
    sensors: bool = True,
    visuals: bool = True,
    tank: bool = False,
    ground: Literal["flat", "ramp"] | None = None,
    meshes: Iterable[str | Path] = (),
) -> Any:
    """A robot, and the place that it is in, as a MuJoCo model to compile, change or write to a file.

    The water's loads are not in it: MuJoCo's own fluid model is off, see `laticauda.mujoco_water`. The skin of the
    joints is, as stiffness and damping of the joints.

    Args:
        robot: What swims.
        environment: The water it swims in or the ground it crawls on.
        root: How module 0 is held: not at all (joint `root`), or with its height and its tilt fixed (joints `root_x`,
            `root_y` and `root_yaw`).
        actuators: `servo` puts an actuator `servo_i` on every joint, with the angle wanted [rad] as its input, and
            `fin_servo` on that of a driven fin.
        sensors: Sensors as the real robot has them: `joint_angle_i` and `joint_rate_i`; per module `acceleration_i`,
            and `force_i` and `torque_i` between it and the module on its tail side; `fin_angle` and `fin_rate` of a
            driven fin.
        visuals: Shapes and colors of the robot and the light on it. Without them it has its collision shapes only.
        tank: The tank of the experiments around the water: 40 m x 6.45 m, 1.5 m deep, with its floor and walls.
        ground: Solid ground: `flat` at z = 0, or a `ramp` from a shore down into the water along x, with the robot on
            the shore. None: flat where the environment is ground, else none.
        meshes: A file (STL or OBJ) per module, tail first, in the module's frame and in meters, to see and, as its
            convex hull, to collide with; none takes the shapes that come with laticauda.

    Returns:
        A `mujoco.MjSpec`.

    Raises:
        MissingExtra: If MuJoCo is not installed.
        ValueError: If an argument is out of its range, or robot and environment do not fit together.
    """
    instance("robot", robot, Robot)
    instance("environment", environment, Water, Ground)
    one_of("root", root, ROOTS)
    one_of("actuators", actuators, ACTUATORS)
    check_fits(robot, environment)
    files = appearance.checked(meshes, robot.n_links)
    model = _empty(robot)
    if visuals:
        appearance.add_materials(model)
    scene.add(model, environment, tank=tank, ground=ground, visuals=visuals)
    _add_chain(model, robot, start_height(robot, environment, ground), root)
    appearance.add_shapes(model, robot, files, visuals=visuals)
    if sensors:
        _add_sensors(model, robot)
    if actuators == "servo":
        for i, joint in enumerate(robot.joints):
            _add_servo(model, f"servo_{i}", f"joint_{i}", joint)
        if robot.caudal_fin is not None and robot.caudal_fin.joint is not None:
            _add_servo(model, "fin_servo", "fin_joint", robot.caudal_fin.joint)
    return model


def start_height(robot: Robot, environment: Environment, ground: str | None = None) -> float:
    """Height at which the model's robot lies at first [m]: the axis's depth below the surface, or on the ground.

    Args:
        robot: What swims.
        environment: The water it swims in or the ground it crawls on.
        ground: As for `spec`.
    """
    if ground is None and isinstance(environment, Water):
        return -(DEPTH if environment.depth is None else environment.depth)
    heights = [module.section.half_height for module in robot.modules]
    fin = robot.caudal_fin
    highest = max([*heights, 0.5 * fin.height] if fin else heights)
    return highest + (scene.SHORE_HEIGHT if ground == "ramp" else 0.0)


def center_of_mass(robot: Robot) -> float:
    """Center of mass of the straight robot from its tail end, on its axis [m]."""
    moment, behind = 0.0, 0.0
    for module in robot.modules:
        moment += module.mass * (behind + module.half_length + module.center)
        behind += module.length
    if robot.caudal_fin is not None:
        moment -= robot.caudal_fin.mass * 0.5 * robot.caudal_fin.length
    return moment / robot.mass


def inertia_of(module: Module) -> tuple[float, tuple[float, float, float]]:
    """Where a module has its center of mass on its x axis [m], and its moments of inertia there [kg m^2]."""
    m, a, b = module.mass, module.section.half_height, module.section.half_width
    return module.half_length + module.center, moments(module.moment_of_inertia, 0.25 * m * b**2, 0.25 * m * a**2)


def fin_inertia(fin: CaudalFin, piece: Piece) -> tuple[float, tuple[float, float, float]]:
    """The same for a piece of the fin."""
    m = piece.mass
    rod = m * piece.length**2 / 12.0  # as the planar model has it
    return -0.5 * piece.length, moments(rod, m * fin.thickness**2 / 12.0, m * fin.height**2 / 12.0)


def moments(vertical: float, across: float, above: float) -> tuple[float, float, float]:
    """Moments of inertia of a body about its x, y and z axis, of which z has to be exact [kg m^2].

    With the second moments s_x, s_y, s_z of the mass, I_z = s_x + s_y and so on. Here I_z is the robot's own, s_y and
    s_z are those of the body's section, and s_x is what is left for it. So a robot that is planar in its numbers (thin
    rods) still has the roll and the pitch of its section, and no combination of numbers is an impossible body.

    Args:
        vertical: I_z [kg m^2].
        across: s_y of the section; at most half of I_z counts [kg m^2].
        above: s_z of the section [kg m^2].
    """
    across = min(across, 0.5 * vertical)
    return across + above, vertical - across + above, vertical


def _empty(robot: Robot) -> Any:
    """A model with nothing in it, in SI units and radians, without MuJoCo's own water."""
    model = load_mujoco().MjSpec()
    model.modelname = robot.name
    model.compiler.degree = False
    model.option.timestep = TIMESTEP
    model.option.density = model.option.viscosity = 0.0
    return model


def _add_chain(model: Any, robot: Robot, height: float, root: str) -> None:
    """All bodies with their masses, joints and sites; module 0 has its tail end at x = y = 0."""
    body = model.worldbody
    for i, module in enumerate(robot.modules):
        ahead = robot.modules[i - 1].length if i else 0.0
        body = body.add_body(name=f"module_{i}", pos=(ahead, 0.0, 0.0) if i else (0.0, 0.0, height))
        if i == 0:
            _add_root(body, root)
        else:
            _add_joint(body, i - 1, robot.joints[i - 1])
        _set_module(body, i, module)
    if robot.caudal_fin is not None:  # after the modules, so that their joints come first
        _add_fin(model.body("module_0"), robot.caudal_fin)
    for kind, effectors in (("thruster", robot.thrusters), ("pectoral_fin", robot.pectoral_fins)):
        for k, effector in enumerate(effectors):
            half_length = robot.modules[effector.link].half_length
            half = 0.5 * effector.angle
            model.body(f"module_{effector.link}").add_site(
                name=f"{kind}_{k}",
                pos=(half_length + effector.x, effector.y, 0.0),
                quat=(math.cos(half), 0.0, 0.0, math.sin(half)),
            )


def _add_root(body: Any, root: str) -> None:
    if root == "free":
        body.add_freejoint(name="root")
        return
    kind = load_mujoco().mjtJoint
    body.add_joint(name="root_x", type=kind.mjJNT_SLIDE, axis=(1.0, 0.0, 0.0))
    body.add_joint(name="root_y", type=kind.mjJNT_SLIDE, axis=(0.0, 1.0, 0.0))
    body.add_joint(name="root_yaw", type=kind.mjJNT_HINGE, axis=(0.0, 0.0, 1.0))


def _add_joint(body: Any, index: int, joint: Joint) -> None:
    _add_driven(body, f"joint_{index}", joint, AXES[joint.axis])


def _add_driven(body: Any, name: str, joint: Joint, axis: tuple[float, float, float]) -> None:
    body.add_joint(
        name=name,
        type=load_mujoco().mjtJoint.mjJNT_HINGE,
        axis=axis,
        range=(-joint.limit, joint.limit),
        limited=True,
        stiffness=_linear(joint.stiffness),
        damping=_linear(joint.damping),
    )


def _set_module(body: Any, index: int, module: Module) -> None:
    _set_inertia(body, module.mass, *inertia_of(module))
    body.add_site(name=f"module_{index}_center", pos=(module.half_length, 0.0, 0.0))
    body.add_site(name=f"module_{index}_tail")


def _add_fin(tail: Any, fin: CaudalFin) -> None:
    """The first piece has the frame of module 0; all extend to -x."""
    body, ahead = tail, 0.0
    for k, (name, piece) in enumerate(fin_bodies(fin)):
        body = body.add_body(name=name, pos=(-ahead, 0.0, 0.0))
        _set_inertia(body, piece.mass, *fin_inertia(fin, piece))
        ahead = piece.length
        if piece.hinge is not None:
            body.add_joint(
                name=f"fin_hinge_{k}",
                type=load_mujoco().mjtJoint.mjJNT_HINGE,
                axis=FIN_AXIS,
                stiffness=_linear(piece.hinge.stiffness),
                damping=_linear(piece.hinge.damping),
            )
        elif fin.joint is not None:
            _add_driven(body, "fin_joint", fin.joint, FIN_AXIS)


def _set_inertia(body: Any, mass: float, center: float, inertia: tuple[float, float, float]) -> None:
    body.mass, body.inertia, body.ipos = mass, inertia, (center, 0.0, 0.0)
    body.explicitinertial = True


def _add_sensors(model: Any, robot: Robot) -> None:
    sensor, thing = load_mujoco().mjtSensor, load_mujoco().mjtObj
    found = [(f"joint_angle_{i}", f"joint_rate_{i}", f"joint_{i}") for i in range(robot.n_joints)]
    if robot.caudal_fin is not None and robot.caudal_fin.joint is not None:
        found.append(("fin_angle", "fin_rate", "fin_joint"))
    for angle, rate, joint in found:
        for name, kind in ((angle, sensor.mjSENS_JOINTPOS), (rate, sensor.mjSENS_JOINTVEL)):
            model.add_sensor(name=name, type=kind, objtype=thing.mjOBJ_JOINT, objname=joint)
    for i in range(robot.n_links):
        found = [("acceleration", sensor.mjSENS_ACCELEROMETER, "center")]
        if i:
            found += [("force", sensor.mjSENS_FORCE, "tail"), ("torque", sensor.mjSENS_TORQUE, "tail")]
        for name, kind, site in found:
            model.add_sensor(name=f"{name}_{i}", type=kind, objtype=thing.mjOBJ_SITE, objname=f"module_{i}_{site}")


def _add_servo(model: Any, name: str, target: str, joint: Joint) -> None:
    """The law `actuation.laws.servo`: its clipped duty in the actuator, the rest of its terms in the joint.

    Dry friction is MuJoCo's own there, a constraint instead of a steep function of the rate.
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
    hinge.damping = _linear(joint.damping + motor.stall_torque / motor.no_load_speed + motor.viscous_friction)
    hinge.frictionloss = motor.friction_torque


def _linear(coefficient: float) -> tuple[float, float, float]:
    """A stiffness or damping as MuJoCo wants it: the coefficients of a polynomial."""
    return coefficient, 0.0, 0.0
