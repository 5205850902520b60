"""From pixels to metres: a camera is calibrated by marks of known places, a checkerboard, or a ruler.

optics       rays of a camera: lens, pose, a flat surface of water
calibration  what a calibration knows, its uncertainty, its file; points from px to m
fitting      lens and pose from marks of known places
boards       checkerboards: a lens from several pictures, marks from one
"""

from typing import TYPE_CHECKING

from laticauda.values import lazy_exports

if TYPE_CHECKING:
    from laticauda.film.calibration.boards import (
        Checkerboard as Checkerboard,
        calibrate_lens as calibrate_lens,
        find_corners as find_corners,
        marks_of_board as marks_of_board,
        pictures_of_film as pictures_of_film,
    )
    from laticauda.film.calibration.calibration import (
        Calibration as Calibration,
        CameraCalibration as CameraCalibration,
        RulerCalibration as RulerCalibration,
        calibrate_by_ruler as calibrate_by_ruler,
        describe_certainty as describe_certainty,
        load_calibration as load_calibration,
        load_lens as load_lens,
        points_on_plane as points_on_plane,
        save_calibration as save_calibration,
    )
    from laticauda.film.calibration.fitting import (
        Marks as Marks,
        calibrate_camera as calibrate_camera,
    )
    from laticauda.film.calibration.optics import Lens as Lens, Surface as Surface

__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {
        "laticauda.film.calibration.boards": [
            "Checkerboard",
            "calibrate_lens",
            "find_corners",
            "marks_of_board",
            "pictures_of_film",
        ],
        "laticauda.film.calibration.calibration": [
            "Calibration",
            "CameraCalibration",
            "RulerCalibration",
            "calibrate_by_ruler",
            "describe_certainty",
            "load_calibration",
            "load_lens",
            "points_on_plane",
            "save_calibration",
        ],
        "laticauda.film.calibration.fitting": ["Marks", "calibrate_camera"],
        "laticauda.film.calibration.optics": ["Lens", "Surface"],
    },
)
