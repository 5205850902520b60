"""The battery that the autopilot sees: a voltage that sinks with the charge, behind a resistance."""

import math

from laticauda.values import BadArgument, quantity, value_class

SECONDS_PER_HOUR = 3600.0


@value_class
class Battery:
    """A battery whose open voltage falls linearly from full to empty.

    Raises:
        ValueError: If a field is out of its range, or it is fuller when empty.
    """

    full_voltage: float = quantity("V", "Open voltage when full", gt=0.0, default=42.0)
    empty_voltage: float = quantity("V", "Open voltage when empty", gt=0.0, default=33.0)
    capacity: float = quantity("A h", "Charge between both", gt=0.0, default=10.0)
    resistance: float = quantity("ohm", "Inner resistance", ge=0.0, default=0.1)

    def __post_init__(self) -> None:
        """Check the order of the voltages."""
        if self.empty_voltage >= self.full_voltage:
            rule = f"must be < `full_voltage` = {self.full_voltage:g} V"
            raise BadArgument("empty_voltage", f"{rule}, got {self.empty_voltage:g}")

    def open_voltage(self, charge: float) -> float:
        """Return the voltage without a current [V].

        Args:
            charge: Charge that was taken out since it was full [A h].
        """
        share = min(max(charge / self.capacity, 0.0), 1.0)
        return self.full_voltage + share * (self.empty_voltage - self.full_voltage)

    def current(self, power: float, charge: float) -> float:
        """Return the current at which the battery gives a power, or as nearly as it can [A].

        Args:
            power: Power that the robot draws [W].
            charge: Charge that was taken out since it was full [A h].
        """
        voltage = self.open_voltage(charge)
        if self.resistance == 0.0:
            return power / voltage
        # (U - R I) I = P; beyond U^2 / 4R the battery gives no more.
        root = max(voltage * voltage - 4.0 * self.resistance * power, 0.0)
        return (voltage - math.sqrt(root)) / (2.0 * self.resistance)


class Discharge:
    """A battery while it is used, full at first.

    Args:
        battery: The battery.
    """

    def __init__(self, battery: Battery) -> None:
        self._battery = battery
        self.charge = 0.0
        """Charge that was taken out [A h]."""
        self.current = 0.0
        """Current in the last step [A]."""
        self.voltage = battery.full_voltage
        """Voltage in the last step [V]."""

    def draw(self, power: float, duration: float) -> None:
        """Draw a power for some time.

        Args:
            power: Power that the robot draws [W].
            duration: Duration [s].
        """
        self.current = self._battery.current(power, self.charge)
        open_voltage = self._battery.open_voltage(self.charge)
        self.voltage = open_voltage - self._battery.resistance * self.current
        self.charge += self.current * duration / SECONDS_PER_HOUR
