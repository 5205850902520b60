"""The 3D robot of a trial in its water, moved through the trial's postures: nothing is simulated anew."""

import os
import platform
import time
import warnings
from importlib import import_module
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float

from laticauda.errors import LaticaudaError, instance, positive
from laticauda.extras import load_mujoco
from laticauda.interfaces import ORIENTATION
from laticauda.kinematics import link_angles
from laticauda.pictures.camera import VIEW_DEG, aim, view
from laticauda.pictures.surroundings import add_surroundings
from laticauda.robot import Ground
from laticauda.spatial import mjcf, scene
from laticauda.trial import Trial
from laticauda.trial.cycles import hermite

MID_WATER, FLOOR = 1.0, 1.5  # depth at which a robot is shown that has none, and least depth of the floor [m]
CLEARANCE = 0.45  # least height over the floor [m]
PICTURES_PER_SECOND = 60.0
ASPECT = 1.6  # of a usual window


INSTEAD = "write a film with `--video FILE.mp4` or a picture with `--still FILE.png` instead"


class Replay:
    """The model of a trial's robot, and its state.

    Args:
        trial: Any trial, simulated or real.
        width: Of pictures that will be taken of it [pixels].
        height: The same [pixels].
    """

    def __init__(self, trial: Trial, width: int = 1280, height: int = 720) -> None:
        instance("trial", trial, Trial)
        self.trial = trial
        self.height = swimming_height(trial)
        ground: Any = trial.settings.get("ground")
        spec = mjcf.spec(trial.robot, trial.environment, sensors=False, ground=ground)
        is_deep = isinstance(trial.environment, Ground) or (_is_planar(trial) and trial.environment.depth is None)
        add_surroundings(
            spec, trial.environment, floor=floor_height(trial), length=trial.robot.reach, surface=not is_deep
        )
        picture = spec.visual.global_
        picture.offwidth, picture.offheight, picture.fovy = width, height, VIEW_DEG
        self.model: Any = spec.compile()
        self.data: Any = load_mujoco().MjData(self.model)

    def go_to(self, time: float) -> None:
        """Take the posture of a time within the trial's [s]."""
        mujoco, data, posture = load_mujoco(), self.data, posture_at(self.trial, time, self.height)
        angles = np.append(posture.joint_angle, posture.fin_angle)
        data.qpos[:3], data.qpos[3:7] = 0.0, posture.orientation
        data.qpos[7 : 7 + angles.size] = angles
        mujoco.mj_kinematics(self.model, data)
        mujoco.mj_comPos(self.model, data)
        data.qpos[:3] = posture.center_of_mass - data.subtree_com[self.model.body("module_0").id]
        mujoco.mj_forward(self.model, data)


class Posture(NamedTuple):
    """One instant."""

    center_of_mass: Float[np.ndarray, "3"]
    """[m]."""
    orientation: Float[np.ndarray, "4"]
    """Of module 0, a quaternion (w, x, y, z) [-]."""
    joint_angle: Float[np.ndarray, " n_joints"]
    """Of all joints of the robot, those that the planar model holds included [rad]."""
    fin_angle: Float[np.ndarray, " n_fin_joints"]
    """Of the joints of a fin that is driven or bends, from its root on; straight if the trial does not say [rad]."""


def posture_at(trial: Trial, time: float, height: float) -> Posture:
    """Where the robot is: between samples, smoothly.

    Args:
        trial: Any trial, planar or spatial.
        time: Within the trial's time [s].
        height: At which a planar robot swims [m].

    Raises:
        ValueError: If a measured trial does not say how the robot was bent.
    """
    trial.need("a picture of the robot", "joint_angle", "heading")
    before = int(np.clip(np.searchsorted(trial.time, time, side="right") - 1, 0, max(trial.time.size - 2, 0)))
    after = min(before + 1, trial.time.size - 1)
    step = float(trial.time[after] - trial.time[before])
    share = float(np.clip((time - trial.time[before]) / step, 0.0, 1.0)) if step > 0.0 else 0.0

    def cubic(values: np.ndarray, rates: np.ndarray) -> np.ndarray:
        pairs = [(np.atleast_1d(one[before]), np.atleast_1d(one[after])) for one in (values, rates)]
        return hermite(share, step, pairs[0], pairs[1])

    center = cubic(trial.center_of_mass, trial.center_of_mass_velocity)
    joint_angle = cubic(trial.joint_angle, trial.joint_rate)
    fin_angle = cubic(trial.fin_angle, trial.fin_rate)
    if center.size == 3 and all(name in trial.signals for name in ORIENTATION):
        first, second = (np.array([trial.signals[name][k] for name in ORIENTATION]) for k in (before, after))
        mixed = (1.0 - share) * first + share * (second if first @ second >= 0.0 else -second)
        return Posture(center, mixed / np.linalg.norm(mixed), joint_angle, fin_angle)
    if center.size == 3:  # upright, as far as one knows
        tail = (1.0 - share) * trial.link_angle[before, 0] + share * trial.link_angle[after, 0]
    else:
        center = np.append(center, height)
        tail = link_angles(joint_angle, angle=float(cubic(trial.heading, trial.heading_rate)[0]))[0]
        yaw = joint_angle
        joint_angle = np.zeros(trial.robot.n_joints)  # the planar model holds the others straight
        joint_angle[[i for i, joint in enumerate(trial.robot.joints) if joint.axis == "yaw"]] = yaw
    return Posture(center, np.array([np.cos(0.5 * tail), 0.0, 0.0, np.sin(0.5 * tail)]), joint_angle, fin_angle)


def swimming_height(trial: Trial) -> float:
    """Height at which a planar robot is shown [m]; the surface of the water, or the ground, is at 0."""
    environment = trial.environment
    if isinstance(environment, Ground):
        return mjcf.start_height(trial.robot, environment)
    return -(MID_WATER if environment.depth is None else environment.depth)


def floor_height(trial: Trial) -> float:
    """Of the floor of the water, or of the ground [m]."""
    if isinstance(trial.environment, Ground):
        return 0.0
    if trial.settings.get("ground") == "ramp":
        return -scene.TANK_DEPTH
    lowest = swimming_height(trial) if _is_planar(trial) else float(trial.center_of_mass[:, 2].min())
    return min(-FLOOR, lowest - CLEARANCE)


def _is_planar(trial: Trial) -> bool:
    return trial.center_of_mass.shape[1] == 2


# ---- in MuJoCo's own window ----------------------------------------------------------------------------------------


class NoWindow(LaticaudaError, RuntimeError):
    """A window cannot be opened here: it says why, and what to do instead."""


def show(trial: Trial, *, speed: float = 1.0) -> None:
    """Open MuJoCo's window and repeat a trial in it until it is closed.

    Args:
        trial: Any trial, simulated or real.
        speed: 2 shows it twice as fast [-].

    Raises:
        NoWindow: If there is no screen, or MuJoCo's viewer cannot be had.
        MissingExtra: If MuJoCo is not installed.
    """
    speed = positive("speed", speed)
    load_mujoco()
    if platform.system() == "Linux" and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        raise NoWindow(f"A window needs a screen, and there is none here; {INSTEAD}.")
    viewer = _viewer()
    replay = Replay(trial)
    began = time.monotonic()
    replay.go_to(float(trial.time[0]))
    with viewer.launch_passive(replay.model, replay.data, show_left_ui=False, show_right_ui=False) as window:
        with window.lock():
            window.cam.type = load_mujoco().mjtCamera.mjCAMERA_TRACKING  # from where a film begins; the mouse moves it
            window.cam.trackbodyid = replay.model.body("module_0").id
            aim(window.cam, view(trial, float(trial.time[0]), replay.height, ASPECT))
        while window.is_running():
            shown = (time.monotonic() - began) * speed % max(trial.duration, 1e-9)
            with window.lock():
                replay.go_to(float(trial.time[0]) + shown)
            window.sync()
            time.sleep(1.0 / PICTURES_PER_SECOND)


def _viewer() -> Any:
    """The module `mujoco.viewer`, if it can open a window here; otherwise it would end the program."""
    try:
        glfw: Any = import_module("glfw")
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # what it complains about is said below
            works = glfw.init()
        if not works:
            raise NoWindow(f"A window needs a screen, and the one that is named here cannot be used; {INSTEAD}.")
        return import_module("mujoco.viewer")
    except ImportError as error:
        raise NoWindow(f"A window needs the package glfw; run `pip install glfw`, or {INSTEAD}.") from error
