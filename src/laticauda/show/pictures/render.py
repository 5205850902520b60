"""Films and stills of trials: the robot in the water with its trail, a clock and its speed."""

import math
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import closing, suppress
from functools import lru_cache, partial
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from PIL import Image, ImageDraw, ImageFont

from laticauda.show.pictures import replay, stage
from laticauda.show.pictures.camera import Film, aim_at_trial, estimate_ripple_period
from laticauda.trials import Trial
from laticauda.values import (
    BadArgument,
    LaticaudaError,
    MissingProgram,
    check_positive,
    check_within,
    write,
)

# Text: margin and sizes in heights of the picture, and colors.
MARGIN, LARGE, SMALL = 0.045, 0.052, 0.029
LINE = 0.0045  # thickness of the lines, in widths of the picture
WHITE, PALE, RIM = (255, 255, 255), (200, 228, 230), (4, 30, 40)
Color = tuple[int, int, int]
PRESET = (
    "veryfast"  # files a seventh smaller than with `medium` on these pictures, in half the time
)
QUALITY = 20  # on H.264's scale, where lower is better and 18 looks like the original


def render_film(
    trial: Trial,
    path: str | Path,
    film: Film = Film(),  # noqa: B008 - frozen
    *,
    speed: float = 1.0,
    beside: Sequence[Trial] = (),
    progress: Callable[[float], None] = lambda done: None,
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
    begin, end = film.span(trial)
    if any(pixels % 2 for pixels in film.size):
        raise BadArgument("size", f"must be even for a video, got {film.size}")
    check_video()
    count = math.floor((end - begin) / step + 1e-9) + 1
    moments = [min(begin + k * step, end) for k in range(count)]

    def shown() -> Iterator[stage.Picture]:
        for moment, picture in zip(
            moments, draw_pictures(trial, film, moments, speed, beside), strict=True
        ):
            yield picture
            progress(moment - begin)

    write_video(shown(), path, size=film.size, frames_per_second=film.frames_per_second)


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
    moment = end if time is None else check_within("time", time, begin, end, "s")
    [picture] = draw_pictures(trial, film, [moment], beside=beside)
    write(path, partial(Image.fromarray(picture).save, optimize=True))


def draw_pictures(
    trial: Trial,
    film: Film,
    moments: Iterable[float],
    speed: float = 1.0,
    beside: Sequence[Trial] = (),
) -> Iterator[stage.Picture]:
    """Yield pictures of a trial, including text.

    Args:
        trial: Any trial, simulated or real.
        film: Their size and camera.
        moments: Times of the pictures [s].
        speed: Playback speed as stated in the text [-].
        beside: Trials of other robots in the same scene.
    """
    with closing(
        replay.studio_of(trial, others=[one.robot for one in beside], size=film.size)
    ) as studio:
        height, width = studio.height, LINE * film.size[0]
        path = replay.path_dashes(trial, height)
        for time in moments:

            def decorate(scene: Any, time: float = time) -> None:
                replay.draw_path(scene, path, width)
                replay.draw_trail(scene, trial, time, height, width)

            camera = aim_at_trial(trial, time, height, film)
            posture, *others = [replay.posture_at(one, time, height) for one in (trial, *beside)]
            picture = studio.picture(posture, camera, decorate, others)
            figures = [
                (f"{time - trial.time[0]:.1f}", "s"),
                (f"{speed_at(trial, time):.2f}", "m/s"),
            ]
            yield write_words(picture, figures, [*describe_run(trial, speed), *studio.water.words])


def check_video() -> None:
    """Check in advance that a video can be made here; raises the same errors as `video`."""
    ffmpeg()
    stage.check_offscreen()


def speed_at(trial: Trial, time: float) -> float:
    """Return the speed of the center of mass over the last period of the gait, and hence without its ripple [m/s]."""
    moments = max(time - estimate_ripple_period(trial), float(trial.time[0])), time
    if moments[0] == moments[1]:
        return float(np.linalg.norm(trial.center_of_mass_velocity[0]))
    start, stop = replay.interpolate_centers(trial, moments)
    return float(np.linalg.norm(stop - start)) / (moments[1] - moments[0])


def describe_run(trial: Trial, speed: float = 1.0) -> list[str]:
    """Return text on the robot, its gait, and the playback speed."""
    lines = [trial.robot.name]
    if trial.gait is not None:
        gait = trial.gait
        a, f, shift, offset = map(
            math.degrees, (gait.amplitude, gait.frequency, gait.phase_shift, gait.offset)
        )
        numbers = (
            f", {a:.3g}°, {f:.3g}°/s, phase shift {shift:.3g}°" if a or not gait.recorded else ""
        )
        lines.append(f"{gait.words}{numbers}{f', offset {offset:.3g}°' if offset else ''}")
        if gait.pitch is not None:
            numbers = f"{math.degrees(gait.pitch.amplitude):.0f}°, {math.degrees(gait.pitch.phase):.0f}° ahead"
            lines.append(f"pitch wave, {numbers}")
        if gait.fin is not None:
            lines.append(
                f"fin, {math.degrees(gait.fin.amplitude):.0f}°, {math.degrees(gait.fin.frequency):.0f}°/s"
            )
    if speed != 1.0:
        lines[0] += f"  (shown at {speed:g} times its speed)"
    return lines


def write_words(
    picture: stage.Picture, large: Sequence[tuple[str, str]], small: Sequence[str]
) -> stage.Picture:
    """Return the picture with text on it.

    Args:
        picture: The picture to write on.
        large: Figures with their units, from left to right at the top.
        small: Lines at the bottom left.
    """
    height = picture.shape[0]
    image = Image.fromarray(picture)
    margin, figure, line = (round(share * height) for share in (MARGIN, LARGE, SMALL))
    x = margin
    for number, unit in large:
        for words, size, font, color, gap in (
            (number, figure, "DejaVuSans-Bold", WHITE, 0.22),
            (unit, round(0.62 * figure), "DejaVuSans", PALE, 1.3),
        ):
            x += _write(image, (x, margin + figure), words, size, font, color) + round(gap * figure)
    for k, words in enumerate(reversed(small)):
        at = margin, height - margin - round(1.5 * line * k)
        _write(image, at, words, line, "DejaVuSans", WHITE if k == len(small) - 1 else PALE)
    return np.asarray(image)


def _write(image: Any, at: tuple[int, int], words: str, size: int, font: str, color: Color) -> int:
    """Write text with the start of its baseline at a place; return its length [pixels]."""
    label, length = _label(words, size, font, color)
    image.paste(label, (at[0] - size, at[1] - 2 * size), label)
    return length


@lru_cache(maxsize=256)
def _label(words: str, size: int, font: str, color: Color) -> tuple[Any, int]:
    """Return text with a margin and a dark outline, legible on any background, and its length [pixels].

    The font comes with matplotlib and is therefore always available.
    """
    file = Path(matplotlib.get_data_path()) / "fonts" / "ttf" / f"{font}.ttf"
    letters = ImageFont.truetype(str(file), size)
    length = round(letters.getlength(words))
    label = Image.new("RGBA", (length + 2 * size, 3 * size), (*RIM, 0))
    rim: Any = {"stroke_width": max(1, size // 16), "stroke_fill": RIM}
    ImageDraw.Draw(label).text(
        (size, 2 * size), words, font=letters, fill=color, anchor="ls", **rim
    )
    return label, length


# ---- an MP4 that every player plays, through the system's ffmpeg ---------------------------------


class VideoFailed(LaticaudaError, RuntimeError):
    """The program ffmpeg did not write the video; the message says why."""


def ffmpeg() -> str:
    """Return the path of the program ffmpeg.

    Raises:
        MissingProgram: If the system does not have it.
    """
    program = shutil.which("ffmpeg")
    if program is None:
        raise MissingProgram("Writing a video", "the program ffmpeg", "ffmpeg")
    return program


def write_video(
    pictures: Iterable[stage.Picture],
    path: str | Path,
    *,
    size: tuple[int, int],
    frames_per_second: float,
) -> None:
    """Write pictures to an MP4 file (H.264, yuv420p); an existing file is replaced upon completion.

    Args:
        pictures: Pictures, all of the same size.
        path: The file, which ends in .mp4.
        size: Width and height of a picture, both even [pixels].
        frames_per_second: Frame rate [1/s].

    Raises:
        MissingProgram: If there is no ffmpeg.
        VideoFailed: If ffmpeg fails.
        StorageFailed: If the file cannot be written.
    """
    words = [ffmpeg(), "-y", "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgb24"]
    words += [
        "-s",
        f"{size[0]}x{size[1]}",
        "-r",
        f"{frames_per_second:g}",
        "-i",
        "-",
        "-an",
        "-c:v",
        "libx264",
    ]
    words += [
        "-preset",
        PRESET,
        "-crf",
        str(QUALITY),
        "-pix_fmt",
        "yuv420p",
        "-movflags",
        "+faststart",
    ]

    def encode(new: Path) -> None:
        # Its messages go to a file: a pipe that is not read could fill up and block it.
        with tempfile.TemporaryFile() as complaints:
            process = subprocess.Popen([*words, str(new)], stdin=subprocess.PIPE, stderr=complaints)
            with (
                suppress(BrokenPipeError),
                process,
            ):  # then ffmpeg has already ended; its status says why
                assert process.stdin is not None
                for picture in pictures:
                    process.stdin.write(picture.tobytes())
            if process.returncode != 0:
                complaints.seek(0)
                lines = complaints.read().decode(errors="replace").strip().splitlines()
                raise VideoFailed(
                    f"ffmpeg could not write {path}: {lines[-1] if lines else 'it did not say why'}."
                )

    write(path, encode)
