"""Order of bodies that carry each other."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from laticauda.values import RobotFileError


class LargestTree(NamedTuple):
    """The largest tree of bodies that carry each other."""

    names: list[str]
    """Its bodies, every parent before its children."""
    loose: list[str]
    """Bodies that are not in it."""


def order_by_tree(
    names: Sequence[str],
    parents: Mapping[str, str],
    path: Path,
) -> LargestTree:
    """Return the largest tree of bodies.

    Args:
        names: All bodies, in the order of the file.
        parents: Parents, by the names of their children.
        path: Path of the file, for messages.

    Raises:
        RobotFileError: If bodies carry each other in a circle.
    """
    children: dict[str, list[str]] = {name: [] for name in names}
    for name in names:
        if name in parents:
            children[parents[name]].append(name)
    trees = [_list_tree(name, children) for name in names if name not in parents]
    if not trees:
        raise RobotFileError(f"{path}: its links carry each other in a circle, none is the first")
    largest = max(trees, key=len)
    in_largest = set(largest)
    loose = [name for name in names if name not in in_largest]
    return LargestTree(names=largest, loose=loose)


def _list_tree(root: str, children: Mapping[str, Sequence[str]]) -> list[str]:
    """Return a body and all that it carries."""
    order = [root]
    for name in order:  # grows meanwhile
        order.extend(children[name])
    return order
