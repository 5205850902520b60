"""The errors of laticauda, and the checks that raise them.

A bad argument is a `ValueError` that names the argument, the rule with its unit and the value it got.
What goes wrong in the world, and not in an argument, derives from `LaticaudaError`.
Each check returns the cleaned value, so that a dataclass can check and convert in one line.
Packages that come with one of laticauda's extras are imported when they are first needed, and not before; where one is
missing, the error says what to install. Processes that such an import starts, and our own workers, are deaf to Ctrl-C:
the error of it is for this process.
"""

import math
import signal
import sys
from collections.abc import Generator, Sequence, Sized
from contextlib import contextmanager, suppress
from importlib import import_module
from numbers import Integral, Real
from typing import Any


class LaticaudaError(Exception):
    """Base of everything that laticauda raises, apart from the `ValueError` for a bad argument."""


class BadArgument(ValueError):
    """An argument breaks a rule: a sentence for people, and its parts for those who know the argument by another name.

    Args:
        name: Of the argument.
        rule: The rule with its unit, and the value got, without a full stop.
    """

    def __init__(self, name: str, rule: str) -> None:
        super().__init__(name, rule)

    @property
    def name(self) -> str:
        """Of the argument, with an index in brackets where it is one of several."""
        return self.args[0]

    @property
    def rule(self) -> str:
        """The rule with its unit, and the value got, without a full stop."""
        return self.args[1]

    def __str__(self) -> str:
        """The sentence that the user reads."""
        return f"`{self.name}` {self.rule}{'' if self.rule.endswith('?') else '.'}"


class SimulationFailed(LaticaudaError, RuntimeError):
    """A run blew up: it says when, and what to try."""


class TrialFileError(LaticaudaError, ValueError):
    """A trial file cannot be read: it says which file, and why."""


class RobotFileError(LaticaudaError, ValueError):
    """A robot, water, ground or parameter file is wrong: it says which file, key, rule and value."""


class StorageFailed(LaticaudaError, OSError):
    """Results cannot be written or read, the disk is full for instance: it says where, why, and what is left."""


class ClusterFailed(LaticaudaError, RuntimeError):
    """A cluster of computers does not do its work: it says which, what happened, and what is left."""


class MissingExtra(LaticaudaError, ImportError):
    """A feature needs a package that comes with one of laticauda's extras.

    Args:
        feature: What was asked for, in words.
        package: The package that it needs.
        extra: The extra of laticauda that installs the package.
    """

    def __init__(self, feature: str, package: str, extra: str) -> None:
        # All three become `args`: an error that crosses a process boundary is rebuilt from them.
        super().__init__(feature, package, extra)

    def __str__(self) -> str:
        """The sentence that the user reads."""
        feature, package, extra = self.args
        return f'{feature} needs {package}; run `pip install "laticauda[{extra}]"`.'


class MissingProgram(LaticaudaError, RuntimeError):
    """A feature needs something that the operating system does not have.

    Args:
        feature: What was asked for, in words.
        thing: What it needs.
        packages: The packages of Debian and Ubuntu that install it.
    """

    def __init__(self, feature: str, thing: str, packages: str) -> None:
        super().__init__(feature, thing, packages)

    def __str__(self) -> str:
        """The sentence that the user reads."""
        feature, thing, packages = self.args
        return f"{feature} needs {thing}; on Debian and Ubuntu run `apt-get install {packages}`."


def finite(name: str, value: object, unit: str = "") -> float:
    """Return `value` as a float if it is one finite number.

    Numbers of numpy are as good as Python's. A truth value, a text, an array, nan and the infinities are refused.

    Args:
        name: The argument's name, as its user knows it.
        value: What was given.
        unit: The unit that the argument is in, "" for a pure number.

    Raises:
        ValueError: If `value` is no finite number.
    """
    in_unit = f" in {unit}" if unit else ""
    if isinstance(value, bool) or not isinstance(value, Real):
        raise BadArgument(name, f"must be a number{in_unit}, got {shown(value)}")
    try:
        number = float(value)
    except OverflowError:  # a Python integer beyond the largest float
        number = math.inf
    if not math.isfinite(number):
        raise BadArgument(name, f"must be a finite number{in_unit}, got {number}")
    return number


def positive(name: str, value: object, unit: str = "") -> float:
    """Return `value` as a float if it is a finite number > 0.

    Args:
        name: The argument's name, as its user knows it.
        value: What was given.
        unit: The unit that the argument is in, "" for a pure number.

    Raises:
        ValueError: If it is not.
    """
    number = finite(name, value, unit)
    if number <= 0.0:
        raise BadArgument(name, f"must be > 0{_spaced(unit)}, got {value}")
    return number


def not_negative(name: str, value: object, unit: str = "") -> float:
    """Return `value` as a float if it is a finite number >= 0.

    Args:
        name: The argument's name, as its user knows it.
        value: What was given.
        unit: The unit that the argument is in, "" for a pure number.

    Raises:
        ValueError: If it is not.
    """
    number = finite(name, value, unit)
    if number < 0.0:
        raise BadArgument(name, f"must be >= 0{_spaced(unit)}, got {value}")
    return number


def within(name: str, value: object, low: float, high: float, unit: str = "") -> float:
    """Return `value` as a float if `low <= value <= high`.

    Args:
        name: The argument's name, as its user knows it.
        value: What was given.
        low: The smallest number that is accepted.
        high: The largest one.
        unit: The unit that the argument is in, "" for a pure number.

    Raises:
        ValueError: If it is no finite number, or out of the range.
    """
    number = finite(name, value, unit)
    if not low <= number <= high:
        raise BadArgument(name, f"must be between {low:g} and {high:g}{_spaced(unit)}, got {value}")
    return number


def whole(name: str, value: object, least: int, most: int = sys.maxsize) -> int:
    """Return `value` as an int if it is a whole number >= `least`.

    Args:
        name: The argument's name, as its user knows it.
        value: What was given.
        least: The smallest number that is accepted.
        most: The largest one; what is larger than any memory is a slip everywhere.

    Raises:
        ValueError: If `value` is no integer (2.0 is none either), or out of the range.
    """
    if isinstance(value, bool) or not isinstance(value, Integral) or value < least:
        raise BadArgument(name, f"must be a whole number >= {least}, got {shown(value)}")
    number = int(value)
    if number > most:
        raise BadArgument(name, f"must be a whole number between {least} and {most}, got {shown(value)}")
    return number


def one_of(name: str, value: object, choices: Sequence[str]) -> str:
    """Return `value` if it is one of the texts in `choices`.

    Args:
        name: The argument's name, as its user knows it.
        value: What was given.
        choices: The texts that are accepted.

    Raises:
        ValueError: If it is not; the message lists the choices and suggests the nearest.
    """
    if isinstance(value, str) and value in choices:
        return value
    hint = nearest(value, choices) if isinstance(value, str) else ""
    listed = ", ".join(f"`{choice}`" for choice in choices)
    raise BadArgument(name, f"must be one of {listed}, got {shown(value)}{hint}")


def at_least_one(name: str, given: Sized, thing: str) -> None:
    """Refuse a list or a mapping with nothing in it.

    Args:
        name: The argument's name, as its user knows it.
        given: What was given.
        thing: What it is to hold, in a word.

    Raises:
        ValueError: If it is empty.
    """
    if len(given) == 0:
        raise BadArgument(name, f"must hold at least one {thing}, got none")


def instance(name: str, value: object, *kinds: type) -> object:
    """Return `value` if it is an object of one of these classes.

    Args:
        name: The argument's name, as its user knows it.
        value: What was given.
        kinds: The classes that will do.

    Raises:
        ValueError: If it is not.
    """
    if not isinstance(value, kinds):
        wanted = " or ".join(kind.__name__ for kind in kinds)
        raise BadArgument(name, f"must be of class {wanted}, got {type(value).__name__}")
    return value


def flag(name: str, value: object) -> bool:
    """Return `value` if it is true or false, and nothing that merely looks like it.

    Args:
        name: The argument's name, as its user knows it.
        value: What was given.

    Raises:
        ValueError: If it is not.
    """
    if not isinstance(value, bool):
        raise BadArgument(name, f"must be true or false, got {shown(value)}")
    return value


def text(name: str, value: object) -> str:
    """Return `value` if it is a text.

    Args:
        name: The argument's name, as its user knows it.
        value: What was given.

    Raises:
        ValueError: If it is not.
    """
    if not isinstance(value, str):
        raise BadArgument(name, f"must be a text, got {shown(value)}")
    return value


def label(name: str, value: object) -> str:
    """Return `value` if it can serve as a name: one line that is not blank.

    Args:
        name: The argument's name, as its user knows it.
        value: What was given.

    Raises:
        ValueError: If it cannot.
    """
    word = text(name, value)
    if not word.strip() or not word.isprintable():
        raise BadArgument(name, f"must be a text on one line that is not blank, got {word!r}")
    return word


def hostname(name: str, value: object) -> str:
    """Return `value` if it can be a host's name or address.

    Args:
        name: The argument's name, as its user knows it.
        value: What was given.

    Raises:
        ValueError: If it cannot.
    """
    word = text(name, value)
    with suppress(UnicodeError):
        word.encode("idna")
        if word and word.isprintable():
            return word
    raise BadArgument(name, f"must be the name or address of a host, got {word!r}")


def nearest(word: str, choices: Sequence[str]) -> str:
    """The end of a message about a mistyped `word`: "; did you mean `x`?", or "" if no one of `choices` comes near.

    Args:
        word: What was typed.
        choices: What is known.
    """
    import difflib

    by_plain = {_plain(choice): choice for choice in choices}
    found = difflib.get_close_matches(_plain(word), by_plain, n=1)
    return f"; did you mean `{by_plain[found[0]]}`?" if found else ""


def _plain(word: str) -> str:
    """`word` without what people mix up: capitals, hyphens and underscores."""
    return word.casefold().replace("-", "_")


def _spaced(unit: str) -> str:
    return f" {unit}" if unit else ""


def shown(value: object) -> str:
    """`value` as a message shows it: on one line, and short; of an array its shape."""
    shape = getattr(value, "shape", ())
    if shape:
        return f"an array of shape {shape}"
    if isinstance(value, Real):  # numpy's numbers read like Python's
        return str(value)
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:57]}..."


# ---- packages that may be missing -----------------------------------------------------------------------------------


def optional_import(feature: str, package: str, extra: str, module: str | None = None) -> Any:
    """A module that may not be installed.

    Args:
        feature: What needs it, in words.
        package: The package as the user knows it.
        extra: The extra of laticauda that installs the package.
        module: As it is imported; None: the package's name.

    Returns:
        The module. Where the package has no types, what comes from it is `Any`.

    Raises:
        MissingExtra: If it is not installed.
    """
    try:
        return import_module(module or package)
    except ImportError as error:
        raise MissingExtra(feature, package, extra) from error


def load_mujoco() -> Any:
    """The module `mujoco`. It has no types, so what comes from it is `Any` here.

    Raises:
        MissingExtra: If it is not installed.
    """
    with deaf():  # one of its imports asks Python in other processes, which would answer Ctrl-C with a traceback
        return optional_import("The 3D model", "MuJoCo", "spatial", "mujoco")


@contextmanager
def deaf() -> Generator[None]:
    """Ctrl-C waits until the end of this, and is for this process: those started here never get to know of it."""
    if not hasattr(signal, "pthread_sigmask"):  # Windows
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
