"""A map over two numbers of the gait: what many trials side by side would do."""

import math
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from laticauda.cockpit.chart import Axis, Chart
from laticauda.cockpit.settings import Setting
from laticauda.errors import one_of
from laticauda.gaits import Gait
from laticauda.simulate import swim_many

AMPLITUDES = tuple(float(value) for value in range(5, 65, 5))  # [deg]
FREQUENCIES = tuple(float(value) for value in range(20, 220, 20))  # [deg/s]
DURATION = 20.0  # of every trial [s]
# Figure of `Swims` and its title.
QUANTITIES = {
    "forward_velocity": "Forward velocity (5) [m/s]",
    "mean_power": "Mean power [W]",
    "cost_of_transport": "Cost of transport [-]",
}


@dataclass(frozen=True, kw_only=True, eq=False)
class GaitMap:
    """What trials of `DURATION` from rest give, frequency by amplitude; nan where a trial failed."""

    setting: Setting
    """Of all trials, apart from amplitude and frequency."""
    values: dict[str, Float[np.ndarray, "n_frequencies n_amplitudes"]]
    """By the figure's name."""


def base(setting: Setting) -> Setting:
    """What a map depends on: settings with equal ones share a map. It is computed in the plane, without steering.

    Args:
        setting: What swims how.
    """
    return replace(setting, gait=replace(setting.gait, amplitude=0.0, frequency=0.0), model="planar", path=None)


def gait_map(setting: Setting) -> GaitMap:
    """Let all of them swim.

    Args:
        setting: What swims how.

    Raises:
        ValueError: If the batch cannot compute such trials.
    """
    plain = base(setting)
    gaits = [at(plain.gait, amplitude, frequency) for frequency in FREQUENCIES for amplitude in AMPLITUDES]
    swims = swim_many(plain.robot, gaits, DURATION, environments=plain.environment, joints=plain.joints)
    shape = len(FREQUENCIES), len(AMPLITUDES)
    return GaitMap(setting=plain, values={name: np.asarray(getattr(swims, name)).reshape(shape) for name in QUANTITIES})


def at(gait: Gait, amplitude_deg: float, frequency_deg_s: float) -> Gait:
    """The gait with another amplitude [deg] and frequency [deg/s]."""
    return replace(gait, amplitude=math.radians(amplitude_deg), frequency=math.radians(frequency_deg_s))


def chart(found: GaitMap, quantity: str) -> Chart:
    """One quantity of a map, as it is drawn.

    Args:
        found: The map.
        quantity: One of `QUANTITIES`.

    Raises:
        ValueError: If there is no such `quantity`.
    """
    x = Axis(name="gait.amplitude", unit="rad", values=tuple(map(math.radians, AMPLITUDES)))
    y = Axis(name="gait.frequency", unit="rad/s", values=tuple(map(math.radians, FREQUENCIES)))
    return Chart(x=x, y=y, values=found.values[quantity], title=title(quantity))


def title(quantity: str) -> str:
    """What a quantity of the map is called, with its unit.

    Raises:
        ValueError: If there is no such `quantity`.
    """
    return QUANTITIES[one_of("quantity", quantity, tuple(QUANTITIES))]
