"""Names that an object does not have: the error says which one may be meant, as the shell does for commands.

`Suggesting` is for classes, `packaging.lazy_exports` does the same for packages. The message is made
when it is read, since `hasattr` asks for many names that nobody misses.
"""

from collections.abc import Callable, Collection, Mapping, Sequence
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ClassVar

from laticauda.values.checks import suggest_nearest

Meant = Mapping[str, Sequence[str]]
"""What is probably meant, by names that people try."""
NOTHING_KNOWN: Meant = MappingProxyType({})


class UnknownName(AttributeError):
    """A name that an object does not have, with what may be meant instead.

    Args:
        owner: The object, in words.
        name: The name.
        find_hint: Returns the end of the message, "" if nothing similar is known.
    """

    def __init__(self, owner: str, name: str, find_hint: Callable[[], str]) -> None:
        # Python adds a suggestion of its own from the names of `obj`; None has none to offer.
        super().__init__(f"{owner} has no attribute {name!r}", name=name, obj=None)
        self._find_hint = find_hint

    def __str__(self) -> str:
        """Return the sentence shown to the user."""
        return f"{self.args[0]}{self._find_hint()}"

    def __reduce__(self) -> tuple[Any, ...]:
        """Let the error cross to another process, as its message."""
        return AttributeError, (str(self),)


def hint_at(name: str, meant: Meant, choices: Collection[str]) -> str:
    """Return the end of a message about a name that does not exist: "; did you mean x?", or "".

    Args:
        name: The name.
        meant: What is probably meant, by names that people try.
        choices: All names that exist.
    """
    plain = name.casefold().replace("-", "_")
    if plain in meant:
        return f"; did you mean {', '.join(meant[plain])}?"
    return suggest_nearest(name, [*choices]).replace("`", "")


class _SuggestingClass(type):
    """Class of `Suggesting` classes, for names of the class itself, such as a method that loads one."""

    if not TYPE_CHECKING:

        def __getattr__(cls, name: str) -> Any:
            raise _unknown_name(f"class {cls.__name__}", name, cls)


class Suggesting(metaclass=_SuggestingClass):
    """Base of classes that answer a wrong name with the right one. Python asks only where a name is missing."""

    _meant: ClassVar[Meant] = NOTHING_KNOWN
    """What is probably meant, by names that people try."""

    if not TYPE_CHECKING:  # type checkers know which names exist

        def __getattr__(self, name: str) -> Any:
            kind = type(self)
            if any(name in vars(base) for base in kind.__mro__):
                # A property that failed: let it raise its own error.
                return object.__getattribute__(self, name)
            raise _unknown_name(f"a {kind.__name__}", name, kind)


def _unknown_name(owner: str, name: str, kind: type[Any]) -> AttributeError:
    def find_hint() -> str:
        if name.startswith("_"):
            return ""
        public_names = [member for member in dir(kind) if not member.startswith("_")]
        public_names += getattr(kind, "__dataclass_fields__", ())
        return hint_at(name, kind._meant, public_names)

    return UnknownName(owner, name, find_hint)
