"""The docstrings: every public parameter and field is documented, and every example prints what it says.

Public is what a package's `__init__` offers, and all of `angles` and `errors`. That an undocumented
parameter is a test failure is an idea of python-control's.
"""

import ast
import dataclasses
import doctest
import importlib
import inspect
import re
import textwrap
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from laticauda.values.errors import MissingExtra
from laticauda.values.quantities import texts_of

SOURCES = Path(__file__).parent.parent / "src"
PACKAGES = sorted(path.parent for path in SOURCES.rglob("__init__.py"))
WITH_EXAMPLES = [
    path for path in sorted(SOURCES.rglob("*.py")) if ">>> " in path.read_text(encoding="utf-8")
]


def dotted(path: Path) -> str:
    return ".".join(path.relative_to(SOURCES).with_suffix("").parts)


def public() -> dict[str, Any]:
    """Everything that is offered to users, by its full name where it is defined."""
    found: dict[str, Any] = {}
    for name in [*map(dotted, PACKAGES), "laticauda.values.angles", "laticauda.values.errors"]:
        module = importlib.import_module(name)
        offered = getattr(
            module, "__all__", [key for key in vars(module) if not key.startswith("_")]
        )
        for key in offered:
            try:
                thing = getattr(module, key)
            except (
                MissingExtra
            ):  # a door of what is too large for CI: looked at where that is installed
                continue
            if getattr(thing, "__module__", "").startswith("laticauda") and hasattr(
                thing, "__qualname__"
            ):
                found[f"{thing.__module__}.{thing.__qualname__}"] = thing
    return found


def functions(thing: Any) -> Iterator[Any]:
    """`thing` itself if it is a function, or the methods that a class defines."""
    if inspect.isfunction(thing):
        yield thing
    elif inspect.isclass(thing):
        members = [
            getattr(member, "__func__", member)
            for name, member in vars(thing).items()
            if not name.startswith("_")
        ]
        yield from filter(inspect.isfunction, members)


def undocumented_parameters(function: Any) -> list[str]:
    """Parameters that the docstring names neither in its "Args:" nor in backticks."""
    docstring = inspect.getdoc(function) or ""
    if re.search(rf"Arguments as for `({'|'.join(OF_OTHERS)})`", docstring):
        return []
    starts = {line.strip().lstrip("*").partition(":")[0] for line in docstring.splitlines()}
    # As it is written: the docstring says of `**changes` which keywords it stands for.
    written = inspect.signature(inspect.unwrap(function))
    names = [name for name in written.parameters if name not in {"self", "cls"}]
    return [name for name in names if name not in starts and f"`{name}`" not in docstring]


# Whose interface it is that we fill: its arguments are documented there.
OF_OTHERS = ("Type", "VecEnv")
# What `laticauda.values.codec` and `laticauda.values.extensions` look for in any class, and say what it is.
OF_THE_CODEC = {"called", "counted", "former"}


def undocumented_fields(cls: type) -> list[str]:
    """Fields of a dataclass that no docstring of their own follows, and that are not declared with a text.

    What a base has too is documented there.
    """
    declared = {name for name, text in texts_of(cls).items() if text} | OF_THE_CODEC
    declared |= {name for base in cls.__mro__[1:] for name in vars(base) if base is not object}
    body = ast.parse(textwrap.dedent(inspect.getsource(cls))).body[0].body  # pyright: ignore
    return [
        ast.unparse(node.target)
        for node, following in zip(body, [*body[1:], None], strict=True)
        if isinstance(node, ast.AnnAssign)
        and not ast.unparse(node.target).startswith("_")
        and ast.unparse(node.target) not in declared
        and not (isinstance(following, ast.Expr) and isinstance(following.value, ast.Constant))
    ]


def test_every_public_name_and_parameter_is_documented():
    things = public()
    missing = {
        name: "docstring"
        for name, thing in things.items()
        if callable(thing) and not inspect.getdoc(thing)
    }
    for name, thing in things.items():
        for function in functions(thing):
            if names := undocumented_parameters(function):
                missing[f"{name} {function.__name__}"] = ", ".join(names)
        if dataclasses.is_dataclass(thing) and (fields := undocumented_fields(thing)):  # pyright: ignore
            missing[f"{name} fields"] = ", ".join(fields)
    assert not missing


ELSEWHERE = re.compile(r"^ +\**\w+: (?:See (?:there|`)|As (?:for|in) `)", re.MULTILINE)
"""An argument that sends its reader to another docstring."""


def test_what_an_argument_is_stands_where_it_is_listed():
    found = [
        f"{path.relative_to(SOURCES)} {node.name}: {line.strip()}"
        for path in sorted(SOURCES.rglob("*.py"))
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.FunctionDef | ast.ClassDef)
        for line in ELSEWHERE.findall(ast.get_docstring(node, clean=False) or "")
    ]
    assert found == []
    assert (
        ELSEWHERE.findall("Args:\n    keep: See `fit`.\n    how: As for `run`.\n    seed: Of all.")
        != []
    )


@pytest.mark.parametrize("path", WITH_EXAMPLES, ids=dotted)
def test_every_example_in_a_docstring_prints_what_it_says(
    path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.chdir(tmp_path)
    module = importlib.import_module(dotted(path).removesuffix(".__init__"))
    assert doctest.testmod(module, optionflags=doctest.NORMALIZE_WHITESPACE).failed == 0
