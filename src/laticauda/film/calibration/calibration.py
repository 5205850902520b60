"""From pixels to metres: what a calibration knows, its uncertainty, and the file that keeps it."""

from dataclasses import replace
from pathlib import Path
from typing import TypeAlias

import numpy as np

from laticauda.film.calibration.optics import (
    Lens,
    Pixels,
    Places,
    Surface,
    locate,
    rotation_matrix,
)
from laticauda.film.points import TrackedPoints
from laticauda.values import (
    BadArgument,
    TrialFileError,
    check_instance,
    codec,
    files,
    option,
    quantity,
    value_class,
)

N_CORRECTIONS = 8
"""Steps of Newton's method from a place to its pixel."""
MARGIN = 0.02
"""Share of the picture by which points may lie outside: a tracker extrapolates a little [-]."""


@value_class
class CameraCalibration:
    """A camera whose lens and pose are known, and the plane that a body moves in."""

    lens: Lens = option("The lens")
    rotation: tuple[float, float, float] = quantity(
        "rad", "Rotation vector from the axes of the tags to those of the camera"
    )
    translation: tuple[float, float, float] = quantity(
        "m", "Origin of the tags in the axes of the camera"
    )
    plane_height: float = quantity(
        "m", "Height of the plane of motion above that of the tags", default=0.0
    )
    plane_height_deviation: float = quantity(
        "m", "Standard deviation of this height", default=0.002, ge=0.0
    )
    surface: Surface | None = option("Surface of water between, if any", default=None)
    residual: float = quantity(
        "px", "Distance of the marks from where their places say (rms)", default=0.0, ge=0.0
    )
    scale_deviation: float = quantity(
        "", "Standard deviation of lengths in the plane, as a share", default=0.0, ge=0.0
    )
    position_deviation: float = quantity(
        "m",
        "Further standard deviation of places, beyond scale, shift and turn",
        default=0.0,
        ge=0.0,
    )

    @property
    def image_size(self) -> tuple[int, int]:
        """Width and height of the picture [px]."""
        return self.lens.image_size

    def to_plane(self, pixels: Pixels) -> Places:
        """Return places in the plane of motion [m]; nan above the horizon.

        Args:
            pixels: Pixels.
        """
        return locate(
            pixels,
            lens=self.lens,
            rotation=np.array(self.rotation),
            translation=np.array(self.translation),
            plane_height=self.plane_height,
            surface=self.surface,
        )

    def to_picture(self, places: Places) -> Pixels:
        """Return where the camera sees places in the plane of motion [px].

        Args:
            places: Places [m].
        """
        matrix = rotation_matrix(np.array(self.rotation))
        heights = np.full(len(places), self.plane_height)
        in_camera = np.column_stack((places, heights)) @ matrix.T + np.array(self.translation)
        straight = in_camera[:, :2] / in_camera[:, 2:]
        pixels = self.lens.focal_length * straight + np.array(self.lens.center)
        for _ in range(N_CORRECTIONS):  # lens and water move them but little
            seen_places = self.to_plane(pixels)
            beside = [self.to_plane(pixels + shift) - seen_places for shift in np.eye(2)]
            per_pixel = np.stack(beside, axis=-1)
            is_known = np.isfinite(per_pixel).all(axis=(1, 2))
            left = (places - seen_places)[is_known]
            pixels[is_known] += np.einsum("nij,nj->ni", np.linalg.pinv(per_pixel[is_known]), left)
            pixels[~is_known] = np.nan
        return pixels


@value_class
class RulerCalibration:
    """A camera right above: one length in the picture gives the scale; x is right, y up."""

    image_size: tuple[int, int] = quantity("px", "Width and height of the picture", ge=1)
    metres_per_pixel: float = quantity("m", "Size of a pixel in the plane of motion", gt=0.0)
    scale_deviation: float = quantity(
        "", "Standard deviation of lengths in the plane, as a share", default=0.0, ge=0.0
    )
    position_deviation: float = quantity(
        "m",
        "Further standard deviation of places; perspective is not known",
        default=0.0,
        ge=0.0,
    )

    def to_plane(self, pixels: Pixels) -> Places:
        """Return places in the plane of motion, from the lower left corner of the picture [m].

        Args:
            pixels: Pixels.
        """
        _, height = self.image_size
        return self.metres_per_pixel * np.stack((pixels[:, 0], height - pixels[:, 1]), axis=1)

    def to_picture(self, places: Places) -> Pixels:
        """Return where the camera sees places in the plane of motion [px].

        Args:
            places: Places [m].
        """
        _, height = self.image_size
        pixels = places / self.metres_per_pixel
        return np.stack((pixels[:, 0], height - pixels[:, 1]), axis=1)


Calibration: TypeAlias = CameraCalibration | RulerCalibration
KINDS: dict[str, type[CameraCalibration] | type[RulerCalibration] | type[Lens]] = {
    "film-camera": CameraCalibration,
    "film-ruler": RulerCalibration,
    "lens": Lens,
}
"""Classes by the `kind` of their files."""


def calibrate_by_ruler(
    image_size: tuple[int, int],
    begin: tuple[float, float],
    end: tuple[float, float],
    length: float,
    *,
    pixel_deviation: float = 1.0,
    length_deviation: float = 0.001,
) -> RulerCalibration:
    """Return the calibration from two points in the picture and their distance.

    Args:
        image_size: Width and height of the picture [px].
        begin: One end of the ruler, which lies in the plane of motion [px].
        end: The other.
        length: Their distance [m].
        pixel_deviation: Standard deviation of each of them [px].
        length_deviation: That of the distance [m].

    Raises:
        ValueError: If they are less than 10 px apart or not in the picture, or the length is not > 0.
    """
    for name, point in (("begin", begin), ("end", end)):
        if not np.all((0.0 <= np.array(point)) & (np.array(point) <= image_size)):
            width, height = image_size
            rule = f"must be in the picture, which is {width} by {height} px"
            raise BadArgument(name, f"{rule}, got {point[0]:g}, {point[1]:g}")
    distance = float(np.hypot(end[0] - begin[0], end[1] - begin[1]))
    if distance < SHORTEST_RULER:
        raise BadArgument(
            "end", f"must be at least {SHORTEST_RULER:g} px from `begin`, got {distance:.3g} px"
        )
    if length <= 0.0:
        raise BadArgument("length", f"must be > 0 m, got {length}")
    shares = np.array([np.sqrt(2.0) * pixel_deviation / distance, length_deviation / length])
    return RulerCalibration(
        image_size=image_size,
        metres_per_pixel=length / distance,
        scale_deviation=float(np.linalg.norm(shares)),
        position_deviation=pixel_deviation * length / distance,
    )


SHORTEST_RULER = 10.0
"""Distance of the two ends of a ruler in the picture at least [px]."""


def points_on_plane(points: TrackedPoints, calibration: Calibration) -> TrackedPoints:
    """Return points in m, in the plane of motion, from points in px.

    Args:
        points: Points in px.
        calibration: Of the camera that filmed them.

    Raises:
        ValueError: If the points are in m already, or lie outside the picture.
    """
    check_instance("calibration", calibration, CameraCalibration, RulerCalibration)
    if points.unit != "px":
        raise BadArgument("points", f"must be in px, got {points.unit}: they need no calibration")
    width, height = calibration.image_size
    seen_pixels = points.position[points.is_seen]
    margin = MARGIN * np.array([width, height])
    outside = np.any(
        (seen_pixels < -margin) | (seen_pixels > np.array([width, height]) + margin), axis=1
    )
    if np.mean(outside) > MARGIN:
        rule = f"must lie in the picture of {width} x {height} px that was calibrated"
        x, y = seen_pixels[outside][0]
        raise BadArgument("points", f"{rule}, got ({x:.0f}, {y:.0f}) px; was the film scaled?")
    pixels = points.position.reshape(-1, 2)
    places = np.full_like(pixels, np.nan)
    is_known = np.isfinite(pixels).all(axis=1)
    places[is_known] = calibration.to_plane(pixels[is_known])
    places[~np.isfinite(places).all(axis=1)] = np.nan
    moved = replace(points, position=places.reshape(points.position.shape), unit="m")
    return moved.with_notes(describe_certainty(calibration))


def describe_certainty(calibration: Calibration) -> str:
    """Return a sentence that says how certain lengths and places are.

    Args:
        calibration: The calibration.
    """
    return (
        f"Lengths are certain to {calibration.scale_deviation:.2%}, places to "
        f"{1e3 * calibration.position_deviation:.2g} mm more (standard deviations)."
    )


# ---- files ---------------------------------------------------------------------------------------


def save_calibration(calibration: Calibration | Lens, path: str | Path) -> None:
    """Write a calibration, or a lens, to a TOML file.

    Args:
        calibration: The calibration.
        path: Path of the file.

    Raises:
        StorageFailed: If it cannot be written.
    """
    import tomli_w

    kind = next(
        name for name, stored_class in KINDS.items() if isinstance(calibration, stored_class)
    )
    table = codec.stamped(kind, codec.encode(calibration))
    files.write(Path(path), tomli_w.dumps(table).encode())


def load_calibration(path: str | Path) -> Calibration:
    """Read a calibration that `save_calibration` wrote.

    Args:
        path: Path of the TOML file.

    Raises:
        TrialFileError: If there is no such file, or anything in it is wrong.
    """
    loaded = _load(path, ("film-camera", "film-ruler"))
    assert not isinstance(loaded, Lens)
    return loaded


def load_lens(path: str | Path) -> Lens:
    """Read a lens that `save_calibration` wrote; of a calibration, its lens.

    Args:
        path: Path of the TOML file.

    Raises:
        TrialFileError: If there is no such file, or anything in it is wrong.
    """
    loaded = _load(path, ("lens", "film-camera"))
    if isinstance(loaded, CameraCalibration):
        return loaded.lens
    assert isinstance(loaded, Lens)
    return loaded


def _load(path: str | Path, kinds: tuple[str, ...]) -> Calibration | Lens:
    path = Path(path)
    with codec.keys_of(path, TrialFileError):
        table = files.read_toml(path, TrialFileError)
        kind = codec.take_kind(table, *kinds)
        return codec.decode(KINDS[kind], table)
