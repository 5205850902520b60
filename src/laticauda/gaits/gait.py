"""What the joints are asked to do: the paper's gait (3) and its envelopes."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from laticauda.errors import finite, nearest, not_negative, whole

Envelope = Callable[[int, int], float]

_ENVELOPES: dict[str, Envelope] = {
    "lateral_undulation": lambda i, n: 1.0,
    "eel_like": lambda i, n: (n - i) / (n + 1),
}
GAIT_KINDS = (*_ENVELOPES, "custom")


@dataclass(frozen=True, kw_only=True)
class Gait:
    """A traveling wave of joint angles, phi_i = alpha g(i, n) sin(omega t + (i-1) delta) + phi_0 (3).

    i = 1 is the tail-most joint and n the number of links, so a positive phase shift swims head first.
    """

    kind: str = "lateral_undulation"
    """lateral_undulation (g = 1), eel_like (g = (n-i)/(n+1)) or custom."""
    amplitude: float
    """alpha [rad]."""
    frequency: float
    """omega, an angular frequency as in the paper [rad/s]."""
    phase_shift: float
    """delta between neighboring joints [rad]."""
    offset: float = 0.0
    """phi_0 of every joint; positive turns left [rad]."""
    envelope: tuple[float, ...] | None = None
    """g of every joint, tail first, for kind custom; None otherwise [-]."""

    def __post_init__(self) -> None:
        """Check every field once."""
        kind = str(self.kind).replace("-", "_")
        if kind not in GAIT_KINDS:
            raise ValueError(
                f"`kind` must be one of {', '.join(GAIT_KINDS)}, got {self.kind!r}{nearest(kind, GAIT_KINDS)}."
            )
        object.__setattr__(self, "kind", kind)
        object.__setattr__(self, "amplitude", not_negative("amplitude", self.amplitude, "rad"))
        object.__setattr__(self, "frequency", not_negative("frequency", self.frequency, "rad/s"))
        object.__setattr__(self, "phase_shift", finite("phase_shift", self.phase_shift, "rad"))
        object.__setattr__(self, "offset", finite("offset", self.offset, "rad"))
        if (self.envelope is None) == (kind == "custom"):
            raise ValueError("`envelope` must be given for kind custom, and only for it.")
        if self.envelope is not None:
            values = tuple(finite(f"envelope[{i}]", g) for i, g in enumerate(self.envelope))
            object.__setattr__(self, "envelope", values)

    def joint_envelope(self, n_links: int) -> tuple[float, ...]:
        """G of each of the n - 1 joints of a robot with `n_links` links, tail first.

        Raises:
            ValueError: If a custom envelope has another number of joints.
        """
        if self.envelope is None:
            shape = _ENVELOPES[self.kind]
            return tuple(shape(i, n_links) for i in range(1, n_links))
        if len(self.envelope) != n_links - 1:
            raise ValueError(
                f"`envelope` must have one value per joint ({n_links - 1} for {n_links} links), got {len(self.envelope)}."
            )
        return self.envelope


def lateral_undulation(*, amplitude: float, frequency: float, phase_shift: float, offset: float = 0.0) -> Gait:
    """Body waves of constant amplitude, g(i, n) = 1.

    Args:
        amplitude: alpha [rad].
        frequency: omega [rad/s].
        phase_shift: delta [rad].
        offset: phi_0 [rad].

    Raises:
        ValueError: If an argument is not a finite number, or amplitude or frequency is negative.

    Example:
        >>> lateral_undulation(amplitude=0.5, frequency=2.0, phase_shift=0.7).joint_envelope(4)
        (1.0, 1.0, 1.0)
    """
    return Gait(
        kind="lateral_undulation", amplitude=amplitude, frequency=frequency, phase_shift=phase_shift, offset=offset
    )


def eel_like(*, amplitude: float, frequency: float, phase_shift: float, offset: float = 0.0) -> Gait:
    """Body waves that grow from head to tail, g(i, n) = (n-i)/(n+1).

    Args:
        amplitude: alpha [rad].
        frequency: omega [rad/s].
        phase_shift: delta [rad].
        offset: phi_0 [rad].

    Raises:
        ValueError: If an argument is not a finite number, or amplitude or frequency is negative.

    Example:
        >>> eel_like(amplitude=0.5, frequency=2.0, phase_shift=0.7).joint_envelope(4)
        (0.6, 0.4, 0.2)
    """
    return Gait(kind="eel_like", amplitude=amplitude, frequency=frequency, phase_shift=phase_shift, offset=offset)


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
        n_links: n; needed when `envelope` is a function.

    Raises:
        ValueError: If an argument is not a finite number, or `n_links` is missing.

    Example:
        >>> custom_gait(envelope=lambda i, n: i / n, n_links=4, amplitude=1, frequency=2, phase_shift=0.7).envelope
        (0.25, 0.5, 0.75)
    """
    if callable(envelope):
        if n_links is None:
            raise ValueError("`n_links` must be given when `envelope` is a function g(i, n).")
        n = whole("n_links", n_links, 1)
        shape = envelope
        envelope = [shape(i, n) for i in range(1, n)]
    return Gait(
        kind="custom",
        amplitude=amplitude,
        frequency=frequency,
        phase_shift=phase_shift,
        offset=offset,
        envelope=tuple(envelope),
    )
