"""Warnings about what a user asked for, at the line of the user's own code."""

import os
import sys
import warnings
from pathlib import Path

PACKAGE_FOLDER = f"{Path(__file__).parent.parent}{os.sep}"
"""Where the code of laticauda is."""


def warn_caller(message: str, category: type[Warning]) -> None:
    """Warn at the first line outside laticauda that led here.

    Args:
        message: The warning.
        category: Its class.
    """
    level = 1
    frame = sys._getframe()  # pyright: ignore[reportPrivateUsage]
    while frame.f_back is not None and frame.f_code.co_filename.startswith(PACKAGE_FOLDER):
        frame = frame.f_back
        level += 1
    warnings.warn(message, category, stacklevel=level)
