"""Parts of a robot in its MuJoCo model: bodies with their joints, sensors, and servos."""

from typing import Any, NamedTuple

from laticauda.models.spatial.bodies import Body, build_bodies
from laticauda.models.spatial.mounts import build_mounts
from laticauda.robot import Joint, Module, Robot
from laticauda.values import load_mujoco

Polynomial = tuple[float, float, float]
FIN_JOINT = "fin_joint"
"""Joint of a driven fin."""
FIN_ROOT = "fin_root"
"""Site at that joint, on the fin."""


class _JointSensors(NamedTuple):
    """Names of the sensors of a joint."""

    angle: str
    rate: str
    joint: str


def add_bodies(model: Any, robot: Robot, *, height: float, root: str, ballast_depth: float) -> None:
    """Add all bodies with their masses, joints and sites.

    Args:
        model: A `MjSpec`.
        robot: The robot.
        height: Height of module 0, whose tail end is at x = y = 0 [m].
        root: How module 0 is held: `free` or `planar`.
        ballast_depth: How far the modules' centers of mass lie below their axes [m].
    """
    for body in build_bodies(robot):
        if body.parent:
            part = model.body(body.parent).add_body(name=body.name, pos=body.position)
        else:
            part = model.worldbody.add_body(name=body.name, pos=(0.0, 0.0, height))
            _add_root(part, root)
        depth = ballast_depth if isinstance(body.part, Module) else 0.0
        part.mass = body.mass
        part.inertia = body.inertia
        part.explicitinertial = True
        part.ipos = (body.center, 0.0, -depth)
        if body.joint is not None:
            _add_joint(part, body)
        if isinstance(body.part, Module):
            middle = (body.part.half_length, 0.0, 0.0)
            part.add_site(name=f"{body.name}_center", pos=middle)
            part.add_site(name=f"{body.name}_tail")
        if body.joint_name == FIN_JOINT:
            part.add_site(name=FIN_ROOT)
    for mount in build_mounts(robot):
        part = model.body(mount.body)
        part.add_site(name=mount.name, pos=mount.position, quat=mount.orientation)


def _add_root(part: Any, root: str) -> None:
    """Let module 0 move freely, or in the plane."""
    if root == "free":
        part.add_freejoint(name="root")
        return
    kind = load_mujoco().mjtJoint
    part.add_joint(name="root_x", type=kind.mjJNT_SLIDE, axis=(1.0, 0.0, 0.0))
    part.add_joint(name="root_y", type=kind.mjJNT_SLIDE, axis=(0.0, 1.0, 0.0))
    part.add_joint(name="root_yaw", type=kind.mjJNT_HINGE, axis=(0.0, 0.0, 1.0))


def _add_joint(part: Any, body: Body) -> None:
    """Add the joint at the origin of a body, with the skin around it; passive hinges have no limit."""
    joint = body.joint
    assert joint is not None
    hinge = part.add_joint(
        name=body.joint_name,
        type=load_mujoco().mjtJoint.mjJNT_HINGE,
        axis=body.axis,
        stiffness=_linear(joint.stiffness),
        damping=_linear(joint.damping),
    )
    if isinstance(joint, Joint):
        hinge.range = (-joint.limit, joint.limit)
        hinge.limited = True


def add_sensors(model: Any, robot: Robot) -> None:
    """Add the sensors of the real robot: angles and rates of its joints, accelerations and loads of its modules."""
    joints = [
        _JointSensors(f"joint_angle_{i}", f"joint_rate_{i}", f"joint_{i}")
        for i in range(robot.n_joints)
    ]
    if 0 in robot.fin_joints:
        joints.append(_JointSensors("fin_angle", "fin_rate", FIN_JOINT))
    kind = load_mujoco().mjtSensor
    target = load_mujoco().mjtObj.mjOBJ_JOINT
    for names in joints:
        model.add_sensor(
            name=names.angle, type=kind.mjSENS_JOINTPOS, objtype=target, objname=names.joint
        )
        model.add_sensor(
            name=names.rate, type=kind.mjSENS_JOINTVEL, objtype=target, objname=names.joint
        )
    for i in range(robot.n_links):
        _add_module_sensors(model, i)
    if 0 in robot.fin_joints:
        site = load_mujoco().mjtObj.mjOBJ_SITE
        model.add_sensor(name="fin_force", type=kind.mjSENS_FORCE, objtype=site, objname=FIN_ROOT)
        model.add_sensor(name="fin_torque", type=kind.mjSENS_TORQUE, objtype=site, objname=FIN_ROOT)


def _add_module_sensors(model: Any, i: int) -> None:
    """Add the sensors of module i; the tail module has no neighbor whose load it could measure."""
    kind = load_mujoco().mjtSensor
    target = load_mujoco().mjtObj.mjOBJ_SITE
    center = f"module_{i}_center"
    model.add_sensor(
        name=f"acceleration_{i}", type=kind.mjSENS_ACCELEROMETER, objtype=target, objname=center
    )
    if i == 0:
        return
    tail = f"module_{i}_tail"
    model.add_sensor(name=f"force_{i}", type=kind.mjSENS_FORCE, objtype=target, objname=tail)
    model.add_sensor(name=f"torque_{i}", type=kind.mjSENS_TORQUE, objtype=target, objname=tail)


def add_servos(model: Any, robot: Robot) -> None:
    """Add a servo to every joint of the body, and to that of a driven fin."""
    for i, joint in enumerate(robot.joints):
        _add_servo(model, f"servo_{i}", f"joint_{i}", joint)
    for joint in robot.driven_joints[robot.n_joints :]:
        _add_servo(model, "fin_servo", FIN_JOINT, joint)


def _add_servo(model: Any, name: str, joint_name: str, joint: Joint) -> None:
    """Add the law `joints.laws.servo`: its clipped duty in the actuator, its other terms in the joint.

    Dry friction is MuJoCo's own, a constraint instead of a steep function of the rate.
    """
    motor = joint.actuator
    servo = model.add_actuator(name=name, target=joint_name)
    servo.trntype = load_mujoco().mjtTrn.mjTRN_JOINT
    servo.set_to_position(kp=motor.servo_gain * motor.stall_torque)
    servo.forcelimited = True
    servo.forcerange = (-motor.stall_torque, motor.stall_torque)
    servo.ctrllimited = True
    servo.ctrlrange = (-joint.limit, joint.limit)
    hinge = model.joint(joint_name)
    back_emf = motor.stall_torque / motor.no_load_speed
    hinge.damping = _linear(joint.damping + back_emf + motor.viscous_friction)
    hinge.frictionloss = motor.friction_torque


def _linear(coefficient: float) -> Polynomial:
    """Return a stiffness or damping as the polynomial coefficients that MuJoCo expects."""
    return coefficient, 0.0, 0.0
