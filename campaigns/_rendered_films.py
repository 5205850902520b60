"""Films of a robot with tags in a tank, by ray tracing: what a camera sees through lens and water.

Written apart from `laticauda.film.calibration`, so that neither hides an error of the other: rays are
bent by the angles of Snell's law in their plane of incidence, the lens is inverted by Newton's method,
and marks are projected forward by bisection. Only the patterns of the tags are OpenCV's.
"""

from dataclasses import dataclass, field

import cv2
import numpy as np

DICTIONARY = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50)
CELLS = 8  # of a tag with its white margin: 4 x 4 bits, a black border, a white one
FLOOR, BODY, WHITE = 120.0, 70.0, 235.0  # gray levels


@dataclass(frozen=True, kw_only=True)
class Camera:
    """A camera above a tank: a pinhole with radial distortion."""

    size: tuple[int, int] = (1280, 720)  # px
    focal: float = 1000.0  # px
    k1: float = 0.0
    k2: float = 0.0
    eye: tuple[float, float, float] = (2.0, -1.2, 3.2)  # m
    target: tuple[float, float, float] = (2.0, 1.0, 0.0)  # m
    surface: float | None = None  # height of the water above the floor [m]
    index: float = 1.333

    def axes(self) -> np.ndarray:
        """Right, down and forward in the world, as rows."""
        forward = np.subtract(self.target, self.eye)
        forward /= np.linalg.norm(forward)
        right = np.cross(forward, (0.0, 0.0, 1.0))
        right /= np.linalg.norm(right)
        return np.stack((right, np.cross(forward, right), forward))

    @property
    def center(self) -> np.ndarray:
        return 0.5 * (np.array(self.size) - 1.0)

    def look(self, pixels: np.ndarray) -> np.ndarray:
        """Directions of pixels in the world, of any length; the lens is inverted by Newton's method."""
        seen = (np.asarray(pixels, float) - self.center) / self.focal
        radius_seen = np.hypot(seen[:, 0], seen[:, 1])
        radius = radius_seen.copy()
        for _ in range(12):
            value = radius * (1.0 + self.k1 * radius**2 + self.k2 * radius**4) - radius_seen
            slope = 1.0 + 3.0 * self.k1 * radius**2 + 5.0 * self.k2 * radius**4
            radius -= value / slope
        ratio = np.divide(radius, radius_seen, out=np.ones_like(radius), where=radius_seen > 0.0)
        return np.column_stack((seen * ratio[:, np.newaxis], np.ones(len(seen)))) @ self.axes()

    def hit(self, pixels: np.ndarray, height: float) -> np.ndarray:
        """Where the rays of pixels meet the level `height` [m]."""
        direction = self.look(pixels)
        eye = np.array(self.eye)
        flat = np.hypot(direction[:, 0], direction[:, 1])
        with np.errstate(divide="ignore", invalid="ignore"):
            course = direction[:, :2] / flat[:, np.newaxis]
            incidence = np.arctan2(flat, -direction[:, 2])  # from straight down
            if self.surface is None or height >= self.surface:
                reach = (eye[2] - height) * np.tan(incidence)
            else:
                below = np.arcsin(np.sin(incidence) / self.index)
                reach = (eye[2] - self.surface) * np.tan(incidence)
                reach += (self.surface - height) * np.tan(below)
        reach[incidence >= 0.5 * np.pi] = np.nan  # above the horizon
        course[flat == 0.0] = 0.0
        return eye[:2] + reach[:, np.newaxis] * course

    def project(self, points: np.ndarray) -> np.ndarray:
        """Pixels of points (x, y, z); where their light leaves the water is found by bisection."""
        points = np.asarray(points, float)
        eye = np.array(self.eye)
        away = points[:, :2] - eye[:2]
        distance = np.hypot(away[:, 0], away[:, 1])
        depth = np.zeros(len(points))
        if self.surface is not None:
            depth = np.maximum(self.surface - points[:, 2], 0.0)
        above = eye[2] - points[:, 2] - depth
        low, high = np.zeros(len(points)), np.full(len(points), 0.5 * np.pi - 1e-9)
        for _ in range(60):
            middle = 0.5 * (low + high)
            reach = above * np.tan(middle)
            reach += depth * np.tan(np.arcsin(np.sin(middle) / self.index))
            is_short = reach < distance
            low, high = np.where(is_short, middle, low), np.where(is_short, high, middle)
        flat = np.tan(low)
        course = np.divide(
            away, distance[:, np.newaxis], out=np.zeros_like(away), where=distance[:, None] > 0.0
        )
        direction = np.column_stack((course * flat[:, np.newaxis], -np.ones(len(points))))
        in_camera = direction @ self.axes().T
        x, y = in_camera[:, 0] / in_camera[:, 2], in_camera[:, 1] / in_camera[:, 2]
        square = x**2 + y**2
        radial = 1.0 + self.k1 * square + self.k2 * square**2
        return self.focal * np.column_stack((x, y)) * radial[:, np.newaxis] + self.center


def pattern(number: int) -> np.ndarray:
    """Gray levels of a tag's cells, its white margin too, first row on top."""
    marker = cv2.aruco.generateImageMarker(DICTIONARY, number, CELLS - 2)
    return np.where(np.pad(marker, 1, constant_values=255) > 127, WHITE, 20.0)


def corners(center: np.ndarray, angle: float, size: float) -> np.ndarray:
    """Corners of the black square, in the order of OpenCV."""
    local = 0.5 * size * np.array([[-1, 1], [1, 1], [1, -1], [-1, -1]])
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    return np.asarray(center) + local @ turn.T


@dataclass(kw_only=True, eq=False)
class Scene:
    """A tank's floor with tags, seen by a camera that stands still; bodies move on one level above it."""

    camera: Camera
    floor_tags: dict[int, tuple[float, float, float]]  # x, y [m], angle [rad]
    floor_size: float  # of the black square [m]
    level: float = 0.1  # of the body above the floor [m]
    body_size: float = 0.06  # of the black square of its tags [m]
    oversampling: int = 2
    blur: float = 0.7  # px
    noise: float = 4.0  # gray levels
    floor: np.ndarray = field(init=False)
    places: np.ndarray = field(init=False)

    def __post_init__(self) -> None:
        width, height = self.camera.size
        n = self.oversampling
        steps = (np.arange(n) + 0.5) / n - 0.5
        x = (np.arange(width)[:, None] + steps).ravel()
        y = (np.arange(height)[:, None] + steps).ravel()
        pixels = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
        shape = (height * n, width * n, 2)
        on_floor = self.camera.hit(pixels, 0.0).reshape(shape)
        self.places = self.camera.hit(pixels, self.level).reshape(shape)
        tiles = 6.0 * np.sign(np.sin(4.0 * on_floor[..., 0]) * np.sin(4.0 * on_floor[..., 1]))
        self.floor = FLOOR + np.nan_to_num(tiles)
        for number, (x, y, angle) in self.floor_tags.items():
            self._paint_tag(self.floor, on_floor, number, np.array([x, y]), angle, self.floor_size)

    def picture(
        self,
        centers: np.ndarray,
        angles: np.ndarray,
        lengths: np.ndarray,
        tags: dict[int, int],
        generator: np.random.Generator,
        width: float = 0.05,
    ) -> np.ndarray:
        """A picture of links on the level of the body; `tags` are numbers by link."""
        levels = self.floor.copy()
        for center, angle, length in zip(centers, angles, lengths, strict=True):
            self._paint_capsule(levels, center, angle, length, width)
        for link, number in tags.items():
            self._paint_tag(
                levels, self.places, number, centers[link], angles[link], self.body_size
            )
        n = self.oversampling
        rows, columns = levels.shape
        small = levels.reshape(rows // n, n, columns // n, n).mean(axis=(1, 3))
        small = cv2.GaussianBlur(small, (0, 0), self.blur)
        small += generator.normal(0.0, self.noise, small.shape)
        return np.clip(np.round(small), 0, 255).astype(np.uint8)

    def _window(self, places: np.ndarray, center: np.ndarray, radius: float) -> tuple[slice, slice]:
        """Rows and columns of what lies within a radius of a place, found on a coarse grid."""
        step = 8
        coarse = places[::step, ::step]
        near = np.hypot(coarse[..., 0] - center[0], coarse[..., 1] - center[1]) < radius + 0.05
        if not near.any():
            return slice(0, 0), slice(0, 0)
        rows, columns = np.flatnonzero(near.any(axis=1)), np.flatnonzero(near.any(axis=0))
        return (
            slice(max(0, (rows[0] - 1) * step), (rows[-1] + 2) * step),
            slice(max(0, (columns[0] - 1) * step), (columns[-1] + 2) * step),
        )

    def _local(self, places, center, angle):
        """Places in the axes of something at a center, turned by an angle."""
        away = places - center
        along = away[..., 0] * np.cos(angle) + away[..., 1] * np.sin(angle)
        return along, -away[..., 0] * np.sin(angle) + away[..., 1] * np.cos(angle)

    def _paint_tag(self, levels, places, number, center, angle, size) -> None:
        whole = size * CELLS / (CELLS - 2)
        window = self._window(places, center, whole)
        along, left = self._local(places[window], center, angle)
        with np.errstate(invalid="ignore"):
            column = np.floor((along / whole + 0.5) * CELLS)
            row = np.floor((0.5 - left / whole) * CELLS)
            inside = (column >= 0) & (column < CELLS) & (row >= 0) & (row < CELLS)
        cells = pattern(number)
        levels[window][inside] = cells[row[inside].astype(int), column[inside].astype(int)]

    def _paint_capsule(self, levels, center, angle, length, width) -> None:
        window = self._window(self.places, center, 0.5 * length + width)
        along, left = self._local(self.places[window], center, angle)
        with np.errstate(invalid="ignore"):
            beyond = np.maximum(np.abs(along) - 0.5 * length, 0.0)
            inside = np.hypot(beyond, left) < 0.5 * width
        levels[window][inside] = BODY
