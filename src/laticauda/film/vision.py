"""OpenCV, which finds tags and reads films, imported when it is first needed. It has no types here."""

from typing import Any

from laticauda.values import optional_import


def load_opencv(feature: str) -> Any:
    """Import OpenCV.

    Args:
        feature: What needs it, in words.

    Raises:
        MissingExtra: If it is not installed.
    """
    return optional_import(feature, "opencv-contrib-python-headless", "film", "cv2")
