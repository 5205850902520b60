"""Checkerboards: the lens from several pictures of one, and marks of known places from one that lies in the plane."""

# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from jaxtyping import Float, UInt8

from laticauda.film.calibration.fitting import Marks
from laticauda.film.calibration.optics import Lens
from laticauda.film.vision import load_opencv, open_film
from laticauda.values import BadArgument, check_positive, check_whole_number, quantity, value_class

N_PICTURES = 25
"""Pictures of a film from which a lens is calibrated."""
FEWEST_PICTURES = 5
"""Pictures of a board that determine a lens, if they show it from different sides."""
WORST_FIT = 2.0
"""Residual (rms) above which a lens is none that this model has [px]."""
Picture = UInt8[np.ndarray, "height width *channels"]


@value_class
class Checkerboard:
    """A checkerboard, by its inner corners."""

    columns: int = quantity("", "Inner corners along a row", ge=3)
    rows: int = quantity("", "Inner corners along a column", ge=3)
    square: float = quantity("m", "Side of a square", gt=0.0)

    def places(self) -> Float[np.ndarray, "n 2"]:
        """Return the places of its inner corners, row by row, x along the rows [m]."""
        y, x = np.mgrid[0 : self.rows, 0 : self.columns]
        return self.square * np.column_stack((x.ravel(), y.ravel())).astype(float)


def find_corners(picture: Picture, board: Checkerboard) -> Float[np.ndarray, "n 2"] | None:
    """Return the inner corners of a checkerboard in a picture [px]; None if it is not there as a whole.

    Args:
        picture: The picture, gray or with colors.
        board: The board.
    """
    opencv = load_opencv("Finding a checkerboard")
    gray = picture
    if picture.ndim == 3:
        gray = opencv.cvtColor(picture, opencv.COLOR_BGR2GRAY)
    size = (board.columns, board.rows)
    is_found, corners = opencv.findChessboardCornersSB(gray, size, opencv.CALIB_CB_ACCURACY)
    if not is_found:
        return None
    return np.asarray(corners, dtype=float).reshape(-1, 2)


def pictures_of_film(
    path: str | Path,
    *,
    n_pictures: int = N_PICTURES,
    on_progress: Callable[[float], object] | None = None,
) -> list[Picture]:
    """Return pictures that are evenly spread over a film.

    Args:
        path: Path of the film.
        n_pictures: How many at most.
        on_progress: Called with the share that is read.

    Raises:
        TrialFileError: If it cannot be read.
        ValueError: If it is not one picture at least.
        MissingExtra: If OpenCV is not installed.
    """
    check_whole_number("n_pictures", n_pictures, 1)
    opencv = load_opencv("Reading a film")
    pictures: list[Picture] = []
    with open_film(path) as capture:
        n_frames = max(int(capture.get(opencv.CAP_PROP_FRAME_COUNT)), 1)
        step = max(n_frames // n_pictures, 1)
        frame = 0
        while capture.grab():
            if frame % step == 0:
                is_read, picture = capture.retrieve()
                if is_read:
                    pictures.append(opencv.cvtColor(picture, opencv.COLOR_BGR2GRAY))
            frame += 1
            if on_progress is not None:
                on_progress(min(frame / n_frames, 1.0))
    return pictures


def marks_of_board(picture: Picture, board: Checkerboard) -> Marks:
    """Return the corners of a board that lies in the plane as marks of known places.

    Args:
        picture: A picture of it.
        board: The board.

    Raises:
        ValueError: If it is not seen as a whole.
    """
    corners = find_corners(picture, board)
    if corners is None:
        rule = f"must show all {board.columns} x {board.rows} inner corners of the checkerboard"
        raise BadArgument("picture", rule)
    places = board.places()
    # Counted from another corner, a board is the same, but perhaps seen from below.
    first, second = corners[board.columns - 1] - corners[0], corners[-board.columns] - corners[0]
    if first[0] * second[1] - first[1] * second[0] > 0.0:  # y points down in a picture
        places[:, 1] *= -1.0
    return Marks(
        pixels=corners,
        places=places,
        groups=["checkerboard"] * len(corners),
        place_deviation=0.0002,
    )


def calibrate_lens(pictures: Sequence[Picture], board: Checkerboard) -> Lens:
    """Find a lens from pictures of a checkerboard from different sides.

    Args:
        pictures: The pictures, all of one size; those that do not show the whole board are left
            out.
        board: The board.

    Raises:
        ValueError: If too few show it, or the lens is none that the model has.
        MissingExtra: If OpenCV is not installed.
    """
    opencv = load_opencv("Calibrating a lens")
    check_whole_number("pictures", len(pictures), FEWEST_PICTURES)
    corners = [find_corners(picture, board) for picture in pictures]
    found_corners = [points.astype(np.float32) for points in corners if points is not None]
    if len(found_corners) < FEWEST_PICTURES:
        rule = f"must show the whole checkerboard in at least {FEWEST_PICTURES} pictures"
        raise BadArgument("pictures", f"{rule}, got {len(found_corners)} of {len(pictures)}")
    flat = np.column_stack((board.places(), np.zeros(board.columns * board.rows)))
    height, width = pictures[0].shape[:2]
    flags = opencv.CALIB_FIX_ASPECT_RATIO + opencv.CALIB_FIX_K3
    guess = np.array([[float(width), 0.0, 0.5 * width], [0.0, width, 0.5 * height], [0, 0, 1]])
    fit = opencv.calibrateCameraExtended(
        [flat.astype(np.float32)] * len(found_corners),
        found_corners,
        (width, height),
        guess,
        np.zeros(5),
        flags=flags + opencv.CALIB_USE_INTRINSIC_GUESS,
    )
    residual, matrix, distortion, _, _, deviations = fit[:6]
    if residual > WORST_FIT:
        rule = f"must fit a lens to {WORST_FIT:g} px, got {residual:.1f} px"
        raise BadArgument("pictures", f"{rule}; is it a fisheye, or the board bent?")
    k1, k2, p1, p2, k3 = (float(number) for number in np.ravel(distortion)[:5])
    spread = np.ravel(deviations)
    focal_length = check_positive("focal_length", float(matrix[0, 0]), "px")
    return Lens(
        image_size=(width, height),
        focal_length=focal_length,
        center=(float(matrix[0, 2]), float(matrix[1, 2])),
        distortion=(k1, k2, p1, p2, k3),
        focal_length_deviation=float(np.max(spread[:2])) / focal_length,
        center_deviation=float(np.max(spread[2:4])),
        distortion_deviation=float(spread[4]),
    )
