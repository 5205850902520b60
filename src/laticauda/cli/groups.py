"""Groups of options that commands share: what swims, how, where, and by which model."""

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Annotated, Any

import tyro

from laticauda.cli.flags import Number, Numbers, Preset, Whole, changed, changes, choice, default
from laticauda.cli.messages import given
from laticauda.robot import Environment, Robot, Water, load_ground, load_parameters, load_robot, load_water

if TYPE_CHECKING:
    from laticauda.gaits import Gait, Wave

# What options that are left out stand for: Mamba's first trial of the paper.
ROBOT = "mamba"
GAIT = "lateral-undulation"
AMPLITUDE_DEG, FREQUENCY_DEG_S, PHASE_SHIFT_DEG = 30.0, 130.0, 40.0

WaterChanges = changes(Water, omit=("name",), otherwise="the water's")
Coefficients = Annotated[Any, tyro.conf.arg(constructor=WaterChanges)]
ORIGINS = {
    "lateral_undulation": "the paper's for lateral undulation",
    "eel_like": "the paper's for eel-like motion",
    "custom": "the paper's for lateral undulation, in want of others for this gait",
}


@dataclass(frozen=True, kw_only=True)
class RobotFlags:
    """What swims."""

    robot: Annotated[Preset, default(ROBOT)] = None
    """A preset (`laticauda robots` lists them) or a TOML file."""
    n_links: Annotated[Whole, default("the robot's")] = None
    """Number of links to have instead, for robots whose links are all alike."""

    def chosen(self) -> Robot:
        """The robot that is asked for."""
        return load_robot(ROBOT if self.robot is None else self.robot, self.n_links)


@dataclass(frozen=True, kw_only=True)
class GaitFlags:
    """How it moves: phi_i = alpha g(i, n) sin(omega t + (i-1) delta) + phi_0, i = 1 at the tail."""

    gait: Annotated[str | None, choice("lateral-undulation", "eel-like", "custom"), default(GAIT)] = None
    """The envelope g: 1, (n-i)/(n+1), or one's own."""
    envelope: Annotated[Numbers, default("none")] = None
    """g of every joint for the gait `custom`, tail first [-]."""
    amplitude_deg: Annotated[Number, default(f"{AMPLITUDE_DEG:g}")] = None
    """alpha [deg]."""
    frequency_deg_s: Annotated[Number, default(f"{FREQUENCY_DEG_S:g}")] = None
    """omega, an angular frequency [deg/s]."""
    phase_shift_deg: Annotated[Number, default(f"{PHASE_SHIFT_DEG:g}")] = None
    """delta between neighboring joints [deg]."""
    offset_deg: Annotated[Number, default("0")] = None
    """phi_0 of every joint; positive turns left [deg]."""
    pitch_amplitude_deg: Annotated[Number, default("0")] = None
    """alpha of a second wave, of the pitch joints, with the same frequency and phase shift [deg]."""
    pitch_phase_deg: Annotated[Number, default("0")] = None
    """How far it is ahead of the first one; 90 makes a helix [deg]."""
    pitch_offset_deg: Annotated[Number, default("0")] = None
    """phi_0 of the pitch joints; positive turns down [deg]."""
    fin_amplitude_deg: Annotated[Number, default("0")] = None
    """alpha of a driven fin's own wave [deg]."""
    fin_frequency_deg_s: Annotated[Number, default("that of the body")] = None
    """Its omega [deg/s]."""
    fin_phase_deg: Annotated[Number, default("0")] = None
    """How far it is ahead of the tail-most joint, for equal frequencies [deg]."""
    fin_offset_deg: Annotated[Number, default("0")] = None
    """phi_0 of the fin [deg]."""

    def chosen(self) -> "Gait":
        """The gait that is asked for."""
        from laticauda.gaits import Gait, envelope_of

        frequency = radians(self.frequency_deg_s, FREQUENCY_DEG_S)
        phase_shift = radians(self.phase_shift_deg, PHASE_SHIFT_DEG)
        return Gait(
            envelope=envelope_of(GAIT if self.gait is None else self.gait, self.envelope),
            amplitude=radians(self.amplitude_deg, AMPLITUDE_DEG),
            frequency=frequency,
            phase_shift=phase_shift,
            offset=radians(self.offset_deg, 0.0),
            pitch=self._pitch(frequency, phase_shift),
            fin=self._fin(frequency),
        )

    def changed(self, gait: "Gait") -> "Gait":
        """Another gait with what was asked for of this one.

        Args:
            gait: Of a scenario.
        """
        fields = {"amplitude_deg": "amplitude", "frequency_deg_s": "frequency", "phase_shift_deg": "phase_shift"}
        fields["offset_deg"] = "offset"
        asked = given(self)
        for name in asked:
            if name not in fields:
                raise ValueError(f"`{name}` must not be given with a scenario's gait: write it into the scenario.")
        return replace(gait, **{fields[name]: math.radians(angle) for name, angle in asked.items()})

    def _pitch(self, frequency: float, phase_shift: float) -> "Wave | None":
        """The second wave; None if no option asks for one."""
        from laticauda.gaits import Wave

        if (self.pitch_amplitude_deg, self.pitch_phase_deg, self.pitch_offset_deg) == (None, None, None):
            return None
        return Wave(
            amplitude=radians(self.pitch_amplitude_deg, 0.0),
            frequency=frequency,
            phase_shift=phase_shift,
            phase=radians(self.pitch_phase_deg, 0.0),
            offset=radians(self.pitch_offset_deg, 0.0),
        )

    def _fin(self, frequency: float) -> "Wave | None":
        """The wave of a driven fin; None if no option asks for one."""
        from laticauda.gaits import Wave

        own = (self.fin_amplitude_deg, self.fin_frequency_deg_s, self.fin_phase_deg, self.fin_offset_deg)
        if own == (None, None, None, None):
            return None
        return Wave(
            amplitude=radians(self.fin_amplitude_deg, 0.0),
            frequency=frequency if self.fin_frequency_deg_s is None else math.radians(self.fin_frequency_deg_s),
            phase=radians(self.fin_phase_deg, 0.0),
            offset=radians(self.fin_offset_deg, 0.0),
        )


@dataclass(frozen=True, kw_only=True)
class EnvironmentFlags:
    """Where it moves."""

    water: Annotated[Preset, default("paper-eel for the gait eel-like, else paper-lateral")] = None
    """A preset or a TOML file."""
    ground: Annotated[Preset, default("none")] = None
    """A preset or a TOML file: crawl on land instead."""
    parameters: Annotated[Preset, default("none")] = None
    """A preset or a parameter file: its numbers for water, joints, fin and power instead of the paper's and the
    robot's (not with a water)."""

    def chosen(self, gait: "Gait", coefficients: object) -> tuple[Environment, str]:
        """What is asked for, and where it is from, in words.

        Args:
            gait: It decides on the water if none was asked for.
            coefficients: `WaterChanges`.
        """
        if self.ground is not None:
            of_water = [name for name in (*given(self), *given(coefficients)) if name != "ground"]
            if of_water:
                raise ValueError(f"`{of_water[0]}` must not be given with `ground`: it belongs to water.")
            return load_ground(self.ground), "as asked for"
        water, origin = self._water(gait)
        return changed(water, coefficients), origin

    def equipped(self, robot: Robot, gait: "Gait") -> Robot:
        """The robot with the numbers of the parameters, if any were asked for.

        Args:
            robot: What swims.
            gait: It decides on the parameters' numbers.
        """
        return robot if self.parameters is None else load_parameters(self.parameters).robot(robot, gait.kind)

    def model_settings(self, model: "ModelFlags") -> dict[str, Any]:
        """How it is computed, by what was typed; else with the joint law of the parameters.

        Args:
            model: The flags.
        """
        settings = given(model)
        if self.parameters is not None and "joints" not in settings:
            joints = load_parameters(self.parameters).joints
            settings |= {} if joints is None else {"joints": joints}
        return settings

    def _water(self, gait: "Gait") -> tuple[Water, str]:
        """The water before single coefficients are replaced, and where it is from."""
        from laticauda.scenarios import default_water

        if self.parameters is not None:
            if self.water is not None:
                raise ValueError("`parameters` must not be given with `water`: both say what the water is.")
            return load_parameters(self.parameters).water(gait.kind), f"as {self.parameters} says"
        if self.water is not None:
            return load_water(self.water), "as asked for"
        return load_water(default_water(gait)), ORIGINS[gait.kind]


@dataclass(frozen=True, kw_only=True)
class ModelFlags:
    """How it is computed."""

    model: Annotated[str | None, choice("planar", "spatial"), default("planar")] = None
    """The model of the body: the closed form in the plane, or MuJoCo in space."""
    root: Annotated[str | None, choice("free", "planar"), default("free where there are pitch joints")] = None
    """Of the spatial model: nothing held, or height and tilt of the tail module fixed."""
    joints: Annotated[str | None, choice("prescribed", "pd", "servo"), default("the parameters', or prescribed")] = None
    """How the joints follow the gait: exactly, by the published simulations' law, or as the real robot's servos do."""
    ramp: Annotated[Number, default("1 for prescribed joints, else 0")] = None
    """Duration of the smooth start [s]."""
    offset_bandwidth: Annotated[Number, default("10")] = None
    """Of the filters behind the gait's parameters [rad/s]."""
    dt: Annotated[Number, default("a converged one")] = None
    """Largest time step [s]."""


def radians(degrees: float | None, otherwise: float) -> float:
    """An angle of an option in radians; `otherwise`, in degrees too, if the option was left out."""
    return math.radians(otherwise if degrees is None else degrees)
