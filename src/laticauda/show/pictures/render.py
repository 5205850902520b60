"""Films and stills of trials: the robot in the water with its trail, a clock and its speed."""

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import closing
from functools import partial
from pathlib import Path
from typing import Any

from PIL import Image

from laticauda.show.pictures.camera import Film, aim_at_trial
from laticauda.show.pictures.captions import Figure, write_captions
from laticauda.show.pictures.description import describe_run, measure_speed
from laticauda.show.pictures.lines import Dash, dash_path, draw_path, draw_trail
from laticauda.show.pictures.posture import Posture, interpolate_posture
from laticauda.show.pictures.stage import Picture, Studio
from laticauda.show.pictures.video import check_video, write_video
from laticauda.trials import Trial
from laticauda.values import BadArgument, check_positive, check_within, renamed_names, write

LINE_WIDTH = 0.0045
"""Width of the lines, in widths of the picture."""
Progress = Callable[[float], None]
"""Called with the filmed duration of a trial [s]."""

__getattr__ = renamed_names(__name__, {"video": "render_film", "still": "write_still"})


def ignore_progress(duration: float) -> None:
    """Do nothing."""


def render_film(
    trial: Trial,
    path: str | Path,
    film: Film = Film(),  # noqa: B008 - frozen
    *,
    speed: float = 1.0,
    beside: Sequence[Trial] = (),
    progress: Progress = ignore_progress,
) -> None:
    """Write a film of a trial.

    A planar trial is shown unchanged: the 3D robot takes its postures, without a new simulation.

    Args:
        trial: Any trial, simulated or real.
        path: An MP4 file, written when the film is complete.
        film: Its size (which must be even), frame rate, part of the trial, and camera.
        speed: Playback speed; 2 is twice as fast [-].
        beside: Trials of other robots in the same scene, from `laticauda.swim_together`.
        progress: Called with the filmed duration of the trial [s].

    Raises:
        MissingExtra: If MuJoCo or PyOpenGL is not installed.
        MissingProgram: If the system has no ffmpeg or no EGL.
        ValueError: If an argument is out of range.
    """
    step = check_positive("speed", speed) / film.frames_per_second
    moments = _film_moments(trial, film, step)
    if any(pixels % 2 for pixels in film.size):
        raise BadArgument("size", f"must be even for a video, got {film.size}")
    check_video()
    pictures = draw_pictures(trial, film, moments, speed, beside)
    write_video(
        _report_progress(pictures, moments, progress),
        path,
        size=film.size,
        frames_per_second=film.frames_per_second,
    )


def _film_moments(trial: Trial, film: Film, step: float) -> list[float]:
    """Return the times of a film's pictures, which are one step apart [s]."""
    begin, end = film.span(trial)
    n_pictures = math.floor((end - begin) / step + 1e-9) + 1
    return [min(begin + index * step, end) for index in range(n_pictures)]


def _report_progress(
    pictures: Iterator[Picture], moments: Sequence[float], progress: Progress
) -> Iterator[Picture]:
    """Yield the pictures; once each is written, report the time since the first one."""
    for picture, moment in zip(pictures, moments, strict=True):
        yield picture
        progress(moment - moments[0])


def write_still(
    trial: Trial,
    path: str | Path,
    film: Film = Film(),  # noqa: B008 - frozen
    *,
    time: float | None = None,
    beside: Sequence[Trial] = (),
) -> None:
    """Write a picture of one moment of a trial, as in a film.

    Args:
        trial: Any trial, simulated or real.
        path: A PNG file.
        film: Its size and camera.
        time: The moment [s]; None: the end of the film.
        beside: Trials of other robots in the same scene.
    """
    begin, end = film.span(trial)
    moment = end
    if time is not None:
        moment = check_within("time", time, begin, end, "s")
    [picture] = draw_pictures(trial, film, [moment], beside=beside)
    image = Image.fromarray(picture)
    write(path, partial(image.save, optimize=True))


def draw_pictures(
    trial: Trial,
    film: Film,
    moments: Iterable[float],
    speed: float = 1.0,
    beside: Sequence[Trial] = (),
) -> Iterator[Picture]:
    """Yield pictures of a trial, including text.

    Args:
        trial: Any trial, simulated or real.
        film: Their size and camera.
        moments: Times of the pictures [s].
        speed: Playback speed as stated in the text [-].
        beside: Trials of other robots in the same scene.
    """
    more_robots = [trial_beside.robot for trial_beside in beside]
    with closing(Studio.of_trial(trial, more_robots=more_robots, size=film.size)) as studio:
        height = studio.height
        path = dash_path(trial, height)
        lines = [*describe_run(trial, speed), *studio.water.captions]
        for time in moments:
            picture = studio.picture(
                posture=interpolate_posture(trial, time, height),
                camera=aim_at_trial(trial, time, height, film),
                decorate=partial(_draw_lines, trial, film, path, time, height),
                more_postures=_interpolate_all(beside, time, height),
            )
            yield write_captions(picture, _figures_at(trial, time), lines)


def _interpolate_all(trials: Sequence[Trial], time: float, height: float) -> list[Posture]:
    """Return the postures of the robots of several trials at some time [s]."""
    return [interpolate_posture(trial, time, height) for trial in trials]


def _draw_lines(
    trial: Trial, film: Film, path: Sequence[Dash], time: float, height: float, scene: Any
) -> None:
    """Draw path and trail at some time [s] in a scene, for a planar robot at some height [m]."""
    picture_width, _ = film.size
    width = LINE_WIDTH * picture_width
    draw_path(scene, path, width)
    draw_trail(scene, trial, time, height, width)


def _figures_at(trial: Trial, time: float) -> list[Figure]:
    """Return the figures of a picture: the time since the start of the trial, and the speed."""
    return [
        Figure(f"{time - trial.time[0]:.1f}", "s"),
        Figure(f"{measure_speed(trial, time):.2f}", "m/s"),
    ]
