"""Imports for type checkers in the `__init__` of each package, made from its table of public names.

    python tests/faces.py --update   # after a change of a table

The table is an argument of `lazy_exports`, see `laticauda.values.packaging`. Type checkers and
import-linter do not read it, so that its names also stand as imports under `if TYPE_CHECKING`.
"""

import argparse
import ast
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parent.parent
WIDTH = 100
"""Longest line of code, as in pyproject.toml."""
INDENT = " " * 4


@dataclass(frozen=True)
class Face:
    """The `__init__` of a package whose names are imported when they are first used."""

    path: Path
    homes: dict[str, list[str]]
    """Names by the module that defines them, from the table, and then those that are handed on as they are."""
    own: list[str]
    """Names that the `__init__` defines or imports at once."""
    imports: dict[str, list[str]]
    """Names by module, from the imports for type checkers."""
    lines: range | None
    """Lines of those imports, counted from 0; None if there is no `if TYPE_CHECKING`."""

    def updated(self) -> str:
        """Return the text of the `__init__` with imports as in the table."""
        if self.lines is None:
            raise ValueError(f"{self.path} has no `if TYPE_CHECKING`")
        text = self.path.read_text(encoding="utf-8").splitlines()
        block: list[str] = []
        for module, names in self.homes.items():
            block += import_lines(module, names)
        text[self.lines.start : self.lines.stop] = block
        return "\n".join(text) + "\n"


def import_lines(module: str, names: list[str]) -> list[str]:
    """Return the import of these names, indented, as the formatter writes it."""
    parts = [f"{name} as {name}" for name in names]
    line = f"{INDENT}from {module} import {', '.join(parts)}"
    if len(line) <= WIDTH:
        return [line]
    middle = [f"{INDENT * 2}{part}," for part in parts]
    return [f"{INDENT}from {module} import (", *middle, f"{INDENT})"]


def read_face(path: Path) -> Face | None:
    """Return the face in this `__init__`; None if its names are not imported lazily."""
    homes: dict[str, list[str]] | None = None
    own: list[str] = []
    plain: dict[str, list[str]] = {}
    imports: dict[str, list[str]] = {}
    lines: range | None = None
    for statement in ast.parse(path.read_text(encoding="utf-8")).body:
        match statement:
            case ast.If(test=ast.Name(id="TYPE_CHECKING"), body=body):
                lines = range(body[0].lineno - 1, body[-1].end_lineno or 0)
                imports = imported_names(body)
            case ast.Assign(
                value=ast.Call(func=ast.Name(id="lazy_exports"), args=[_, table], keywords=keywords)
            ):
                homes = ast.literal_eval(table)
                for keyword in keywords:
                    if keyword.arg == "own":
                        own = ast.literal_eval(keyword.value)
                    elif keyword.arg == "plain":
                        plain = ast.literal_eval(keyword.value)
            case _:
                pass
    if homes is None:
        return None
    for module, names in plain.items():
        homes[module] = [*homes.get(module, []), *names]
    return Face(path, homes, own, imports, lines)


def imported_names(body: list[ast.stmt]) -> dict[str, list[str]]:
    """Return the names that these statements import, by module."""
    imports: dict[str, list[str]] = {}
    for statement in body:
        if isinstance(statement, ast.ImportFrom):
            names = imports.setdefault(statement.module or "", [])
            names += [alias.name for alias in statement.names]
    return imports


def find_faces() -> list[Face]:
    """Return the faces of the package and of the plugins."""
    paths = [*ROOT.glob("src/**/__init__.py"), *ROOT.glob("plugins/*/src/**/__init__.py")]
    faces = [read_face(path) for path in sorted(paths)]
    return [face for face in faces if face is not None]


def main() -> None:
    """Write the imports of every face anew."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--update", action="store_true", required=True)
    parser.parse_args()
    for face in find_faces():
        is_outdated = face.lines is not None and face.updated() != face.path.read_text("utf-8")
        if is_outdated or face.imports != face.homes:
            face.path.write_text(face.updated(), encoding="utf-8")


if __name__ == "__main__":
    main()
