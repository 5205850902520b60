"""Trials made by formula, so that every figure of theirs is known without a simulation."""

import math
from collections.abc import Callable

import numpy as np
import pytest

from laticauda.motion.gaits import Custom, Gait
from laticauda.robot import Ground, Module, Robot, Section, Water, load_robot, load_water
from laticauda.robot.kinematics import heading, joint_angles
from laticauda.scenarios import Experiment
from laticauda.trials import Trial

PERIOD = 2.5
USUAL_GAIT = Gait(
    amplitude=math.radians(30.0), frequency=2.0 * math.pi / PERIOD, phase_shift=math.radians(40.0)
)


def synthetic_trial(
    *,
    duration: float = 30.0,
    dt: float = 0.02,
    speed: float = 0.15,
    direction: float = 0.0,
    turning_rate: float = 0.0,
    origin: tuple[float, float] = (0.0, 0.0),
    mirrored: bool = False,
    ripple: float = 0.2,
    n_axes: int = 2,
    robot: Robot | None = None,
    environment: Water | Ground | None = None,
    gait: Gait | None = USUAL_GAIT,
    notes: dict[str, object] | None = None,
    **fields: object,
) -> Trial:
    """A run at constant speed along a circle (`turning_rate` [rad/s]) or a line, with a gait of 2.5 s.

    The heading is the course plus a ripple of the gait's period; the joints do work of 3 W
    absolute, 1 W net.
    """
    robot = robot or load_robot("mamba")
    side = -1.0 if mirrored else 1.0
    omega = 2.0 * math.pi / PERIOD
    time = dt * np.arange(round(duration / dt) + 1)
    course = turning_rate * time
    if turning_rate:
        x, y = np.sin(course) / turning_rate, (1.0 - np.cos(course)) / turning_rate
    else:
        x, y = time, np.zeros_like(time)
    path = speed * np.stack((x, side * y), axis=1)
    velocity = speed * np.stack((np.cos(course), side * np.sin(course)), axis=1)
    angle = side * course

    n_links = robot.n_links if n_axes == 3 else robot.planar().n_links
    wave = np.arange(n_links) * 0.7
    bend = np.sin(omega * time[:, np.newaxis] + wave)
    bend_rate = omega * np.cos(omega * time[:, np.newaxis] + wave)
    link_angle = direction + angle[:, np.newaxis] + side * ripple * bend
    link_rate = side * (turning_rate + ripple * bend_rate)
    rotation = np.array(
        [[math.cos(direction), -math.sin(direction)], [math.sin(direction), math.cos(direction)]]
    )
    height = np.zeros((time.size, n_axes - 2))
    given = {
        "time": time,
        "center_of_mass": np.hstack((path @ rotation.T + np.array(origin), height)),
        "center_of_mass_velocity": np.hstack((velocity @ rotation.T, height)),
        "heading": heading(link_angle),
        "heading_rate": heading(link_rate),
        "link_angle": link_angle,
        "joint_angle": joint_angles(link_angle),
        "joint_rate": joint_angles(link_rate),
        "joint_angle_ref": joint_angles(link_angle),
        "joint_torque": np.cos(joint_angles(link_angle)),
        "work": time[:, np.newaxis] * np.array([3.0, 1.0, 2.0]),
        "scenario": Experiment(
            robot=robot,
            gait=gait,
            environment=environment or load_water("paper-lateral"),
            notes=notes or {},
        ),
        "version": "0.1.0",
    }
    return Trial(**{**given, **fields})


@pytest.fixture(scope="session")
def make_trial() -> Callable[..., Trial]:
    """The maker of synthetic trials, see `synthetic_trial`."""
    return synthetic_trial


@pytest.fixture(scope="session")
def full_trial() -> Trial:
    """A trial with every optional part, awkward texts and every kind of number in its state."""
    robot = Robot(
        name="odd one",
        description='two "quoted" words, a \\ and an é',
        modules=(Module(length=0.1, mass=0.3, section=Section(half_height=0.05, half_width=0.04)),)
        * 4,
        joints=load_robot("mamba").joints[:3],
        caudal_fin=load_robot("mamba-fin").caudal_fin,
    )
    rng = np.random.default_rng(7)
    plain = synthetic_trial(duration=1.0, robot=robot)
    n = plain.time.size
    return synthetic_trial(
        duration=1.0,
        robot=robot,
        gait=Gait(
            amplitude=0.3,
            frequency=2.0,
            phase_shift=0.1,
            envelope=Custom(values=(0.1, 1 / 3, 1e-300)),
        ),
        environment=load_water("paper-eel"),
        joint_torque=rng.normal(size=(n, 3)),
        electrical_work=np.cumsum(rng.random(n)),
        link_force={"drag": rng.normal(size=(n, 4, 2)), "effector": -np.zeros((n, 4, 2))},
        signals={"offset": rng.normal(size=n), "of_ones_own": -np.zeros(n)},
        notes={
            "model": "planar",
            "dt": 0.02,
            "bandwidth": math.inf,
            "steps": 3,
            "throw": False,
            "seed": None,
        },
        created="2026-01-02T03:04:05+00:00",
        status="The joints jumped at 0.5 s. Try a smaller gain: ½ of it.",
        succeeded=False,
        state={
            "link_rate": rng.normal(size=4),
            "time": np.array(0.1 + 0.2),
            "lost": np.array([np.nan, -0.0, np.inf]),
            "count": np.array([[1, -2]], dtype=np.int32),
            "locked": np.array([True, False]),
            "nothing": np.zeros((0, 3)),
        },
    )
