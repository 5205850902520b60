"""What `laticauda sweep` varies: names as options have them, and values with the unit in the name.

`amplitude-deg=10:50:100` is 100 values from 10 to 50 deg, both included; `normal-drag=1,1.5,2` is three values.
"""

import csv
import difflib
import io
import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from laticauda.cli.tables import aligned, read_in
from laticauda.errors import BadArgument
from laticauda.files import read_text

if TYPE_CHECKING:
    from laticauda.simulate import Parameter
    from laticauda.studies import Grid, Rows, Samples

# Fields of these go by their last word alone, like the options.
SHORT = ("gait", "water", "ground")
SUFFIXES = {"rad": "-deg", "rad/s": "-deg-s"}
FORM = "NAME=LOW:HIGH:COUNT or NAME=VALUE,VALUE,... with the unit in the name, as amplitude-deg=10:50:100"
RANGE_FORM = "NAME=LOW:HIGH, as amplitude-deg=10:50"
SAMPLES_FORM = "NAME=LOW:HIGH with --samples, as amplitude-deg=10:50"
MOST_COUNT = 10_000_000


def spelled(parameter: "Parameter") -> str:
    """How a parameter is typed."""
    root, *rest = parameter.name.split(".")
    short = (root in SHORT and len(rest) == 1) or rest == ["n_links"]
    return (".".join(rest) if short else parameter.name).replace("_", "-") + SUFFIXES.get(parameter.unit, "")


def listed(known: Mapping[str, "Parameter"]) -> str:
    """A table of what can be varied.

    Args:
        known: That.
    """
    lines = [("name", "unit", "")]
    for parameter in known.values():
        unit = read_in(0.0, parameter.unit)[1]
        lines.append((spelled(parameter), unit or "-", parameter.title))
    return aligned(lines)


def grid(words: Sequence[str], known: Mapping[str, "Parameter"]) -> "Grid":
    """Every combination of the values.

    Args:
        words: NAME=VALUES each.
        known: What can be varied.

    Raises:
        ValueError: If a word cannot be read.
    """
    from laticauda.studies import Grid

    found: dict[str, list[float]] = {}
    for word in words:
        name, text = _split(word)
        parameter, factor = _meant(name, known)
        _once(name, parameter.name in found)
        found[parameter.name] = [factor * value for value in _values(word, text)]
    return Grid(values=found)


def samples(words: Sequence[str], known: Mapping[str, "Parameter"], n_points: int, seed: int) -> "Samples":
    """Points that fill the ranges evenly.

    Args:
        words: NAME=LOW:HIGH each.
        known: What can be varied.
        n_points: How many points.
        seed: Of the sequence.

    Raises:
        ValueError: If a word cannot be read.
    """
    from laticauda.studies import Samples

    return Samples(ranges=ranges(words, known, SAMPLES_FORM), n_points=n_points, seed=seed)


def ranges(words: Sequence[str], known: Mapping[str, "Parameter"], form: str) -> dict[str, tuple[float, float]]:
    """Least and greatest values by parameter.

    Args:
        words: NAME=LOW:HIGH each.
        known: What can be varied.
        form: What a word looks like, for messages.

    Raises:
        ValueError: If a word cannot be read.
    """
    found: dict[str, tuple[float, float]] = {}
    for word in words:
        name, text = _split(word, form)
        parameter, factor = _meant(name, known)
        _once(name, parameter.name in found)
        ends = [_number(word, part, form) for part in text.split(":")]
        if len(ends) != 2:
            raise BadArgument("vary", f"must be {form}, got {word!r}")
        found[parameter.name] = (factor * ends[0], factor * ends[1])
    return found


def rows(path: str, known: Mapping[str, "Parameter"]) -> "Rows":
    """The points of a CSV file: names in the first line, a point in every other.

    Args:
        path: The file.
        known: What can be varied.

    Raises:
        ValueError: If the file cannot be read as such.
        OSError: If it cannot be read at all.
    """
    from laticauda.studies import Rows

    with io.StringIO(read_text(path), newline="") as file:
        lines = csv.reader(file)
        names = [name.strip() for name in next(lines, ())]
        if not names:
            raise BadArgument("list", f"must be a CSV file with the names of parameters in its first line, got {path}")
        meant = [_meant(name, known) for name in names]
        for i, name in enumerate(names):
            _once(name, meant[i][0].name in [parameter.name for parameter, _ in meant[:i]])
        columns: list[list[float]] = [[] for _ in names]
        for line in lines:
            if not line:
                continue
            where = f"{path}, line {lines.line_num}"
            if len(line) != len(names):
                raise BadArgument("list", f"must have {len(names)} numbers in every line, got {len(line)} in {where}")
            for column, (_, factor), text in zip(columns, meant, line, strict=True):
                column.append(factor * _number(f"{text} in {where}", text, "a table of numbers", "list"))
    return Rows(values={parameter.name: column for (parameter, _), column in zip(meant, columns, strict=True)})


def _split(word: str, form: str = FORM) -> tuple[str, str]:
    name, equals, text = word.partition("=")
    if not (name and equals and text):
        raise BadArgument("vary", f"must be {form}, got {word!r}")
    return name, text


def _meant(name: str, known: Mapping[str, "Parameter"]) -> tuple["Parameter", float]:
    """The parameter, and what its values are multiplied by."""
    plain = name.replace("_", "-")
    for parameter in known.values():
        word = spelled(parameter)
        suffix = SUFFIXES.get(parameter.unit, "")
        full = parameter.name.replace("_", "-")
        if plain in (word, full + suffix):
            return parameter, math.radians(1.0) if suffix else 1.0
        if plain == full:  # with dots: SI, as in Python
            return parameter, 1.0
    words = [spelled(parameter) for parameter in known.values()]
    near = difflib.get_close_matches(plain, words, n=3, cutoff=0.6)
    near += [word for word in words if word.rsplit(".", 1)[-1] == plain and word not in near]
    listed = f"; the nearest are {', '.join(near)}" if near else ""
    raise BadArgument("vary", f"must name what the robot, gait or water has, got {name!r}{listed} (--names lists all)")


def _once(name: str, is_there: bool) -> None:
    if is_there:
        raise BadArgument("vary", f"must name a parameter once, got {name!r} again")


def _values(word: str, text: str) -> list[float]:
    if ":" not in text:
        return [_number(word, part, FORM) for part in text.split(",")]
    parts = text.split(":")
    if len(parts) != 3:
        raise BadArgument("vary", f"must be {FORM}, got {word!r}")
    low, high, count = (_number(word, part, FORM) for part in parts)
    if not (count.is_integer() and 1 <= count <= MOST_COUNT):
        raise BadArgument("vary", f"must have a COUNT that is a whole number >= 1, got {word!r}")
    return np.linspace(low, high, int(count)).tolist()


def _number(word: str, text: str, form: str, option: str = "vary") -> float:
    try:
        number = float(text)
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        raise BadArgument(option, f"must be {form}, got {word!r}")
    return number
