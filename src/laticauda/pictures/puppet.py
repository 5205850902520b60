"""The 3D robot of a trial in its water, which takes the trial's postures: nothing is simulated anew."""

from typing import Any

from laticauda.errors import instance
from laticauda.extras import load_mujoco
from laticauda.pictures import pool
from laticauda.pictures.camera import VIEW_DEG, reach
from laticauda.pictures.poses import pose, put
from laticauda.robot import Ground
from laticauda.spatial import mjcf, scene
from laticauda.trial import Trial

MID_WATER, FLOOR = 1.0, 1.5  # depth at which a robot is shown that has none, and least depth of the floor [m]
CLEARANCE = 0.45  # least height over the floor [m]


class Puppet:
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
        pool.add_surroundings(
            spec,
            trial.environment,
            floor=floor_height(trial),
            length=reach(trial.robot),
            surface=_is_near_the_surface(trial),
        )
        picture = spec.visual.global_
        picture.offwidth, picture.offheight, picture.fovy = width, height, VIEW_DEG
        self.model: Any = spec.compile()
        self.data: Any = load_mujoco().MjData(self.model)

    def take(self, time: float) -> None:
        """Take the posture of a time within the trial's [s]."""
        put(self.model, self.data, self.trial.robot, pose(self.trial, time, self.height))


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
    lowest = float(trial.center_of_mass[:, 2].min()) if trial.center_of_mass.shape[1] == 3 else swimming_height(trial)
    return min(-FLOOR, lowest - CLEARANCE)


def _is_near_the_surface(trial: Trial) -> bool:
    """Whether the surface matters: to the planar model without a depth it is far away."""
    if isinstance(trial.environment, Ground):
        return False
    return trial.center_of_mass.shape[1] == 3 or trial.environment.depth is not None
