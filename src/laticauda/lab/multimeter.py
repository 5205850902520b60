"""The multimeter in the supply cable: a Fluke 289 that measures direct current."""

import math

import numpy as np

from laticauda.lab.settings import SupplySettings
from laticauda.protocol import MeterIdentity, MeterReading, meter

IDENTITY = MeterIdentity(model="FLUKE 289", software="V1.16", serial="00000007")


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
            return meter.encode_answer(meter.identity_text(IDENTITY))
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
