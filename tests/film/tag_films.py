"""A short film of a robot with tags, rendered once: oblique, through water, with a lens that distorts."""

from dataclasses import dataclass
from functools import cache
from pathlib import Path
from tempfile import mkdtemp

import cv2
import numpy as np
from campaign_scripts import campaign

import laticauda as lc
from laticauda.film.tags import TagLayout, propose_layout
from laticauda.robot import kinematics

films = campaign("_rendered_films")
FRAME_RATE = 20.0
N_FRAMES = 16
LEVEL, SURFACE = 0.1, 0.3
CAMERA = films.Camera(
    size=(960, 540),
    focal=800.0,
    k1=-0.05,
    eye=(0.8, -0.9, 1.8),
    target=(0.8, 0.5, 0.0),
    surface=SURFACE,
)


@dataclass(frozen=True)
class RenderedFilm:
    path: Path
    robot: lc.Robot
    layout: TagLayout
    trial: lc.Trial
    times: np.ndarray


def swimmer() -> lc.Robot:
    return lc.load_robot("mamba", n_links=4)


def layout_of(robot: lc.Robot) -> TagLayout:
    return propose_layout(robot, area=(1.6, 1.0), floor_size=0.12)


@cache
def rendered() -> RenderedFilm:
    robot = swimmer()
    gait = lc.lateral_undulation(amplitude=0.4, frequency=4.0, phase_shift=1.0)
    start = lc.Start(center_of_mass=(0.7, 0.5), heading=0.3)
    water = lc.load_water("paper-lateral")
    trial = lc.swim(robot, gait, 1.0, environment=water, start=start)
    layout = layout_of(robot)
    scene = films.Scene(
        camera=CAMERA,
        floor_tags={tag.number: (tag.x, tag.y, tag.angle) for tag in layout.floor},
        floor_size=layout.floor_size,
        level=LEVEL,
        body_size=layout.link_size,
    )
    path = Path(mkdtemp()) / "swim.avi"
    times = np.arange(N_FRAMES) / FRAME_RATE
    posture = kinematics.Posture(robot, trial.center_of_mass[:, :2], trial.link_angle)
    codec = cv2.VideoWriter_fourcc(*"MJPG")
    writer = cv2.VideoWriter(str(path), codec, FRAME_RATE, CAMERA.size)
    generator = np.random.default_rng(0)
    for time in times:
        sample = int(np.argmin(np.abs(trial.time - time)))
        picture = scene.picture(
            posture.link_centers[sample],
            trial.link_angle[sample],
            [module.length for module in robot.modules],
            {tag.link: tag.number for tag in layout.links},
            generator,
            width=0.1,
        )
        writer.write(cv2.cvtColor(picture, cv2.COLOR_GRAY2BGR))
    writer.release()
    return RenderedFilm(path, robot, layout, trial, times)
