"""What the joints are asked to do: the paper's gait (3) and its envelopes."""

from collections.abc import Callable, Iterable, Sequence
from functools import lru_cache
from typing import cast

from laticauda.errors import BadArgument, finite, whole
from laticauda.quantities import one_among, option, quantity, value

Envelope = Callable[[int, int], float]

# By kind, equation (3) of the paper.
_ENVELOPES: dict[str, Envelope] = {
    "lateral_undulation": lambda i, n: 1.0,
    "eel_like": lambda i, n: (n - i) / (n + 1),
}
GAIT_KINDS = (*_ENVELOPES, "custom")
GAIT_WORDS = {"lateral_undulation": "lateral undulation", "eel_like": "eel-like motion"}
"""What tables and figures call the kinds that have a name of their own."""


@value
class Wave:
    """A second wave, of the pitch joints or of a driven fin: alpha sin(omega t + (k-1) delta + phase) + phi_0.

    k = 1 is the tail-most pitch joint; a driven fin has one joint, and so no phase shift. Everything but the phase is
    filtered and started smoothly, as the yaw wave is.

    Raises:
        ValueError: If a field is out of its range.
    """

    amplitude: float = quantity("rad", "alpha", ge=0.0)
    frequency: float = quantity("rad/s", "omega", ge=0.0)
    phase_shift: float = quantity("rad", "delta between neighboring pitch joints", default=0.0)
    phase: float = quantity("rad", "How far it is ahead of the yaw wave, tail-most joints", default=0.0)
    offset: float = quantity("rad", "phi_0, positive turns down; of a fin, bends left", default=0.0)


@value
class Gait:
    """A traveling wave of joint angles, phi_i = alpha g(i, n) sin(omega t + (i-1) delta) + phi_0.

    Equation (3) of the paper: i = 1 is the tail-most joint and n the number of links, so a positive phase shift sends
    the wave from head to tail and the robot swims head first. omega t is the integral of a frequency that may change,
    and the amplitude starts smoothly: see `Generator`. Its kind is lateral_undulation (g = 1), eel_like
    (g = (n-i)/(n+1)) or custom, for which the envelope is given.

    Raises:
        ValueError: If a field is out of its range, or `envelope` and `kind` do not fit together.
    """

    kind: str = option("Of its envelope", default="lateral_undulation", check=one_among(*GAIT_KINDS))
    amplitude: float = quantity("rad", "alpha", ge=0.0)
    frequency: float = quantity("rad/s", "omega, an angular frequency as in the paper", ge=0.0)
    phase_shift: float = quantity("rad", "delta between neighboring joints; negative swims tail first")
    offset: float = quantity("rad", "phi_0 of every joint; positive turns left", default=0.0)
    envelope: tuple[float, ...] | None = quantity("", "g of every joint, tail first, for kind custom", default=None)
    pitch: Wave | None = option("What the pitch joints do; None: they stay straight", default=None)
    fin: Wave | None = option("What a driven fin does; None: it stays straight", default=None)

    def __post_init__(self) -> None:
        """Check what goes together."""
        if self.fin is not None and self.fin.phase_shift != 0.0:
            raise BadArgument("fin.phase_shift", f"must be 0: a fin has one joint, got {self.fin.phase_shift} rad")
        if (self.envelope is None) == (self.kind == "custom"):
            raise BadArgument(
                "envelope",
                f"must be given for kind `custom`, and only for it; `kind` is `{self.kind}`, got {self.envelope}",
            )

    def joint_envelope(self, n_links: int) -> tuple[float, ...]:
        """The envelope g of each of the n - 1 joints of a robot with `n_links` links, tail first.

        Args:
            n_links: n.

        Raises:
            ValueError: If a custom envelope has another number of joints.
        """
        if self.envelope is None:
            return _named_envelope(self.kind, n_links)
        if len(self.envelope) != n_links - 1:
            need = f"one value per joint, {n_links - 1} for {n_links} links"
            raise BadArgument("envelope", f"must have {need}, got {len(self.envelope)}")
        return self.envelope


@lru_cache(maxsize=64)  # a sweep asks for the same few a million times
def _named_envelope(kind: str, n_links: int) -> tuple[float, ...]:
    shape = _ENVELOPES[kind]
    return tuple(shape(i, n_links) for i in range(1, n_links))


def lateral_undulation(
    *,
    amplitude: float,
    frequency: float,
    phase_shift: float,
    offset: float = 0.0,
    pitch: Wave | None = None,
    fin: Wave | None = None,
) -> Gait:
    """Body waves of constant amplitude, g(i, n) = 1.

    Args:
        amplitude: alpha [rad].
        frequency: omega [rad/s].
        phase_shift: delta [rad].
        offset: phi_0 [rad].
        pitch: What the pitch joints do; None: they stay straight.
        fin: What a driven fin does; None: it stays straight.

    Raises:
        ValueError: If an argument is not a finite number, or amplitude or frequency is negative.

    Example:
        >>> lateral_undulation(amplitude=0.5, frequency=2.0, phase_shift=0.7).joint_envelope(4)
        (1.0, 1.0, 1.0)
    """
    return Gait(
        kind="lateral_undulation",
        amplitude=amplitude,
        frequency=frequency,
        phase_shift=phase_shift,
        offset=offset,
        pitch=pitch,
        fin=fin,
    )


def eel_like(
    *,
    amplitude: float,
    frequency: float,
    phase_shift: float,
    offset: float = 0.0,
    pitch: Wave | None = None,
    fin: Wave | None = None,
) -> Gait:
    """Body waves that grow from head to tail, g(i, n) = (n-i)/(n+1).

    Args:
        amplitude: alpha [rad].
        frequency: omega [rad/s].
        phase_shift: delta [rad].
        offset: phi_0 [rad].
        pitch: What the pitch joints do; None: they stay straight.
        fin: What a driven fin does; None: it stays straight.

    Raises:
        ValueError: If an argument is not a finite number, or amplitude or frequency is negative.

    Example:
        >>> eel_like(amplitude=0.5, frequency=2.0, phase_shift=0.7).joint_envelope(4)
        (0.6, 0.4, 0.2)
    """
    return Gait(
        kind="eel_like",
        amplitude=amplitude,
        frequency=frequency,
        phase_shift=phase_shift,
        offset=offset,
        pitch=pitch,
        fin=fin,
    )


def custom_gait(
    *,
    envelope: Envelope | Sequence[float],
    amplitude: float,
    frequency: float,
    phase_shift: float,
    offset: float = 0.0,
    n_links: int | None = None,
) -> Gait:
    """Body waves with an envelope of one's own.

    Args:
        envelope: g of every joint, tail first; or a function g(i, n) with i = 1 the tail-most joint, as in (3).
        amplitude: alpha [rad].
        frequency: omega [rad/s].
        phase_shift: delta [rad].
        offset: phi_0 [rad].
        n_links: n; needed when `envelope` is a function, and checked against the number of its values otherwise.

    Raises:
        ValueError: If an argument is not a finite number, amplitude or frequency is negative, `n_links` is missing, or
            the envelope has another number of joints.

    Example:
        >>> custom_gait(envelope=lambda i, n: i / n, n_links=4, amplitude=1, frequency=2, phase_shift=0.7).envelope
        (0.25, 0.5, 0.75)
    """
    if callable(envelope):
        if n_links is None:
            raise BadArgument("n_links", "must be given when `envelope` is a function g(i, n), got None")
        n = whole("n_links", n_links, 1)
        shape = envelope
        envelope = [shape(i, n) for i in range(1, n)]
    gait = Gait(
        kind="custom",
        amplitude=amplitude,
        frequency=frequency,
        phase_shift=phase_shift,
        offset=offset,
        envelope=_numbers(envelope),
    )
    if n_links is not None:
        gait.joint_envelope(whole("n_links", n_links, 1))
    return gait


def _numbers(envelope: object) -> tuple[float, ...]:
    """The values of an envelope as finite floats."""
    if isinstance(envelope, str) or not isinstance(envelope, Iterable):
        raise BadArgument("envelope", f"must be a sequence of numbers or a function g(i, n), got {envelope!r}")
    values = cast("Iterable[object]", envelope)
    return tuple(finite(f"envelope[{i}]", value) for i, value in enumerate(values))
