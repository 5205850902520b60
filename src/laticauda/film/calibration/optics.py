"""Rays of a camera: lens, pose, and a flat surface of water that bends them.

World axes lie in the plane of the tags, z up. A camera looks along its z axis, x right, y down.
"""

import math
from typing import TypeAlias

import numpy as np
from jaxtyping import Float

from laticauda.values import BadArgument, check_positive, quantity, value_class

N_UNDISTORTIONS = 20
"""Steps of the search for a ray without distortion; it gains about a digit in each."""
SMALLEST_NORMAL = 1e-9
WATER_INDEX = 1.333
"""Refractive index of water at 20 C, of light of 589 nm [-]."""

Pixels: TypeAlias = Float[np.ndarray, "n 2"]
Places: TypeAlias = Float[np.ndarray, "n 2"]
Directions: TypeAlias = Float[np.ndarray, "n 3"]


@value_class
class Lens:
    """How a lens maps directions to pixels: OpenCV's model of a pinhole with distortion."""

    image_size: tuple[int, int] = quantity("px", "Width and height of the picture", ge=1)
    focal_length: float = quantity("px", "Focal length", gt=0.0)
    center: tuple[float, float] = quantity("px", "Where the optical axis meets the picture")
    distortion: tuple[float, float, float, float, float] = quantity(
        "", "Radial k1, k2, tangential p1, p2, radial k3", default=(0.0, 0.0, 0.0, 0.0, 0.0)
    )
    focal_length_deviation: float = quantity(
        "", "Standard deviation of the focal length, as a share", default=0.0, ge=0.0
    )
    center_deviation: float = quantity(
        "px", "Standard deviation of the center", default=0.0, ge=0.0
    )
    distortion_deviation: float = quantity(
        "", "Standard deviation of k1; k2 has three times as much", default=0.0, ge=0.0
    )

    def scaled_to(self, image_size: tuple[int, int]) -> "Lens":
        """Return the lens for films of another size that show the same.

        Args:
            image_size: Width and height of the film [px].

        Raises:
            ValueError: If its width and height have another ratio: such a film was cropped.
        """
        width, height = image_size
        own_width, own_height = self.image_size
        scale = check_positive("image_size", width / own_width)
        if abs(own_height * scale - height) > 1.0:
            rule = f"must have the ratio of {own_width} x {own_height}, for which the lens is known"
            raise BadArgument("image_size", f"{rule}, got {width} x {height}")
        x, y = self.center
        return Lens(
            image_size=image_size,
            focal_length=scale * self.focal_length,
            center=(scale * x, scale * y),
            distortion=self.distortion,
            focal_length_deviation=self.focal_length_deviation,
            center_deviation=scale * self.center_deviation,
            distortion_deviation=self.distortion_deviation,
        )


@value_class
class Surface:
    """A flat surface of water, or a thin window: beyond it, light is slower.

    A thick pane of glass shifts rays sideways by up to a third of its thickness, which is not modelled.
    """

    height: float = quantity("m", "Distance from the origin of the tags along the normal")
    height_deviation: float = quantity(
        "m", "Standard deviation of the height", default=0.003, ge=0.0
    )
    index: float = quantity("", "Refractive index beyond it", default=WATER_INDEX, ge=1.0, le=2.0)
    index_deviation: float = quantity(
        "", "Standard deviation of the refractive index", default=0.001, ge=0.0
    )
    normal: tuple[float, float, float] = quantity(
        "", "Normal in the axes of the tags; up for a surface of water", default=(0.0, 0.0, 1.0)
    )

    def __post_init__(self) -> None:
        """Scale the normal to length 1."""
        length = math.hypot(*self.normal)
        if length < SMALLEST_NORMAL:
            raise BadArgument("normal", f"must have a direction, got {self.normal}")
        x, y, z = self.normal
        object.__setattr__(self, "normal", (x / length, y / length, z / length))


def undistort(pixels: Pixels, lens: Lens) -> Float[np.ndarray, "n 2"]:
    """Return where the rays of pixels meet the plane one metre before the camera.

    Args:
        pixels: Pixels.
        lens: The lens.

    Source:
        The model of OpenCV (Brown, Photogrammetric Engineering 32 (1966) 444), inverted by repeated
        insertion.
    """
    k1, k2, p1, p2, k3 = lens.distortion
    distorted = (pixels - np.array(lens.center)) / lens.focal_length
    place = distorted
    for _ in range(N_UNDISTORTIONS):
        x, y = place[:, 0], place[:, 1]
        square = x**2 + y**2
        radial = 1.0 + square * (k1 + square * (k2 + square * k3))
        tangential = np.stack(
            (
                2.0 * p1 * x * y + p2 * (square + 2.0 * x**2),
                p1 * (square + 2.0 * y**2) + 2.0 * p2 * x * y,
            ),
            axis=1,
        )
        place = (distorted - tangential) / radial[:, np.newaxis]
    return place


def rotation_matrix(rotation: Float[np.ndarray, " 3"]) -> Float[np.ndarray, "3 3"]:
    """Return the matrix of a rotation vector.

    Args:
        rotation: Axis, as long as the angle [rad].

    Source:
        Rodrigues' formula.
    """
    angle = float(np.linalg.norm(rotation))
    if angle == 0.0:
        return np.eye(3)
    x, y, z = rotation / angle
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + math.sin(angle) * cross + (1.0 - math.cos(angle)) * cross @ cross


def locate(
    pixels: Pixels,
    *,
    lens: Lens,
    rotation: Float[np.ndarray, " 3"],
    translation: Float[np.ndarray, " 3"],
    plane_height: float,
    surface: Surface | None,
) -> Places:
    """Return where rays meet a plane parallel to that of the tags [m]; nan where they do not.

    Args:
        pixels: Pixels.
        lens: The lens.
        rotation: Rotation vector from the axes of the tags to those of the camera [rad].
        translation: Origin of the tags in the axes of the camera [m].
        plane_height: Height of the plane above the tags [m].
        surface: Surface of water between, if any.
    """
    matrix = rotation_matrix(rotation)
    eye = -matrix.T @ translation
    rays = undistort(pixels, lens)
    directions = np.column_stack((rays, np.ones(len(rays)))) @ matrix
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    origins = np.broadcast_to(eye, directions.shape)
    straight = _meet(origins, directions, np.array([0.0, 0.0, 1.0]), plane_height)
    if surface is None:
        return straight[:, :2]
    normal = np.array(surface.normal)
    side_of_eye = float(normal @ eye) - surface.height
    is_beyond = (straight @ normal - surface.height) * np.sign(side_of_eye) < 0.0
    entry = _meet(origins, directions, normal, surface.height)
    bent = refract(directions, np.sign(side_of_eye) * normal, surface.index)
    through_water = _meet(entry, bent, np.array([0.0, 0.0, 1.0]), plane_height)
    return np.where(is_beyond[:, np.newaxis], through_water, straight)[:, :2]


def refract(directions: Directions, normal: Float[np.ndarray, " 3"], index: float) -> Directions:
    """Return the directions of rays behind a surface.

    Args:
        directions: Directions before it, of length 1.
        normal: Normal on the side that the rays come from, of length 1.
        index: Refractive index behind, relative to that before [-].

    Source:
        Snell's law.
    """
    cosine = -directions @ normal
    sine_squared = (1.0 - cosine**2) / index**2
    along_normal = cosine / index - np.sqrt(1.0 - sine_squared)
    return directions / index + along_normal[:, np.newaxis] * normal


def _meet(
    origins: Directions, directions: Directions, normal: Float[np.ndarray, " 3"], height: float
) -> Directions:
    """Return where rays meet the plane at a height along its normal; nan behind them."""
    speed = directions @ normal
    distance = height - origins @ normal
    with np.errstate(divide="ignore", invalid="ignore"):
        reach = distance / speed
    reach = np.where(reach >= 0.0, reach, np.nan)
    return origins + reach[:, np.newaxis] * directions
