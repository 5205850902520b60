"""How the amplitude of the joints is spread along the body: envelopes g(i, n) of equation (3) of the paper."""

from functools import lru_cache
from typing import ClassVar

from laticauda.errors import BadArgument, shown
from laticauda.extensions import Extensible, name_of
from laticauda.quantities import quantity, value


class Envelope(Extensible, group="envelopes"):
    """Base of envelopes: a kind of gait is one class below it, known by the class's name.

    Example:
        >>> from laticauda.gaits.envelopes import Envelope
        >>> Envelope.named("eel-like")()(1, 4)
        0.6
    """

    words: ClassVar[str] = ""
    """What tables and figures call such a gait; "": its name."""

    def __call__(self, i: int, n: int) -> float:
        """g of one joint.

        Args:
            i: Of the joint; 1 is the tail-most.
            n: Number of links.
        """
        raise NotImplementedError

    def joints(self, n_links: int) -> tuple[float, ...]:
        """g of each of the n - 1 joints, tail first.

        Args:
            n_links: n.

        Raises:
            ValueError: If it is for another number of joints.
        """
        return _spread(self, n_links)

    @property
    def kind(self) -> str:
        """Its name as Python spells it, `eel_like`."""
        return name_of(type(self)).replace("-", "_")


@value
class LateralUndulation(Envelope):
    """The same amplitude everywhere, g(i, n) = 1."""

    words: ClassVar[str] = "lateral undulation"

    def __call__(self, i: int, n: int) -> float:
        """1."""
        return 1.0


@value
class EelLike(Envelope):
    """Growing from head to tail, g(i, n) = (n-i)/(n+1)."""

    words: ClassVar[str] = "eel-like motion"

    def __call__(self, i: int, n: int) -> float:
        """(n-i)/(n+1)."""
        return (n - i) / (n + 1)


@value
class Anguilliform(EelLike):
    """Eel-like motion whose tail-most joint does the whole amplitude, g(i, n) = (n-i)/(n-1)."""

    words: ClassVar[str] = "anguilliform motion"

    def __call__(self, i: int, n: int) -> float:
        """(n-i)/(n-1)."""
        return (n - i) / (n - 1)


@value
class Custom(Envelope):
    """Values of one's own, for robots with as many joints."""

    words: ClassVar[str] = "custom gait"

    values: tuple[float, ...] = quantity("", "g of every joint, tail first")

    def __call__(self, i: int, n: int) -> float:
        """The value of that joint."""
        return self.joints(n)[i - 1]

    def joints(self, n_links: int) -> tuple[float, ...]:
        """The values, if there are as many as joints of `n_links` links."""
        if len(self.values) != n_links - 1:
            need = f"one value per joint, {n_links - 1} for {n_links} links"
            raise BadArgument("envelope", f"must have {need}, got {len(self.values)}")
        return self.values


GAIT_WORDS = {kind().kind: kind.words for kind in (LateralUndulation, EelLike)}
"""What tables and figures call the paper's two kinds."""


def envelope_of(kind: str) -> Envelope:
    """An envelope by the name of its kind.

    Args:
        kind: As `eel_like` or `eel-like`; one that a name alone tells (`kinds`).

    Raises:
        ValueError: If there is no such kind, or it needs values.
    """
    if not isinstance(kind, str):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise BadArgument("kind", f"must be the name of an envelope, got {shown(kind)}")
    found = Envelope.named(kind.replace("_", "-"))
    if found is Custom:
        raise BadArgument("kind", f"must be an envelope that needs no values, got `{kind}`; take `Custom(values=...)`")
    return found()


def kinds() -> tuple[str, ...]:
    """The kinds of gait that a name alone tells, as `eel_like`."""
    return tuple(name.replace("-", "_") for name in Envelope.names() if name != name_of(Custom))


@lru_cache(maxsize=64)  # a sweep asks for the same few a million times
def _spread(envelope: Envelope, n_links: int) -> tuple[float, ...]:
    return tuple(float(envelope(i, n_links)) for i in range(1, n_links))
