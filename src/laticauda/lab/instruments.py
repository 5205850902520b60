"""What measures the robot from outside: the cameras, and the multimeter in the supply cable."""

import math

import numpy as np
from jaxtyping import Float

from laticauda.kinematics import ModulePoses, turned_about_vertical
from laticauda.lab.settings import MocapSettings, SupplySettings
from laticauda.protocol import BodyPose, MeterReading, MocapFrame, meter

BODY = "last-module"
# Where the five markers sit on their body: a cross with one arm longer than the others; an assumption [m].
MARKERS = ((0.0, 0.0, 0.0), (0.05, 0.0, 0.0), (-0.04, 0.0, 0.0), (0.0, 0.04, 0.0), (0.0, -0.03, 0.01))
ROTATION_JUMP = 0.1  # rad, of a body with a marker mistaken for its mirror image


class Cameras:
    """The cameras and what they have to tell.

    Args:
        settings: Their numbers.
        random: Where the noise comes from.
    """

    def __init__(self, settings: MocapSettings, random: np.random.Generator) -> None:
        self.settings, self._random = settings, random
        self._turn = turned_about_vertical(settings.mount_yaw)
        self._frame = turned_about_vertical(settings.frame_yaw)
        self._number = 0

    def look(self, modules: ModulePoses, time: float, *, hidden: bool = False) -> MocapFrame | None:
        """The next frame.

        Args:
            modules: Where the robot is.
            time: Of the frame [s].
            hidden: Whether something keeps the markers from the cameras.

        Returns:
            The frame, or None if it never comes.
        """
        s, random = self.settings, self._random
        self._number += 1
        chance = random.random(3)
        noise = random.standard_normal((4, 3))
        if chance[0] < s.drop_share:
            return None
        rotation = modules.rotation[0] @ self._turn
        position = modules.position[0] + modules.rotation[0] @ np.array(s.mount)
        body = None
        if not hidden and chance[1] >= s.lost_share and self.covers(position):
            body = self._measured(position, rotation, float(chance[2]), noise)
        return MocapFrame(timestamp=time, number=self._number, bodies=(body,))

    def covers(self, position: Float[np.ndarray, " 3"]) -> bool:
        """Whether a place is in the volume that the cameras cover.

        Args:
            position: In world axes [m].
        """
        s = self.settings
        return bool(np.all(np.abs(position - np.array(s.middle)) <= 0.5 * np.array(s.size)))

    def _measured(
        self,
        position: Float[np.ndarray, " 3"],
        rotation: Float[np.ndarray, "3 3"],
        chance: float,
        noise: Float[np.ndarray, "4 3"],
    ) -> BodyPose:
        """The pose in the cameras' frame, with what is wrong with it."""
        s = self.settings
        depth = max(-float(position[2]), 0.0)
        mistaken = chance < s.reflection_share * math.exp(-depth / s.reflection_depth)
        shift, turn = s.position_noise * noise[0], s.rotation_noise * noise[1]
        residual = s.position_noise * float(np.linalg.norm(noise[2])) / math.sqrt(3.0)
        if mistaken:
            shift = shift + s.reflection_jump * noise[3]
            turn = turn + ROTATION_JUMP * noise[2]
            residual += 0.5 * float(np.linalg.norm(s.reflection_jump * noise[3]))
        measured = self._frame.T @ (position + shift - np.array(s.frame))
        return BodyPose(position=measured, rotation=self._frame.T @ _rotation(turn) @ rotation, residual=residual)


def _rotation(vector: Float[np.ndarray, " 3"]) -> Float[np.ndarray, "3 3"]:
    """The rotation about a vector by its length [rad] (Rodrigues)."""
    angle = float(np.linalg.norm(vector))
    if angle == 0.0:
        return np.eye(3)
    x, y, z = vector / angle
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + math.sin(angle) * cross + (1.0 - math.cos(angle)) * (cross @ cross)


IDENTITY = "FLUKE 289,V1.16,00000007"  # model, software, serial number


class Multimeter:
    """What it shows, and its answers.

    Args:
        settings: Its numbers.
        random: Where the noise comes from.
    """

    def __init__(self, settings: SupplySettings, random: np.random.Generator) -> None:
        self.settings, self._random = settings, random
        self._charge, self._elapsed, self._time = 0.0, 0.0, 0.0
        self._live: float | None = None
        self._began: float | None = None
        self._sum, self._count, self._minimum, self._maximum = 0.0, 0, math.inf, -math.inf

    def advance(self, current: float, dt: float) -> None:
        """Let `dt` [s] pass at a `current` [A]."""
        self._time += dt
        self._charge += current * dt
        self._elapsed += dt
        if self._elapsed >= self.settings.meter_interval - 1e-9:
            noise = self.settings.current_noise * float(self._random.standard_normal())
            self._live = round(self._charge / self._elapsed + noise, 4)  # it shows four decimals
            self._charge = self._elapsed = 0.0
            if self._began is not None:
                self._sum, self._count = self._sum + self._live, self._count + 1
                self._minimum, self._maximum = min(self._minimum, self._live), max(self._maximum, self._live)

    @property
    def reading(self) -> MeterReading | None:
        """What it shows; None: nothing yet."""
        if self._live is None:
            return None
        if self._began is None or not self._count:
            return MeterReading(live=self._live)
        return MeterReading(
            live=self._live,
            average=self._sum / self._count,
            minimum=self._minimum,
            maximum=self._maximum,
            duration=self._time - self._began,
        )

    def answer(self, line: str) -> bytes:
        """What it says to a line, as it goes over the wire."""
        word = " ".join(line.upper().split())
        if word == meter.IDENTITY:
            return meter.encode_answer(IDENTITY)
        if word == meter.RESTART:
            self._began = self._time
            self._sum, self._count, self._minimum, self._maximum = 0.0, 0, math.inf, -math.inf
            return meter.encode_answer()
        if word not in (meter.MEASURE, meter.DISPLAYED):
            return meter.encode_answer(acknowledgment=meter.Acknowledgment.SYNTAX_ERROR)
        reading = self.reading
        if reading is None:
            return meter.encode_answer(acknowledgment=meter.Acknowledgment.NO_DATA)
        if word == meter.MEASURE:
            return meter.encode_answer(meter.live_text(reading.live))
        return meter.encode_answer(meter.displayed_text(reading, self._time))
