"""Pictures into files: an MP4 that every player plays, through the system's ffmpeg."""

import shutil
import subprocess
import tempfile
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path

from laticauda.errors import LaticaudaError, MissingProgram
from laticauda.pictures.offscreen import Picture

QUALITY = 20  # of H.264's scale, on which less is better and 18 looks like the original


class VideoFailed(LaticaudaError, RuntimeError):
    """The program ffmpeg did not write the video: it says why."""


def ffmpeg() -> str:
    """The program.

    Raises:
        MissingProgram: If the system does not have it.
    """
    program = shutil.which("ffmpeg")
    if program is None:
        raise MissingProgram("Writing a video", "the program ffmpeg", "ffmpeg")
    return program


def write_video(
    pictures: Iterable[Picture], path: str | Path, *, size: tuple[int, int], frames_per_second: float
) -> None:
    """Write pictures to an MP4 file (H.264, yuv420p); an older file is replaced when all is written.

    Args:
        pictures: All of the same size.
        path: The file, which ends in .mp4.
        size: Width and height of a picture, both even [pixels].
        frames_per_second: [1/s].

    Raises:
        MissingProgram: If there is no ffmpeg.
        VideoFailed: If it gives up.
    """
    path = Path(path)
    unfinished = path.with_name(f".{path.stem}.unfinished.mp4")
    words = [ffmpeg(), "-y", "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgb24"]
    words += ["-s", f"{size[0]}x{size[1]}", "-r", f"{frames_per_second:g}", "-i", "-", "-an", "-c:v", "libx264"]
    words += ["-preset", "medium", "-crf", str(QUALITY), "-pix_fmt", "yuv420p", "-movflags", "+faststart"]
    # Its complaints go to a file: a pipe that nobody reads could fill up and stop it.
    with tempfile.TemporaryFile() as complaints:
        process = subprocess.Popen([*words, str(unfinished)], stdin=subprocess.PIPE, stderr=complaints)
        assert process.stdin is not None
        try:
            with suppress(BrokenPipeError):  # then it has ended already; its status says why
                for picture in pictures:
                    process.stdin.write(picture.tobytes())
                process.stdin.close()
            if process.wait() != 0:
                complaints.seek(0)
                lines = complaints.read().decode(errors="replace").strip().splitlines()
                raise VideoFailed(f"ffmpeg could not write {path}: {lines[-1] if lines else 'it did not say why'}.")
            unfinished.replace(path)
        finally:
            if process.poll() is None:
                process.kill()
                process.wait()
            with suppress(BrokenPipeError):
                process.stdin.close()
            unfinished.unlink(missing_ok=True)
