"""The operator's clock: real time, or a multiple of it for a virtual tank that runs at that multiple, too."""

import time
from dataclasses import dataclass, field

from laticauda.errors import positive


@dataclass(frozen=True, kw_only=True)
class Clock:
    """Seconds since it was made."""

    speed: float = 1.0
    """Seconds of the tank per second of the wall clock [-]."""
    origin: float = field(default_factory=time.monotonic)
    """Reading of the wall clock at zero [s]."""

    def __post_init__(self) -> None:
        """Check every field once."""
        object.__setattr__(self, "speed", positive("speed", self.speed))

    def now(self) -> float:
        """[s]."""
        return (time.monotonic() - self.origin) * self.speed

    def wait_until(self, moment: float) -> None:
        """Sleep until then, if it is still to come.

        Args:
            moment: By this clock [s].
        """
        left = (moment - self.now()) / self.speed
        if left > 0.0:
            time.sleep(left)
