"""Renders the two films that ship with laticauda: Mamba swims, and glides, in a tank that was never built.

    python campaigns/example_films.py   # writes src/laticauda/film/example/swim.mp4, glide.mp4 and tags.toml

The camera looks down at a slant through 30 cm of water, with a lens that distorts; the tags on the
robot are 10 cm above those on the floor. `_rendered_films` traces the rays. The true coefficient of
friction is 0.045.
"""

import math
from dataclasses import replace
from pathlib import Path

import _rendered_films as films
import cv2
import numpy as np

import laticauda as lc
from laticauda.film.tags import TagLayout, propose_layout, save_layout
from laticauda.robot import kinematics

FOLDER = Path(__file__).parent.parent / "src" / "laticauda" / "film" / "example"
FRAME_RATES = {"swim": 12.0, "glide": 6.0}  # 1/s
LEVEL, SURFACE, FRICTION = 0.1, 0.3, 0.045  # m, m, -
CAMERA = films.Camera(
    size=(1280, 720),
    focal=1000.0,
    k1=-0.06,
    k2=0.01,
    eye=(1.5, -1.2, 3.0),
    target=(1.5, 0.85, 0.0),
    surface=SURFACE,
)


def motions() -> dict[str, tuple[lc.Trial, float, float]]:
    """The true motions, with the times at which their films begin and end [s]."""
    robot = lc.load_robot("mamba")
    water = replace(lc.load_water("paper-lateral"), tangential_friction=FRICTION)
    gait = lc.lateral_undulation(
        amplitude=math.radians(25), frequency=math.radians(150), phase_shift=math.radians(40)
    )
    still = lc.lateral_undulation(amplitude=0.0, frequency=0.0, phase_shift=0.0)
    swim = lc.swim(
        robot,
        gait,
        7.0,
        environment=water,
        start=lc.Start(center_of_mass=(0.75, 0.75), heading=0.1),
    )
    start = lc.Start(velocity=0.4, center_of_mass=(1.0, 0.8), heading=0.15)
    glide = lc.swim(robot, still, 4.0, environment=water, start=start)
    return {"swim": (swim, 3.0, 6.0), "glide": (glide, 0.0, 4.0)}


def write_film(
    scene: films.Scene,
    trial: lc.Trial,
    layout: TagLayout,
    times: np.ndarray,
    frame_rate: float,
    path: Path,
) -> None:
    """Write the film of a motion."""
    chain = trial.robot.planar()
    centers = kinematics.Posture(chain, trial.center_of_mass[:, :2], trial.link_angle).link_centers
    lengths = np.array([module.length for module in chain.modules])
    generator = np.random.default_rng(0)
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter_fourcc(*"mp4v"), frame_rate, CAMERA.size)
    for time in times:
        center = np.empty((chain.n_links, 2))
        for link in range(chain.n_links):
            for axis in (0, 1):
                center[link, axis] = np.interp(time, trial.time, centers[:, link, axis])
        angle = np.array([np.interp(time, trial.time, column) for column in trial.link_angle.T])
        tags = {tag.link: tag.number for tag in layout.links}
        picture = scene.picture(center, angle, lengths, tags, generator, width=0.1)
        writer.write(cv2.cvtColor(picture, cv2.COLOR_GRAY2BGR))
    writer.release()


def main() -> None:
    FOLDER.mkdir(exist_ok=True)
    layout = propose_layout(lc.load_robot("mamba"))
    save_layout(layout, FOLDER / "tags.toml")
    scene = films.Scene(
        camera=CAMERA,
        floor_tags={tag.number: (tag.x, tag.y, tag.angle) for tag in layout.floor},
        floor_size=layout.floor_size,
        level=LEVEL,
        body_size=layout.link_size,
        noise=0.0,
    )
    for name, (trial, begin, end) in motions().items():
        path = FOLDER / f"{name}.mp4"
        rate = FRAME_RATES[name]
        write_film(scene, trial, layout, np.arange(begin, end, 1.0 / rate), rate, path)
        print(path.name, path.stat().st_size)


if __name__ == "__main__":
    main()
