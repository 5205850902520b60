"""Type annotations of fields, taken apart: which types a value may have, and how many numbers.

Checks, files, flags and schemas all ask the same of an annotation: `Annotation.of` answers it once.
"""

import types
from dataclasses import dataclass
from typing import Any, Literal, Self, Union, get_args, get_origin


@dataclass(frozen=True)
class TupleAnnotation:
    """A tuple of items that all have the same type."""

    item: Any
    """Type of each item."""
    count: int | None
    """Number of items; None: any number."""

    @classmethod
    def of(cls, annotation: Any) -> Self:
        """Return what the annotation of a tuple says.

        Args:
            annotation: Such as ``tuple[float, float]`` or ``tuple[str, ...]``.
        """
        items = get_args(annotation)
        count = len(items)
        if items[-1] is Ellipsis:
            return cls(item=items[0], count=None)
        return cls(item=items[0], count=count)


@dataclass(frozen=True)
class Annotation:
    """A type annotation, taken apart."""

    whole: Any
    """The annotation itself."""
    members: tuple[Any, ...]
    """The types that a value may have, without None: those of a union, otherwise the only one."""
    is_union: bool
    """Whether there are several types, or a type and None."""
    accepts_none: bool
    """Whether a value may be None."""

    @classmethod
    def of(cls, annotation: Any) -> Self:
        """Take an annotation apart.

        Args:
            annotation: A type, without marks of `typing.Annotated`.
        """
        if get_origin(annotation) not in (types.UnionType, Union):
            return cls(annotation, members=(annotation,), is_union=False, accepts_none=False)
        alternatives = get_args(annotation)
        members = tuple(kind for kind in alternatives if kind is not types.NoneType)
        return cls(
            annotation,
            members=members,
            is_union=True,
            accepts_none=len(members) < len(alternatives),
        )

    @property
    def only_member(self) -> Any:
        """The type that a value has unless it is None; None if there are several."""
        if len(self.members) != 1:
            return None
        return self.members[0]

    @property
    def tuples(self) -> tuple[TupleAnnotation, ...]:
        """Those of the types that are tuples."""
        return tuple(TupleAnnotation.of(kind) for kind in self.members if is_tuple(kind))

    @property
    def classes(self) -> tuple[type, ...]:
        """Those of the types that are plain classes."""
        return tuple(kind for kind in self.members if isinstance(kind, type))

    @property
    def choices(self) -> tuple[str, ...]:
        """The texts among which a value is chosen; empty if it is not chosen among texts."""
        if get_origin(self.only_member) is not Literal:
            return ()
        return get_args(self.only_member)

    @property
    def is_whole_number(self) -> bool:
        """Whether a number, or each number of a tuple, is an integer."""
        first = self.members[0]
        return first is int or (is_tuple(first) and get_args(first)[0] is int)


def is_tuple(annotation: Any) -> bool:
    """Return whether this is the annotation of a tuple."""
    return get_origin(annotation) is tuple
