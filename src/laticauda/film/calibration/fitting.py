"""Lens, pose and surface of a camera from marks of known places: least squares, with an uncertainty.

Every mark is traced back from its pixel to the plane of the marks; what is left between there and
its place, in pixels, is a residual. What is known beforehand of the lens and of the surface of water
is a residual, too: the data may correct it, and what they do not see stays as uncertain as stated.
"""

# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Bool, Complex, Float, Int

from laticauda.film.calibration.calibration import CameraCalibration
from laticauda.film.calibration.optics import Lens, Pixels, Places, Surface, locate
from laticauda.film.vision import load_opencv
from laticauda.values import BadArgument, check_finite, check_not_negative, optional_import

FEWEST_MARKS = 4
"""Marks that determine a pose."""
SMALLEST_NOISE = 0.1
"""Deviation of a mark at least, however well a few of them fit [px]."""
WORST_RESIDUAL = 0.0025
"""Residual (rms), as a share of the width of the picture, above which places cannot be right [-]."""
USUAL_FOCAL_LENGTHS = (0.6, 0.9, 1.4, 2.2)
"""Focal lengths that are tried if the lens is unknown, in widths of the picture [-]."""
UNKNOWN_LENS = {
    "focal_length_deviation": 0.5,
    "center_deviation": 0.01,
    "distortion_deviation": 0.15,
}
"""Deviations of a lens of which nothing is known; that of the center in widths of the picture."""
WIDEST = 6.0
"""Distance from what is known beforehand at most, in standard deviations."""
POSE_SCALE = 0.01
"""Size of a usual step of a rotation [rad] or a translation [m]."""
MOST_STEPS = 40
"""Steps of a search at most."""
N_DRAWS = 200
"""Draws from the covariance from which the deviations of lengths and places are found."""
N_GRID = 6
"""Points along each side of the grid at which they are found."""
FEWEST_ON_LINE = 3
"""Tags from which on a line is refused."""
NARROWEST = 0.05
"""Width of a pattern of tags, by its length, at least [-]."""
FEWEST_FOR_LENS = 16
"""Points of marks from which a lens may be contradicted."""
BETTER_LENS = 0.5
"""Residual with another lens, by that with the given one, below which the given one is wrong [-]."""
SMALL_RESIDUAL = 0.5
"""Residual up to which a given lens is right enough [px]."""
CORNERS_OF_TAG = 4
Vector = Float[np.ndarray, " n_parameters"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Marks:
    """Marks seen by the camera whose places in their plane are known."""

    pixels: Pixels
    """Where the camera sees them [px]."""
    places: Places
    """Where they are [m]."""
    groups: Sequence[str]
    """Name of the tag, or of what else, that each belongs to."""
    place_deviation: float = 0.001
    """Standard deviation of the place of a tag, as it was measured or printed [m]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class _Model:
    """What the parameters mean: a pose, and corrections of lens and surface."""

    lens: Lens
    surface: Surface | None

    def unpack(self, vector: Vector) -> dict[str, Any]:
        """Return the arguments of `locate`, without the height of the plane."""
        return {
            "lens": self._lens_at(vector),
            "rotation": vector[:3],
            "translation": vector[3:6],
            "surface": self._surface_at(vector),
        }

    def _lens_at(self, vector: Vector) -> Lens:
        log_focal_length, x, y, k1, k2 = vector[6:11]
        return replace(
            self.lens,
            focal_length=float(np.exp(log_focal_length)),
            center=(float(x), float(y)),
            distortion=(float(k1), float(k2), *self.lens.distortion[2:]),
        )

    def _surface_at(self, vector: Vector) -> Surface | None:
        if self.surface is None:
            return None
        height = float(vector[11])
        index = float(np.clip(vector[12], 1.0, 2.0))
        return replace(self.surface, height=height, index=index)

    def expected(self) -> tuple[Float[np.ndarray, " n_known"], Float[np.ndarray, " n_known"]]:
        """Return what is known beforehand of all parameters after the pose, and its deviations."""
        lens = self.lens
        k1, k2 = lens.distortion[:2]
        values = [np.log(lens.focal_length), *lens.center, k1, k2]
        deviations = [
            lens.focal_length_deviation,
            lens.center_deviation,
            lens.center_deviation,
            lens.distortion_deviation,
            3.0 * lens.distortion_deviation,
        ]
        if self.surface is not None:
            values += [self.surface.height, self.surface.index]
            deviations += [self.surface.height_deviation, self.surface.index_deviation]
        smallest = 1e-9  # what is certain stays as it is
        return np.array(values), np.maximum(deviations, smallest)


def calibrate_camera(
    marks: Marks,
    image_size: tuple[int, int],
    *,
    lens: Lens | None = None,
    surface: Surface | None = None,
    plane_height: float = 0.0,
    plane_height_deviation: float = 0.002,
) -> CameraCalibration:
    """Find pose and lens of a camera from marks in one plane.

    Args:
        marks: The marks; well spread over the picture, they tell the lens, too.
        image_size: Width and height of the picture [px].
        lens: The lens, if it was calibrated; None: found from the marks, as far as they tell.
        surface: Surface of water or window between the camera and what lies behind.
        plane_height: Height of the plane of motion above that of the marks [m].
        plane_height_deviation: Standard deviation of this height [m].

    Raises:
        ValueError: If there are too few marks, or their places cannot be right; the message names
            the worst tag.
        MissingExtra: If OpenCV or SciPy is not installed.
    """
    check_finite("plane_height", plane_height, "m")
    check_not_negative("plane_height_deviation", plane_height_deviation, "m")
    if len(marks.pixels) < FEWEST_MARKS:
        raise BadArgument(
            "marks", f"must be at least {FEWEST_MARKS} points, got {len(marks.pixels)}"
        )
    spread = np.linalg.svd(marks.places - marks.places.mean(axis=0), compute_uv=False)
    if spread[1] < 1e-3 * spread[0]:
        raise BadArgument("marks", "must not lie on one line")
    _check_spread(marks)
    candidates = _candidate_lenses(lens, image_size)
    models = [_Model(lens=candidate, surface=surface) for candidate in candidates]
    fits = [_search(marks, model) for model in models]
    best = min(range(len(fits)), key=lambda i: fits[i].cost)
    # The best guess is the start; what is known beforehand of the lens remains the same.
    model = models[best]
    start = fits[best].x
    _check_residuals(marks, model, start, image_size)
    noise = _noise_of(marks, model, start)
    solution = _search(marks, model, start=start, noise=noise, loss="linear")
    if lens is not None:
        _check_lens(marks, model, solution.x)
    residual = _residual_of(marks, model, solution.x)
    covariance = np.linalg.pinv(solution.jac.T @ solution.jac)
    deviations = np.sqrt(np.diag(covariance))
    calibration = CameraCalibration(
        **_stored(model.unpack(solution.x), deviations),
        plane_height=plane_height,
        plane_height_deviation=plane_height_deviation,
        residual=residual,
    )
    return _with_deviations(calibration, marks, model, solution.x, covariance)


def _check_spread(marks: Marks) -> None:
    """Refuse three tags or more on one line: beside it, places would only be guessed."""
    names = dict.fromkeys(marks.groups)
    groups = np.array(list(marks.groups))
    centers = np.array([marks.places[groups == name].mean(axis=0) for name in names])
    if len(centers) < FEWEST_ON_LINE:
        return
    spread = np.linalg.svd(centers - centers.mean(axis=0), compute_uv=False)
    if spread[1] < NARROWEST * spread[0]:
        rule = "must not all lie on one line, beside which nothing would be known"
        raise BadArgument("marks", f"{rule}; put tags on both sides of the swimming area")


def _check_lens(marks: Marks, model: _Model, vector: Vector) -> None:
    """Refuse a lens that was calibrated, if the marks are met far better by another one."""
    if len(marks.pixels) < FEWEST_FOR_LENS:
        return
    residual = _residual_of(marks, model, vector)
    width, _ = model.lens.image_size
    unknown = replace(
        model.lens,
        focal_length_deviation=UNKNOWN_LENS["focal_length_deviation"],
        center_deviation=UNKNOWN_LENS["center_deviation"] * width,
        distortion_deviation=UNKNOWN_LENS["distortion_deviation"],
    )
    free = _Model(lens=unknown, surface=model.surface)
    best = _search(marks, free, start=vector).x
    residual_without = _residual_of(marks, free, best)
    if residual < SMALL_RESIDUAL or residual_without > BETTER_LENS * residual:
        return
    raise BadArgument(
        "lens",
        f"must be that of this film: tags on the floor fit to {residual:.2f} px with it, and to "
        f"{residual_without:.2f} px with one of k1 = {best[9]:.3f} instead of {model.lens.distortion[0]:.3f}; "
        "was it another camera, zoom or mode? Leave it out, and the tags tell the lens",
    )


def _stored(arguments: dict[str, Any], deviations: Vector) -> dict[str, Any]:
    """Return fields of a calibration; the lens is as certain as the marks have made it."""
    stored = dict(arguments)
    stored["lens"] = replace(
        arguments["lens"],
        focal_length_deviation=float(deviations[6]),
        center_deviation=float(np.max(deviations[7:9])),
        distortion_deviation=float(deviations[9]),
    )
    for name in ("rotation", "translation"):
        stored[name] = tuple(float(number) for number in arguments[name])
    return stored


def _candidate_lenses(lens: Lens | None, image_size: tuple[int, int]) -> list[Lens]:
    if lens is not None:
        return [lens.scaled_to(image_size)]
    return [_guess_lens(share, image_size) for share in USUAL_FOCAL_LENGTHS]


def _guess_lens(share: float, image_size: tuple[int, int]) -> Lens:
    """Return a lens of which nothing is known, with a focal length by the width of the picture."""
    width, height = image_size
    return Lens(
        image_size=image_size,
        focal_length=share * width,
        center=(0.5 * (width - 1), 0.5 * (height - 1)),
        focal_length_deviation=UNKNOWN_LENS["focal_length_deviation"],
        center_deviation=UNKNOWN_LENS["center_deviation"] * width,
        distortion_deviation=UNKNOWN_LENS["distortion_deviation"],
    )


# ---- search --------------------------------------------------------------------------------------


def _search(
    marks: Marks,
    model: _Model,
    start: Vector | None = None,
    noise: float = 1.0,
    loss: str = "soft_l1",
) -> Any:
    """Return the parameters of least squares, as SciPy returns them; a soft loss lets a wrong mark stand out."""
    optimize: Any = optional_import("Calibrating a camera", "scipy", "film", "scipy.optimize")
    expected, deviations = model.expected()
    if start is None:
        start = np.concatenate((_first_pose(marks, model.lens), expected))

    def residuals(vector: Vector) -> Float[np.ndarray, " n_residuals"]:
        in_pixels = _residuals_in_pixels(marks, model, vector, noise)
        from_expected = (vector[6:] - expected) / deviations
        return np.concatenate((in_pixels, from_expected))

    scale = np.concatenate((np.full(6, POSE_SCALE), deviations))
    reach = np.concatenate((np.full(6, np.inf), WIDEST * deviations))
    middle = np.concatenate((np.zeros(6), expected))
    return optimize.least_squares(
        residuals,
        start,
        bounds=(middle - reach, middle + reach),
        x_scale=scale,
        loss=loss,
        max_nfev=MOST_STEPS,
    )


def _first_pose(marks: Marks, lens: Lens) -> Float[np.ndarray, " 6"]:
    """Return rotation vector and translation, as if there were no water."""
    opencv = load_opencv("Calibrating a camera")
    x, y = lens.center
    matrix = np.diag([lens.focal_length, lens.focal_length, 1.0])
    matrix[:2, 2] = (x, y)
    places = np.column_stack((marks.places, np.zeros(len(marks.places))))
    middle = places.mean(axis=0)
    is_found, rotation, translation = opencv.solvePnP(
        places - middle,
        np.ascontiguousarray(marks.pixels),
        matrix,
        np.array(lens.distortion),
        flags=opencv.SOLVEPNP_IPPE,
    )
    if not is_found:
        raise BadArgument("marks", "must be seen from a place from which they form their pattern")
    turned = opencv.Rodrigues(rotation)[0]
    return np.concatenate((rotation.ravel(), translation.ravel() - turned @ middle))


def _residuals_in_pixels(
    marks: Marks, model: _Model, vector: Vector, noise: float
) -> Float[np.ndarray, " n_residuals"]:
    """Return what is left between marks and their places, over its deviation."""
    traced = _trace_marks(marks, model, vector)
    misplaced = traced.places - marks.places
    in_pixels = np.einsum("nij,nj->ni", np.linalg.pinv(traced.per_pixel), misplaced)
    in_pixels[~traced.meets_plane] = FAR_AWAY
    pixel_size = np.sqrt(np.abs(np.linalg.det(traced.per_pixel)))
    pixel_size = np.maximum(pixel_size, SMALLEST_PIXEL)
    # Beside a ray that misses the plane, the error of a place is nothing.
    pixel_size = np.where(traced.meets_plane, pixel_size, np.inf)
    # The corners of a tag are misplaced together, so that they count like one.
    place_deviation = np.sqrt(CORNERS_OF_TAG) * marks.place_deviation / pixel_size
    deviation = np.hypot(noise, place_deviation)
    return (in_pixels / deviation[:, np.newaxis]).ravel()


class _TracedMarks(NamedTuple):
    """Where the rays of marks meet their plane."""

    places: Places
    """Where they meet it; 0 where they do not [m]."""
    per_pixel: Float[np.ndarray, "n_marks 2 2"]
    """By how much the place moves along x and y (rows) with a pixel to the right and down (columns) [m]."""
    meets_plane: Bool[np.ndarray, " n_marks"]
    """Whether they meet it, and those of the next pixels do, too."""


def _trace_marks(marks: Marks, model: _Model, vector: Vector) -> _TracedMarks:
    """Return where the rays of marks, and of the pixels to the right and below, meet the plane."""
    shifts = ((0, 0), (1, 0), (0, 1))
    pixels = np.concatenate([marks.pixels + shift for shift in shifts])
    places = locate(pixels, plane_height=0.0, **model.unpack(vector))
    places = places.reshape(len(shifts), len(marks.pixels), 2)
    meets_plane = np.isfinite(np.sum(places, axis=(0, 2)))
    places = np.where(meets_plane[:, np.newaxis], places, 0.0)
    per_pixel = np.stack((places[1] - places[0], places[2] - places[0]), axis=-1)
    return _TracedMarks(places=places[0], per_pixel=per_pixel, meets_plane=meets_plane)


FAR_AWAY = 1e4
"""Residual of a mark whose ray does not meet the plane [px]."""
SMALLEST_PIXEL = 1e-9
"""Size of a pixel in the plane at least [m]."""


def _distances(marks: Marks, model: _Model, vector: Vector) -> Float[np.ndarray, " n_marks"]:
    """Return how far each mark is from where its place says [px]."""
    exact = replace(marks, place_deviation=0.0)
    residuals = _residuals_in_pixels(exact, model, vector, noise=1.0)
    return np.linalg.norm(residuals.reshape(-1, 2), axis=1)


def _residual_of(marks: Marks, model: _Model, vector: Vector) -> float:
    return float(np.sqrt(np.mean(_distances(marks, model, vector) ** 2)))


def _noise_of(marks: Marks, model: _Model, vector: Vector) -> float:
    """Return the deviation of a coordinate of a mark that the residuals show [px]."""
    squares = float(np.sum(_distances(marks, model, vector) ** 2))
    n_free = max(2 * len(marks.pixels) - vector.size, 2)
    return max(float(np.sqrt(squares / n_free)), SMALLEST_NOISE)


def _check_residuals(
    marks: Marks, model: _Model, vector: Vector, image_size: tuple[int, int]
) -> None:
    """Refuse places that cannot be right, and name the tag without which all others fit."""
    residual = _residual_of(marks, model, vector)
    if residual <= WORST_RESIDUAL * image_size[0]:
        return
    names = list(dict.fromkeys(marks.groups))
    if len(names) == 1:
        rule = f"must be where their places say, but they are {residual:.1f} px off"
        raise BadArgument("marks", f"{rule}; measure them again")
    fits = {name: _fit_without(name, marks, model, vector) for name in names}
    worst = min(names, key=lambda name: fits[name].residual_of_others)
    if fits[worst].residual_of_others > WORST_RESIDUAL * image_size[0]:
        raise BadArgument(
            "marks",
            f"must be where their places say, but they are {residual:.0f} px off, and no single tag is to blame: "
            "are places and sizes in m, y to the left of x (else they are mirrored), and arrows along x?",
        )
    raise BadArgument(
        "marks",
        f"must be where their places say, but {worst} is {fits[worst].distance:.0f} px off; "
        "measure its place, size and direction again",
    )


class _FitWithout(NamedTuple):
    """A fit without one tag."""

    residual_of_others: float
    distance: float
    """How far the tag is from where its place says [px]."""


def _fit_without(name: str, marks: Marks, model: _Model, vector: Vector) -> _FitWithout:
    is_own = np.array([group == name for group in marks.groups])
    other_marks = _select(marks, ~is_own)
    if len(other_marks.pixels) < FEWEST_MARKS:
        return _FitWithout(residual_of_others=np.inf, distance=np.inf)
    best = _search(other_marks, model, start=vector).x
    return _FitWithout(
        residual_of_others=_residual_of(other_marks, model, best),
        distance=_residual_of(_select(marks, is_own), model, best),
    )


def _select(marks: Marks, is_chosen: Bool[np.ndarray, " n"]) -> Marks:
    groups = [group for group, chosen in zip(marks.groups, is_chosen, strict=True) if chosen]
    return replace(
        marks,
        pixels=marks.pixels[is_chosen],
        places=marks.places[is_chosen],
        groups=groups,
    )


# ---- uncertainty ---------------------------------------------------------------------------------


def _with_deviations(
    calibration: CameraCalibration,
    marks: Marks,
    model: _Model,
    vector: Vector,
    covariance: Float[np.ndarray, "n_parameters n_parameters"],
) -> CameraCalibration:
    """Return the calibration with the deviations of lengths and places, from draws of all parameters."""
    generator = np.random.default_rng(0)
    grid = _grid_over(marks.pixels)
    expected = calibration.to_plane(grid)
    is_known = _is_finite(expected)
    draws = generator.multivariate_normal(vector, covariance, size=N_DRAWS, method="svd")
    heights = generator.normal(
        calibration.plane_height, calibration.plane_height_deviation, size=N_DRAWS
    )
    scales: list[float] = []
    remainders: list[float] = []
    for draw, height in zip(draws, heights, strict=True):
        places = locate(grid, plane_height=height, **model.unpack(draw))
        is_usable = is_known & _is_finite(places)
        if np.count_nonzero(is_usable) < FEWEST_MARKS:
            continue
        difference = compare_shapes(expected[is_usable], places[is_usable])
        remainders.append(difference.remainder)
        scales_of_quarters = _compare_quarters(expected, places, is_usable)
        scales += scales_of_quarters or [difference.scale]
    if not scales:
        rule = "must be a plane that the camera sees where the marks are: below it, and not beyond the horizon"
        raise BadArgument("plane_height", f"{rule}, got {calibration.plane_height:g} m")
    errors_of_scale = np.array(scales) - 1.0
    return replace(
        calibration,
        scale_deviation=float(np.sqrt(np.mean(errors_of_scale**2))),
        position_deviation=float(np.sqrt(np.mean(np.square(remainders)))),
    )


def _is_finite(places: Places) -> Bool[np.ndarray, " n"]:
    return np.all(np.isfinite(places), axis=1)


def _grid_over(pixels: Pixels) -> Float[np.ndarray, "n_grid 2"]:
    """Return a grid over the part of the picture that holds the marks [px]."""
    corners = (pixels.min(axis=0), pixels.max(axis=0))
    columns, rows = np.linspace(*corners, N_GRID).T
    x, y = np.meshgrid(columns, rows)
    return np.column_stack((x.ravel(), y.ravel()))


def _compare_quarters(
    expected: Places, places: Places, is_usable: Bool[np.ndarray, " n_grid"]
) -> list[float]:
    """Return the scale of every quarter of the grid all of whose places are known."""
    scales: list[float] = []
    for quarter in _quarters_of_grid():
        if np.all(is_usable[quarter]):
            scales.append(compare_shapes(expected[quarter], places[quarter]).scale)
    return scales


def _quarters_of_grid() -> list[Int[np.ndarray, " n_quarter"]]:
    """Return the points of every quarter of the grid: a path through one of them has the scale that is there."""
    numbers = np.arange(N_GRID * N_GRID).reshape(N_GRID, N_GRID)
    half = N_GRID // 2
    sides = (slice(0, half), slice(half, N_GRID))
    quarters: list[np.ndarray] = []
    for rows in sides:
        for columns in sides:
            quarters.append(numbers[rows, columns].ravel())
    return quarters


class ShapeDifference(NamedTuple):
    """How one set of places differs from another."""

    scale: float
    remainder: float
    """What is left (rms) after shift, turn and scale [m]."""


def compare_shapes(first: Places, second: Places) -> ShapeDifference:
    """Return the scale from one set of places to another, and what is left (rms) after shift, turn and scale.

    Args:
        first: Places [m].
        second: The same places, by another measurement [m].
    """
    first_shape = _centered_numbers(first)
    second_shape = _centered_numbers(second)
    # As complex numbers, turn and scale are one factor, found by least squares.
    factor = np.vdot(first_shape, second_shape) / np.vdot(first_shape, first_shape)
    remainders = np.abs(second_shape - factor * first_shape)
    return ShapeDifference(
        scale=float(np.abs(factor)),
        remainder=float(np.sqrt(np.mean(remainders**2))),
    )


def _centered_numbers(places: Places) -> Complex[np.ndarray, " n"]:
    """Return places as numbers x + i y, less their mean [m]."""
    return (places - places.mean(axis=0)) @ np.array([1.0, 1.0j])
