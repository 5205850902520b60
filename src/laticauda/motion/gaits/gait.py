"""Requested motion of the joints: the paper's gait (3) and its envelopes g(i, n).

An envelope defines how the amplitude of the joints varies along the body; a kind of gait is a kind
of envelope.
"""

from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache
from math import pi, radians, tau
from typing import TYPE_CHECKING, Any, ClassVar, TypedDict, Unpack
from weakref import WeakValueDictionary

from laticauda.motion.gaits.recorded import JointAngles
from laticauda.motion.gaits.reference import WaveTarget
from laticauda.values import (
    BadArgument,
    Extensible,
    Suggesting,
    UnitWarning,
    by_name_only,
    check_finite,
    check_items,
    check_whole_number,
    name_of,
    option,
    quantity,
    show_call,
    show_value,
    value_class,
    warn_caller,
)

# ---- envelopes -----------------------------------------------------------------------------------


class Envelope(Extensible, group="envelopes"):
    """Base class of envelopes: each kind of gait is a subclass, known by its class name.

    Example:
        >>> from laticauda.motion.gaits import Envelope
        >>> Envelope.named("eel-like")()(1, 4)
        0.6
    """

    words: ClassVar[str] = ""
    """Label of such a gait in tables and figures; "" for its name."""

    def __call__(self, i: int, n: int) -> float:
        """Return g of one joint.

        Args:
            i: Number of the joint; 1 is the tail-most.
            n: Number of links.
        """
        raise NotImplementedError

    def joints(self, n_links: int) -> tuple[float, ...]:
        """Return g of each of the n - 1 joints, tail first.

        Args:
            n_links: n.

        Raises:
            ValueError: If the envelope is for a different number of joints.
        """
        return _spread(self, n_links)

    @property
    def kind(self) -> str:
        """Name as spelled in Python, such as `eel_like`."""
        return name_of(type(self)).replace("-", "_")


@value_class
class LateralUndulation(Envelope):
    """Envelope of constant amplitude, g(i, n) = 1."""

    words: ClassVar[str] = "lateral undulation"

    def __call__(self, i: int, n: int) -> float:
        """Return 1."""
        return 1.0


@value_class
class EelLike(Envelope):
    """Envelope that grows from head to tail, g(i, n) = (n-i)/(n+1)."""

    words: ClassVar[str] = "eel-like motion"

    def __call__(self, i: int, n: int) -> float:
        """Return (n-i)/(n+1)."""
        return (n - i) / (n + 1)


@value_class
class Anguilliform(EelLike):
    """Eel-like envelope whose tail-most joint has the full amplitude, g(i, n) = (n-i)/(n-1)."""

    words: ClassVar[str] = "anguilliform motion"

    def __call__(self, i: int, n: int) -> float:
        """Return (n-i)/(n-1)."""
        return (n - i) / (n - 1)


@value_class
class Custom(Envelope):
    """Envelope of custom values, for robots with as many joints."""

    words: ClassVar[str] = "custom gait"

    values: tuple[float, ...] = quantity("", "g of every joint, tail first")

    def __call__(self, i: int, n: int) -> float:
        """Return the value of joint i."""
        return self.joints(n)[i - 1]

    def joints(self, n_links: int) -> tuple[float, ...]:
        """Return the values if their number matches the joints of `n_links` links.

        Args:
            n_links: Number of links of the robot [-].
        """
        if len(self.values) != n_links - 1:
            need = f"one value per joint, {n_links - 1} for {n_links} links"
            raise BadArgument("envelope", f"must have {need}, got {len(self.values)}")
        return self.values


GAIT_WORDS = {kind().kind: kind.words for kind in (LateralUndulation, EelLike)}
"""Labels of the paper's two kinds in tables and figures."""


def envelope_of(kind: str) -> Envelope:
    """Return an envelope by the name of its kind.

    Args:
        kind: A kind defined by its name alone (`kinds`), such as `eel_like` or `eel-like`.

    Raises:
        ValueError: If there is no such kind, or it needs values.
    """
    if not isinstance(kind, str):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise BadArgument("kind", f"must be the name of an envelope, got {show_value(kind)}")
    envelope_class = Envelope.named(kind.replace("_", "-"))
    if envelope_class is Custom:
        rule = f"must be an envelope that needs no values, got `{kind}`"
        raise BadArgument("kind", f"{rule}; use `Custom(values=...)`")
    return envelope_class()


def list_kinds() -> tuple[str, ...]:
    """Return the kinds of gait that are defined by a name alone, such as `eel_like`."""
    return tuple(name.replace("-", "_") for name in Envelope.names() if name != name_of(Custom))


@lru_cache(maxsize=64)  # a sweep requests the same few a million times
def _spread(envelope: Envelope, n_links: int) -> tuple[float, ...]:
    return tuple(float(envelope(i, n_links)) for i in range(1, n_links))


# ---- waves and gaits -----------------------------------------------------------------------------


class WaveFields(TypedDict, total=False):
    """Parameters of a wave, each in rad (rad/s) or, under its other name, in degrees; a frequency also in Hz."""

    amplitude: float
    amplitude_deg: float
    frequency: float
    frequency_deg_s: float
    frequency_hz: float
    phase_shift: float
    phase_shift_deg: float
    offset: float
    offset_deg: float


_MEANT = {
    "alpha": ("amplitude",),
    "amp": ("amplitude",),
    "angle": ("amplitude",),
    "delta": ("phase_shift",),
    "f": ("frequency",),
    "freq": ("frequency",),
    "omega": ("frequency",),
    "period": ("frequency",),
    "phase": ("phase_shift",),
    "phase_lag": ("phase_shift",),
    "phi_0": ("offset",),
    "phi0": ("offset",),
    "type": ("kind",),
}
"""Names of a gait's numbers by names that people try in vain."""


@value_class
class Wave(Suggesting):
    """Second wave, of the pitch joints or of a driven fin: alpha g(k, n) sin(omega t + (k-1) delta + phase) + phi_0.

    k = 1 is the tail-most of n - 1 pitch joints; a driven fin has one joint and thus neither phase
    shift nor envelope. Everything except phase and envelope is filtered and started smoothly, like
    the yaw wave.

    Raises:
        ValueError: If a field is out of its range.
    """

    _meant = _MEANT

    if TYPE_CHECKING:

        def __init__(
            self,
            *,
            phase: float = 0.0,
            phase_deg: float = 0.0,
            envelope: Envelope = ...,
            **numbers: Unpack[WaveFields],
        ) -> None: ...

    amplitude: float = quantity("rad", "alpha, of the joint angles", ge=0.0, le=pi)
    frequency: float = quantity("rad/s", "omega", ge=0.0, in_hz=True)
    phase_shift: float = quantity(
        "rad", "delta between neighboring pitch joints", ge=-pi, le=pi, default=0.0
    )
    phase: float = quantity(
        "rad", "lead over the yaw wave at the tail-most joints", ge=-2 * pi, le=2 * pi, default=0.0
    )
    offset: float = quantity(
        "rad", "phi_0; positive turns down, or bends a fin left", ge=-pi, le=pi, default=0.0
    )
    envelope: Envelope = option(
        "g, distribution of the amplitude over pitch joints", default=LateralUndulation()
    )

    def __repr__(self) -> str:
        """Return the call that makes it, with round angles in degrees."""
        return show_call(self)

    def target(self, offset: float = 0.0) -> WaveTarget:
        """Return the wave's target for the reference generator; `offset` [rad] is added to the wave's own.

        Args:
            offset: Offset requested by a controller, added to the wave's own [rad].
        """
        return WaveTarget(
            self.amplitude, self.frequency, self.phase_shift, self.offset + offset, self.phase
        )


STRAIGHT = Wave(amplitude=0.0, frequency=0.0)
"""Wave of joints that stay straight."""


@value_class
class Gait(Suggesting):
    """Traveling wave of joint angles, phi_i = alpha g(i, n) sin(omega t + (i-1) delta) + phi_0.

    Equation (3) of the paper: i = 1 is the tail-most joint and n the number of links, so a positive
    phase shift sends the wave from head to tail and the robot swims head first. omega t is the
    integral of a frequency that may change, and the amplitude starts smoothly: see `Generator`. The
    `kind` is that of the envelope: lateral_undulation (g = 1), eel_like (g = (n-i)/(n+1)), custom,
    or a custom class (`Envelope`). With `phases`, every joint has a lead of its own, added to
    (i-1) delta. Recorded angles are added to the wave unchanged, without its smooth start (`recorded_gait`).

    Raises:
        ValueError: If a field is out of its range.
    """

    _meant = _MEANT

    if TYPE_CHECKING:

        def __init__(self, *, envelope: Envelope = ..., **fields: Unpack["GaitFields"]) -> None: ...

    amplitude: float = quantity("rad", "alpha, of the joint angles", ge=0.0, le=pi)
    frequency: float = quantity(
        "rad/s", "omega, an angular frequency as in the paper", ge=0.0, in_hz=True
    )
    phase_shift: float = quantity(
        "rad", "delta between neighboring joints; negative swims tail first", ge=-pi, le=pi
    )
    offset: float = quantity(
        "rad", "phi_0 of every joint; positive turns left", ge=-pi, le=pi, default=0.0
    )
    envelope: Envelope = option(
        "g, distribution of the amplitude along the body", default=LateralUndulation()
    )
    pitch: Wave | None = option("Wave of the pitch joints; None: they stay straight", default=None)
    fin: Wave | None = option("Wave of a driven fin; None: it stays straight", default=None)
    recorded: JointAngles | None = option(
        "Angles of yaw joints over time, to which the wave is added", default=None
    )
    phases: tuple[float, ...] | None = quantity(
        "rad",
        "Lead of every yaw joint over the wave, tail first; None: 0",
        default=None,
    )

    def __post_init__(self) -> None:
        """Check the consistency of the fields."""
        if self.fin is not None and self.fin.phase_shift != 0.0:
            raise BadArgument(
                "fin.phase_shift", f"must be 0: a fin has one joint, got {self.fin.phase_shift} rad"
            )

    def __repr__(self) -> str:
        """Return the call that makes it, with round angles in degrees."""
        return show_call(self)

    @property
    def kind(self) -> str:
        """Name of the envelope, such as `eel_like`."""
        return self.envelope.kind

    @property
    def words(self) -> str:
        """Label of its kind in tables and figures."""
        if self.recorded is not None:
            return "recorded motion"
        return self.envelope.words or self.kind.replace("_", " ")

    @staticmethod
    def former(table: Mapping[str, Any]) -> dict[str, Any]:
        """Convert a `table` of an older file, where kind and values of the envelope were separate keys.

        Args:
            table: Table from the file.
        """
        new = dict(table)
        kind = new.pop("kind", None)
        values = new.get("envelope")
        is_older = kind is not None or values is None or isinstance(values, list | tuple)
        if not is_older:
            return new
        new.pop("envelope", None)
        if kind is None and values is None:
            return new
        envelope: dict[str, Any] = {"kind": str(kind or "custom").replace("_", "-")}
        if values is not None:
            envelope["values"] = values
        new["envelope"] = envelope
        return new

    def targets(
        self, offset: float = 0.0, pitch_offset: float = 0.0
    ) -> tuple[WaveTarget, WaveTarget, WaveTarget]:
        """Return the targets for the reference generator: yaw joints, pitch joints, driven fin.

        Args:
            offset: Added to the offset of the yaw joints [rad].
            pitch_offset: Added to the offset of the pitch joints [rad].
        """
        yaw = WaveTarget(
            self.amplitude, self.frequency, self.phase_shift, self.offset + offset, 0.0
        )
        return yaw, (self.pitch or STRAIGHT).target(pitch_offset), (self.fin or STRAIGHT).target()

    def joint_envelope(self, n_links: int) -> tuple[float, ...]:
        """Return the envelope g of each of the n - 1 joints of a robot with `n_links` links, tail first.

        Args:
            n_links: n.

        Raises:
            ValueError: If a custom envelope is for a different number of joints.
        """
        return self.envelope.joints(n_links)

    def joint_phases(self, n_links: int) -> tuple[float, ...]:
        """Return the lead of each of the n - 1 joints over the wave, tail first [rad].

        Args:
            n_links: n.

        Raises:
            ValueError: If the gait has leads for a different number of joints.
        """
        n_joints = n_links - 1
        if self.phases is None:
            return (0.0,) * n_joints
        if len(self.phases) != n_joints:
            need = f"one lead per joint, {n_joints} for {n_links} links"
            raise BadArgument("phases", f"must have {need}, got {len(self.phases)}")
        return self.phases


FIRST_GAIT = Gait(amplitude=radians(30.0), frequency=radians(130.0), phase_shift=radians(40.0))
"""Gait of Mamba's first trial in the paper."""


class GaitFields(WaveFields, total=False):
    """Fields of `Gait` other than its envelope."""

    pitch: Wave | None
    fin: Wave | None
    recorded: JointAngles | None
    phases: tuple[float, ...] | None
    phases_deg: tuple[float, ...] | None


FASTEST = 6.0
"""Cycles per second that hardly any robot swims with; many that are given are degrees per second [Hz]."""
SMALLEST_AMPLITUDE = 1.6
"""An amplitude in degrees below this is rather one in rad [deg]."""
_DOUBTED = WeakValueDictionary[int, Gait]()
"""Gaits of whose numbers somebody was warned, by `id`."""


def was_doubted(gait: Gait) -> bool:
    """Return whether there was a warning about the numbers of a gait when it was made.

    Args:
        gait: The gait.
    """
    return _DOUBTED.get(id(gait)) is gait


def _warn_of_units(gait: Gait, fields: GaitFields) -> Gait:
    """Return a gait; warn of numbers that are accepted, but are probably in another unit."""
    warnings = _doubts_of_units(fields)
    for warning in warnings:
        warn_caller(warning, UnitWarning)
    if warnings:
        _DOUBTED[id(gait)] = gait
    return gait


def _doubts_of_units(fields: GaitFields) -> list[str]:
    doubts: list[str] = []
    amplitude = fields.get("amplitude_deg")
    if isinstance(amplitude, float | int) and 0.0 < amplitude < SMALLEST_AMPLITUDE:
        meaning = f"joints that bend {amplitude:g} of a degree"
        hint = f"did you mean amplitude={amplitude:g}, in rad?"
        doubts.append(f"amplitude_deg={amplitude:g} is {meaning}; {hint}")
    frequency = fields.get("frequency")
    if isinstance(frequency, float | int) and frequency > FASTEST * tau:
        cycles = f"{frequency / tau:.3g} cycles per second"
        hint = f"did you mean frequency_deg_s={frequency:g}?"
        doubts.append(f"frequency={frequency:g} in rad/s is {cycles}; {hint}")
    frequency_deg_s = fields.get("frequency_deg_s")
    if isinstance(frequency_deg_s, float | int) and frequency_deg_s > FASTEST * 360.0:
        cycles = f"{frequency_deg_s / 360.0:.3g} cycles per second"
        meaning = f"frequency_deg_s={frequency_deg_s:g} is {cycles}"
        doubts.append(f"{meaning}, more than a robot swims with")
    return doubts


def gait_by_name(kind: str, **fields: Unpack[GaitFields]) -> Gait:
    """Return a gait by the name of its kind.

    Args:
        kind: A kind defined by its name alone, such as `eel-like` or `eel_like`.
        fields: Fields of `Gait`, as for `lateral_undulation`.

    Raises:
        ValueError: If there is no such kind, it needs values, or a number is out of range.

    Example:
        >>> gait_by_name("eel-like", amplitude_deg=30, frequency_hz=0.5, phase_shift_deg=40)
        Gait(amplitude_deg=30, frequency_deg_s=180, phase_shift_deg=40, envelope=EelLike())
    """
    return _warn_of_units(Gait(envelope=envelope_of(kind), **fields), fields)


@by_name_only(Gait)
def lateral_undulation(**fields: Unpack[GaitFields]) -> Gait:
    """Return body waves of constant amplitude, g(i, n) = 1.

    Args:
        fields: amplitude alpha [rad], frequency omega [rad/s], phase_shift delta [rad], offset
            phi_0 [rad], or in degrees amplitude_deg, frequency_deg_s, phase_shift_deg, offset_deg,
            or frequency_hz; pitch and fin, the waves of pitch joints and of a driven fin; recorded,
            angles to which the wave is added.

    Raises:
        ValueError: If a number is not finite, or amplitude or frequency is negative.

    Example:
        >>> lateral_undulation(amplitude=0.5, frequency=2.0, phase_shift=0.7).joint_envelope(4)
        (1.0, 1.0, 1.0)
    """
    return _warn_of_units(Gait(**fields), fields)


@by_name_only(Gait)
def eel_like(**fields: Unpack[GaitFields]) -> Gait:
    """Return body waves that grow from head to tail, g(i, n) = (n-i)/(n+1).

    Args:
        fields: amplitude alpha [rad], frequency omega [rad/s], phase_shift delta [rad], offset
            phi_0 [rad], or in degrees amplitude_deg, frequency_deg_s, phase_shift_deg, offset_deg,
            or frequency_hz; pitch and fin, the waves of pitch joints and of a driven fin; recorded,
            angles to which the wave is added.

    Raises:
        ValueError: If a number is not finite, or amplitude or frequency is negative.

    Example:
        >>> eel_like(amplitude=0.5, frequency=2.0, phase_shift=0.7).joint_envelope(4)
        (0.6, 0.4, 0.2)
    """
    return _warn_of_units(Gait(envelope=EelLike(), **fields), fields)


@by_name_only(Gait)
def custom_gait(
    *,
    envelope: Callable[[int, int], float] | Sequence[float],
    n_links: int | None = None,
    **fields: Unpack[GaitFields],
) -> Gait:
    """Return body waves with a custom envelope.

    Args:
        envelope: g of every joint, tail first; or a function g(i, n) with i = 1 the tail-most
            joint, as in (3).
        n_links: n; needed when `envelope` is a function, and checked against the number of its
            values otherwise.
        fields: amplitude alpha [rad], frequency omega [rad/s], phase_shift delta [rad], offset
            phi_0 [rad], or in degrees amplitude_deg, frequency_deg_s, phase_shift_deg, offset_deg,
            or frequency_hz; pitch and fin, the waves of pitch joints and of a driven fin; recorded,
            angles to which the wave is added.

    Raises:
        ValueError: If a number is not finite, amplitude or frequency is negative, `n_links` is
            missing, or the envelope is for a different number of joints.

    Example:
        >>> gait = custom_gait(envelope=lambda i, n: i / n, n_links=4, amplitude=1, frequency=2, phase_shift=0.7)
        >>> gait.joint_envelope(4)
        (0.25, 0.5, 0.75)
    """
    if callable(envelope):
        if n_links is None:
            rule = "must be given when `envelope` is a function g(i, n), got None"
            raise BadArgument("n_links", rule)
        n = check_whole_number("n_links", n_links, 1)
        shape = envelope
        envelope = [shape(i, n) for i in range(1, n)]
    values = check_items(
        check_finite, "a sequence of numbers or a function g(i, n)", (), "envelope", envelope
    )
    gait = _warn_of_units(Gait(envelope=Custom(values=values), **fields), fields)
    if n_links is not None:
        gait.joint_envelope(check_whole_number("n_links", n_links, 1))
    return gait


def recorded_gait(angles: JointAngles, **fields: Any) -> Gait:
    """Return a recorded motion alone: no wave is added, and the frequency is that of the recording.

    Args:
        angles: Angles of the yaw joints over time.
        fields: Fields of `Gait` to override.

    Example:
        >>> gait = recorded_gait(JointAngles(time=(0.0, 1.0, 2.0), angle=((0.0, 0.5, 0.0), (0.1, 0.0, 0.1))))
        >>> gait.amplitude, gait.words
        (0.0, 'recorded motion')
    """
    values: dict[str, Any] = {
        "amplitude": 0.0,
        "frequency": angles.frequency,
        "phase_shift": 0.0,
        **fields,
    }
    return Gait(**values, recorded=angles)
