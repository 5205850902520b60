"""Which class a table describes, where the type of the field leaves a choice: its key `kind` names one."""

import types
from collections.abc import Mapping
from dataclasses import dataclass, is_dataclass
from typing import Any, TypeAlias, get_origin

from laticauda.values.annotations import Annotation
from laticauda.values.checks import check_choice, show_value
from laticauda.values.extensions import Extensible, name_of


@dataclass(frozen=True)
class GroupChoice:
    """A choice among all members of an extension point."""

    base: type[Extensible]

    def find(self, kind: Any) -> type:
        """Return the class of this `kind`.

        Args:
            kind: Its name in the table.

        Raises:
            ValueError: If there is none.
        """
        if not isinstance(kind, str):
            kind = show_value(kind)
        return self.base.named(kind)


@dataclass(frozen=True)
class UnionChoice:
    """A choice among the classes of a union."""

    classes: Mapping[str, type]
    """The classes by kind."""

    def find(self, kind: Any) -> type:
        """Return the class of this `kind`; see `GroupChoice.find`."""
        return self.classes[check_choice("kind", kind, tuple(self.classes))]


ClassChoice: TypeAlias = GroupChoice | UnionChoice


def class_choice_of(hint: Any) -> ClassChoice | None:
    """Return the choice that a type leaves; None: there is none.

    Args:
        hint: The type of a field, or of an item of it.
    """
    base = class_of(hint)
    if isinstance(base, type) and Extensible in base.__bases__:
        return GroupChoice(base)
    annotation = Annotation.of(hint)
    if not annotation.is_union:
        return None
    classes = {name_of(kind): kind for kind in annotation.classes if is_dataclass(kind)}
    if len(classes) > 1:
        return UnionChoice(types.MappingProxyType(classes))
    return None


def class_of(hint: Any) -> Any:
    """Return a type without its parameters, if it has any: ``Controller`` of ``Controller[int]``."""
    return get_origin(hint) or hint


def is_of_objects(hint: Any) -> bool:
    """Return whether a table describes a value of this type."""
    return is_dataclass(hint) or class_choice_of(hint) is not None
