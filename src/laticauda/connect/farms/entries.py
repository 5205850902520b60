"""Reader of FARMS's YAML files: tables whose values are checked when they are asked for.

FARMS writes objects of its own classes with tags of Python. No object is made of them: a tag is
dropped, and what stands behind it is taken as plain data.
"""

import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple, cast

from laticauda.connect.farms.bodies import Limits
from laticauda.values import RobotFileError, optional_import, show_value
from laticauda.values.files import read_text

PYTHON_TAG = "tag:yaml.org,2002:python/"
"""Beginning of the tags of Python's objects."""


class Entry(NamedTuple):
    """A table in a file."""

    path: Path
    """Path of the file."""
    place: str
    """Where it stands in the file, such as `control.network`; "" for all of it."""
    table: Mapping[str, Any]
    """Its values, by their keys."""

    def error(
        self,
        key: str,
        rule: str,
    ) -> RobotFileError:
        """Return the error about a value.

        Args:
            key: Its key.
            rule: What it must be, and what was there.
        """
        return RobotFileError(f"{self.path}: `{self._name(key)}` {rule}")

    def _name(self, key: str) -> str:
        return f"{self.place}.{key}".lstrip(".")

    def has(self, key: str) -> bool:
        """Return whether a key has a value.

        Args:
            key: Its key.
        """
        return self.table.get(key) is not None

    def number(
        self,
        key: str,
        default: float | None = None,
    ) -> float:
        """Return a finite number.

        Args:
            key: Its key.
            default: Number if there is none; None: there must be one.
        """
        return self._check_number(key, self.table.get(key), default)

    def numbers(
        self,
        key: str,
        count: int,
        default: float,
    ) -> list[float]:
        """Return the first numbers of a list.

        Args:
            key: Its key.
            count: How many.
            default: Number in place of those that are missing.
        """
        items = self.table.get(key)
        if items is None:
            return [default] * count
        if not isinstance(items, list):
            raise self.error(key, f"must be a list of numbers, got {_show(items)}")
        numbers: list[float] = []
        for i, number in enumerate(cast(list[Any], items)[:count]):
            numbers.append(self._check_number(f"{key}[{i}]", number, default))
        numbers += [default] * (count - len(numbers))
        return numbers

    def limits(self, key: str) -> Limits:
        """Return the least and the largest value of something; infinite if the file gives no list.

        Args:
            key: Its key.
        """
        limits = self.table.get(key)
        if limits is None:
            return Limits(low=-math.inf, high=math.inf)
        if not isinstance(limits, list) or len(cast(list[Any], limits)) != 2:
            raise self.error(key, f"must be a list of two numbers, got {_show(limits)}")
        low, high = cast(list[Any], limits)
        for limit in (low, high):
            if not isinstance(limit, int | float) or math.isnan(limit):
                raise self.error(key, f"must be a list of two numbers, got {_show(limit)} in it")
        return Limits(low=float(low), high=float(high))

    def lists_of_numbers(
        self,
        key: str,
        n_lists: int,
        count: int,
    ) -> list[list[float]]:
        """Return lists of numbers in a list; zeros for those that are missing.

        Args:
            key: Its key.
            n_lists: How many lists.
            count: How many numbers in each.
        """
        lists = self.table.get(key)
        if lists is None:
            lists = []
        if not isinstance(lists, list):
            raise self.error(key, f"must be a list of lists, got {_show(lists)}")
        contents = cast(list[Any], lists)[:n_lists]
        contents += [None] * (n_lists - len(contents))
        names = [f"{key}[{i}]" for i in range(n_lists)]
        holder = Entry(self.path, self.place, dict(zip(names, contents, strict=True)))
        return [holder.numbers(name, count, 0.0) for name in names]

    def flag(
        self,
        key: str,
        default: bool,
    ) -> bool:
        """Return whether something is so.

        Args:
            key: Its key.
            default: Whether it is if the file does not say.
        """
        value = self.table.get(key)
        if value is None:
            return default
        return bool(value)

    def _check_number(
        self,
        key: str,
        value: Any,
        default: float | None,
    ) -> float:
        if value is None and default is not None:
            return default
        number = math.nan
        if isinstance(value, int | float) and not isinstance(value, bool):
            number = float(value)
        if not math.isfinite(number):
            raise self.error(key, f"must be a finite number, got {_show(value)}")
        return number

    def text(
        self,
        key: str,
        default: str | None = None,
    ) -> str:
        """Return a text.

        Args:
            key: Its key.
            default: Text if there is none; None: there must be one.
        """
        text = self.table.get(key)
        if text is None and default is not None:
            return default
        if not isinstance(text, str):
            raise self.error(key, f"must be a text, got {_show(text)}")
        return text

    def inner(self, key: str) -> "Entry":
        """Return a table in this one; an empty one if there is none.

        Args:
            key: Its key.
        """
        table = self.table.get(key)
        if table is None:
            table = {}
        if not isinstance(table, dict):
            raise self.error(key, f"must be a table, got {_show(table)}")
        return Entry(self.path, self._name(key), cast(dict[str, Any], table))

    def items(self, key: str) -> Iterator["Entry"]:
        """Yield the tables of a list, none if there is no list.

        Args:
            key: Its key.
        """
        tables = self.table.get(key)
        if tables is None:
            return
        if not isinstance(tables, list):
            raise self.error(key, f"must be a list of tables, got {_show(tables)}")
        for i, table in enumerate(cast(list[Any], tables)):
            if not isinstance(table, dict):
                raise self.error(f"{key}[{i}]", f"must be a table, got {_show(table)}")
            yield Entry(self.path, f"{self._name(key)}[{i}]", cast(dict[str, Any], table))

    def is_list_of_numbers(self, key: str) -> bool:
        """Return whether a value is a list that holds no tables.

        Args:
            key: Its key.
        """
        items = self.table.get(key)
        if not isinstance(items, list):
            return False
        return not any(isinstance(item, dict) for item in cast(list[Any], items))

    def count(self, key: str) -> int:
        """Return how many items a list has.

        Args:
            key: Its key.
        """
        items = self.table.get(key)
        if not isinstance(items, list):
            return 0
        return len(cast(list[Any], items))


def _show(value: Any) -> str:
    """Return what a message shows of a value: of one that holds others, which aliases may make endless, its kind."""
    if isinstance(value, list | dict):
        return f"a {type(cast(Any, value)).__name__}"
    return show_value(value)


def read_entries(path: str | Path) -> Entry:
    """Read a YAML file that holds a table.

    Args:
        path: Path of the file.

    Raises:
        RobotFileError: If it cannot be read.
    """
    text = read_text(path, RobotFileError)
    yaml = optional_import(
        feature="Reading an animat of FARMS",
        package="PyYAML",
        extra="farms",
        module="yaml",
    )
    try:
        table = yaml.load(text, Loader=_plain_loader(yaml))
    except yaml.YAMLError as failure:
        mark = getattr(failure, "problem_mark", None)
        problem = getattr(failure, "problem", None) or failure
        line = ""
        if mark is not None:
            line = f" in line {mark.line + 1}"
        raise RobotFileError(f"{path}: is not YAML{line}: {problem}") from None
    except RecursionError:
        raise RobotFileError(f"{path}: is not YAML: nested too deeply") from None
    except ValueError as failure:  # of a date or a number that cannot be one
        raise RobotFileError(f"{path}: is not YAML: {failure}") from None
    if not isinstance(table, dict):
        raise RobotFileError(f"{path}: must hold a table, as an animat of FARMS does")
    return Entry(Path(path), "", cast(dict[str, Any], table))


def _plain_loader(yaml: Any) -> Any:
    """Return a loader that makes plain data only, whatever the tags."""

    class PlainLoader(yaml.SafeLoader):
        pass

    def make_plain(
        loader: Any,
        suffix: str,
        node: Any,
    ) -> Any:
        if isinstance(node, yaml.ScalarNode):
            return loader.construct_scalar(node)
        if isinstance(node, yaml.SequenceNode):
            return loader.construct_sequence(node, deep=True)
        return loader.construct_mapping(node, deep=True)

    PlainLoader.add_multi_constructor(PYTHON_TAG, make_plain)
    return PlainLoader
