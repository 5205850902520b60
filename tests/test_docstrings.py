"""The docstrings: every public parameter is documented, and every example runs and prints what it says.

Undocumented parameters as a test failure: an idea of python-control's.
"""

import ast
import doctest
import importlib
from collections.abc import Iterator
from pathlib import Path

import pytest

SOURCES = Path(__file__).parent.parent / "src"
MODULES = sorted(SOURCES.rglob("*.py"))
Function = ast.FunctionDef | ast.AsyncFunctionDef


def named(path: Path) -> str:
    return ".".join(path.relative_to(SOURCES).with_suffix("").parts).removesuffix(".__init__")


def public_functions(tree: ast.AST, is_method: bool = False) -> Iterator[tuple[Function, bool]]:
    """Public functions and methods, without the bodies of functions, and without overloads' stubs."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
            yield from public_functions(node, is_method=True)
        if isinstance(node, Function) and not node.name.startswith("_"):
            decorators = {ast.unparse(decorator).partition("(")[0] for decorator in node.decorator_list}
            # A kernel compiled by Numba is internal, whatever its name.
            if not decorators & {"overload", "njit", "override", "typing.override"}:
                yield node, is_method and "staticmethod" not in decorators


def undocumented(function: Function, is_method: bool) -> list[str]:
    """Parameters that the docstring does not name: in its "Args:", or in backticks when it has no such section."""
    docstring = ast.get_docstring(function) or ""
    arguments = function.args
    names = [argument.arg for argument in (*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs)]
    names += [extra.arg for extra in (arguments.vararg, arguments.kwarg) if extra]
    if is_method:
        names = names[1:]
    refers = "arguments as" in docstring.lower() or "arguments and errors as" in docstring.lower()
    return [
        name
        for name in names
        if not name.startswith("_")
        and not refers
        and f"`{name}`" not in docstring
        and not any(line.strip().lstrip("*").startswith((f"{name}:", f"{name} (")) for line in docstring.splitlines())
    ]


@pytest.mark.parametrize("path", MODULES, ids=named)
def test_every_public_parameter_is_documented(path: Path):
    found = {
        f"{path.name}:{function.lineno} {function.name}": missing
        for function, is_method in public_functions(ast.parse(path.read_text(encoding="utf-8")))
        if (missing := undocumented(function, is_method))
    }
    assert not found


@pytest.mark.parametrize("path", [path for path in MODULES if ">>> " in path.read_text(encoding="utf-8")], ids=named)
def test_every_example_in_a_docstring_prints_what_it_says(path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(tmp_path)
    assert doctest.testmod(importlib.import_module(named(path)), optionflags=doctest.NORMALIZE_WHITESPACE).failed == 0
