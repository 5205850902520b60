"""OpenCV, which finds tags and reads films, imported when it is first needed. It has no types here."""

import os
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from laticauda.values import TrialFileError, files, optional_import

SILENT = "-8"
"""Level at which the codecs print nothing."""


def load_opencv(feature: str) -> Any:
    """Import OpenCV.

    Args:
        feature: What needs it, in words.

    Raises:
        MissingExtra: If it is not installed.
    """
    os.environ.setdefault("OPENCV_FFMPEG_LOGLEVEL", SILENT)  # read when the first film is opened
    return optional_import(feature, "opencv-contrib-python-headless", "film", "cv2")


@contextmanager
def open_film(path: str | Path) -> Generator[Any]:
    """Open a film.

    Args:
        path: Path of the film.

    Raises:
        TrialFileError: If there is no such file, or OpenCV cannot read it.
        MissingExtra: If OpenCV is not installed.
    """
    opencv = load_opencv("Reading a film")
    path = files.local(path)
    if not path.is_file():
        raise TrialFileError(f"Cannot read {path}: there is no such file.")
    before = opencv.utils.logging.setLogLevel(0)  # its codecs print what they dislike
    capture = opencv.VideoCapture(str(path))
    try:
        if not capture.isOpened():
            raise TrialFileError(
                f"Cannot read {path}: it is no film that OpenCV reads; MP4 and AVI are safe."
            )
        yield capture
    finally:
        capture.release()
        opencv.utils.logging.setLogLevel(before)
