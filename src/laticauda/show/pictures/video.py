"""Videos that every player plays, through the system's program ffmpeg."""

import shutil
import subprocess
import tempfile
from collections.abc import Iterable, Sequence
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import IO

from laticauda.show.pictures.renderer import check_offscreen
from laticauda.show.pictures.stage import Picture
from laticauda.values import LaticaudaError, MissingProgram, write

PRESET = "veryfast"
"""Speed of the encoder: files are a seventh smaller than with `medium` on these pictures, in half the time."""
QUALITY = 20
"""Quality on H.264's scale, where lower is better and 18 looks like the original."""


class VideoFailed(LaticaudaError, RuntimeError):
    """The program ffmpeg did not write the video; the message says why."""


def check_video() -> None:
    """Check in advance that a video can be made here.

    Raises:
        MissingExtra: If MuJoCo or PyOpenGL is not installed.
        MissingProgram: If the system has no ffmpeg or no EGL.
    """
    find_ffmpeg()
    check_offscreen()


def find_ffmpeg() -> str:
    """Return the path of the program ffmpeg.

    Raises:
        MissingProgram: If the system does not have it.
    """
    program = shutil.which("ffmpeg")
    if program is None:
        raise MissingProgram("Writing a video", "the program ffmpeg", "ffmpeg")
    return program


def write_video(
    pictures: Iterable[Picture],
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
    command = _build_command(size, frames_per_second)
    write(path, partial(_encode, command, pictures, path))


def _build_command(size: tuple[int, int], frames_per_second: float) -> list[str]:
    """Return the command that encodes raw pictures from its standard input; the file is still to be appended."""
    width, height = size
    general = ["-y", "-loglevel", "error"]
    raw_input = ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{width}x{height}"]
    rate = ["-r", f"{frames_per_second:g}"]
    source = ["-i", "-", "-an"]
    encoder = ["-c:v", "libx264", "-preset", PRESET, "-crf", str(QUALITY)]
    output = ["-pix_fmt", "yuv420p", "-movflags", "+faststart"]
    return [find_ffmpeg(), *general, *raw_input, *rate, *source, *encoder, *output]


def _encode(
    command: Sequence[str], pictures: Iterable[Picture], path: str | Path, new_file: Path
) -> None:
    """Write a video to a new file, which will take the place of the one at `path`."""
    # Messages go to a file: a pipe that is not read could fill up and block ffmpeg.
    with tempfile.TemporaryFile() as messages:
        process = subprocess.Popen(
            [*command, str(new_file)], stdin=subprocess.PIPE, stderr=messages
        )
        # If the pipe is broken, ffmpeg has already ended; its status says why.
        with suppress(BrokenPipeError), process:
            assert process.stdin is not None
            for picture in pictures:
                process.stdin.write(picture.tobytes())
        if process.returncode != 0:
            raise VideoFailed(f"ffmpeg could not write {path}: {_last_message(messages)}.")


def _last_message(messages: IO[bytes]) -> str:
    messages.seek(0)
    lines = messages.read().decode(errors="replace").strip().splitlines()
    if not lines:
        return "it did not say why"
    return lines[-1]
