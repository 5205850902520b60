"""Controls of the gait: its kind, and sliders for its wave and for its pitch wave."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from laticauda.connect import LIMITS
from laticauda.motion.gaits import STRAIGHT, Gait, Wave, envelope_of, list_kinds
from laticauda.scenarios import Scenario
from laticauda.show.cockpit.changes import Changes
from laticauda.show.cockpit.control import Control, read_hint, spell_out
from laticauda.show.cockpit.live import Live
from laticauda.values import check_within, quantities_of

SliderLimits = Mapping[str, tuple[float, float, float]]
"""Lowest value, highest value and step of each slider [deg], by the field that it sets."""
WAVE_LIMITS: SliderLimits = LIMITS["gait"]
PITCH_LIMITS: SliderLimits = {
    **LIMITS["gait"],
    "amplitude": (0.0, 45.0, 1.0),
    "phase": (-180.0, 180.0, 5.0),
}
PITCH = "pitch_"
"""Prefix of the names of the pitch wave's controls."""
DIGITS = 9
"""Digits that are shown at most: the conversion to degrees loses the last ones."""


def add_gait_controls(gui: Any, live: Live) -> dict[str, Control]:
    """Add the kind of gait and the sliders of its wave; return them by name.

    Args:
        gui: GUI of the page's server; the controls are added at its current position.
        live: The simulation that they control.
    """
    kinds = GaitKinds(live)
    handle = gui.add_dropdown("gait", kinds.labels, hint=read_hint(Gait, "envelope"))
    kind = Control(handle, kinds.read, kinds.change)
    return {"kind": kind, **_add_sliders(gui, live, WAVE_LIMITS, is_pitch=False)}


def add_pitch_controls(gui: Any, live: Live) -> dict[str, Control]:
    """Add the sliders of the pitch wave; return them by name.

    Args:
        gui: GUI of the page's server; the controls are added at its current position.
        live: The simulation that they control.
    """
    return _add_sliders(gui, live, PITCH_LIMITS, is_pitch=True)


class GaitKinds:
    """The kinds of gaits that can be chosen, including that with which the page started.

    Args:
        live: The simulation.
    """

    def __init__(self, live: Live) -> None:
        self._live = live
        self._first_envelope = live.scenario.gait.envelope
        kinds = (*list_kinds(), live.scenario.gait.kind)
        self._kind_of_label = {spell_out(kind): kind for kind in kinds}

    @property
    def labels(self) -> tuple[str, ...]:
        """Names of the kinds on the page."""
        return tuple(self._kind_of_label)

    def read(self, scenario: Scenario) -> str:
        """Return the name of a scenario's kind of gait."""
        return spell_out(scenario.gait.kind)

    def change(self, label: str) -> Changes:
        """Return the changes that result from choosing a kind."""
        kind = self._kind_of_label[label]
        envelope = self._first_envelope
        if kind != envelope.kind:
            envelope = envelope_of(kind)
        return {"gait": replace(self._live.scenario.gait, envelope=envelope)}


@dataclass(frozen=True, kw_only=True)
class WaveSlider:
    """A slider for one parameter of the gait's own wave, or of its pitch wave."""

    live: Live
    """The simulation."""
    field: str
    """The parameter."""
    low: float
    """Lowest value [deg], or [deg/s]."""
    high: float
    """Highest value [deg], or [deg/s]."""
    is_pitch: bool
    """Whether it is one of the pitch wave."""

    @property
    def name(self) -> str:
        """Name of the control."""
        if self.is_pitch:
            return f"{PITCH}{self.field}"
        return self.field

    def read(self, scenario: Scenario) -> float:
        """Return the value of a scenario, within the range of the slider."""
        wave = scenario.gait
        if self.is_pitch:
            wave = scenario.gait.pitch or STRAIGHT
        degrees = round(math.degrees(getattr(wave, self.field)), DIGITS)
        return min(max(degrees, self.low), self.high)

    def change(self, value: float) -> Changes:
        """Check the slider's range, which typed values may exceed; the gait itself rejects impossible ones."""
        gait = self.live.scenario.gait
        parameter: dict[str, Any] = {self.field: math.radians(value)}
        if self.is_pitch:
            gait = replace(gait, pitch=_change_pitch(gait, parameter))
        else:
            gait = replace(gait, **parameter)
        argument = f"{self.name}_deg"
        if self.field == "frequency":
            argument += "_s"
        check_within(argument, value, self.low, self.high)
        return {"gait": gait}


def _change_pitch(gait: Gait, parameter: dict[str, Any]) -> Wave | None:
    """Return the pitch wave with another parameter; None if it does not move the joints."""
    still = Wave(amplitude=0.0, frequency=gait.frequency, phase_shift=gait.phase_shift)
    pitch = replace(gait.pitch or still, **parameter)
    is_set = any(parameter.values())
    if is_set or pitch.amplitude or pitch.offset:
        return pitch
    return None


def _add_sliders(
    gui: Any, live: Live, limits: SliderLimits, *, is_pitch: bool
) -> dict[str, Control]:
    declaring_class = Wave if is_pitch else Gait
    controls: dict[str, Control] = {}
    for field, (low, high, step) in limits.items():
        slider = WaveSlider(live=live, field=field, low=low, high=high, is_pitch=is_pitch)
        unit = quantities_of(declaring_class)[field].unit
        label = spell_out(f"{slider.name} [{unit.replace('rad', '°')}]")
        hint = read_hint(declaring_class, field, unit.replace("rad", "deg"))
        handle = gui.add_slider(label, low, high, step, max(low, 0.0), hint=hint)
        controls[slider.name] = Control(handle, slider.read, slider.change)
    return controls
