"""Files of the package that code is made of, and the digest of their text.

Machine code is stored under a digest of a module and everything that it imports, so editing any of
these files changes the name, and no list of files has to be maintained by hand.

Imports are found by parsing, which takes a tenth of a second for the kernels. A `SourceRecord` lists
the files that were found; as long as all of them are what they were, the imports are, too, and
nothing is parsed.
"""

import ast
import contextlib
import functools
import hashlib
import json
from collections.abc import Iterable, Iterator
from dataclasses import asdict, dataclass
from importlib.util import cache_from_source
from pathlib import Path

from laticauda.values import files

PACKAGE = Path(__file__).parent.parent
"""Folder of the package."""


@dataclass(frozen=True, kw_only=True)
class SourceRecord:
    """Files that code was made of: it tells without parsing whether code that is kept still fits."""

    sources: list[str]
    """Files of the modules, relative to the package."""
    digest: str
    """Digest of the text of these files."""
    faces: list[str]
    """Further files that determine what is imported: the ``__init__`` of packages that hand on names."""
    digest_of_faces: str
    """Digest of the text of these files."""

    @classmethod
    def of(cls, *modules: str, package: Path = PACKAGE) -> "SourceRecord":
        """Return the record of modules, which are parsed.

        Args:
            modules: Full module names.
            package: Folder of the package.
        """
        search = _Search(package)
        search.follow(modules)
        sources, faces = sorted(search.sources), sorted(search.faces)
        return cls(
            sources=[path.relative_to(package).as_posix() for path in sources],
            digest=_digest_files(sources),
            faces=[path.relative_to(package).as_posix() for path in faces],
            digest_of_faces=_digest_files(faces),
        )

    @classmethod
    def read(cls, text: str) -> "SourceRecord | None":
        """Return the record that `write` wrote; None if the text is none.

        Args:
            text: Text in JSON.
        """
        try:
            return cls(**json.loads(text))
        except (ValueError, TypeError):
            return None

    def write(self) -> str:
        """Return the record as text in JSON."""
        return json.dumps(asdict(self))

    def is_current(self, package: Path = PACKAGE) -> bool:
        """Return whether all files are what they were.

        Args:
            package: Folder of the package.
        """
        try:
            digest = _digest_files(package / name for name in self.sources)
            digest_of_faces = _digest_files(package / name for name in self.faces)
        except OSError:
            return False
        return (digest, digest_of_faces) == (self.digest, self.digest_of_faces)


def closure(*modules: str, package: Path = PACKAGE) -> tuple[Path, ...]:
    """Return the package's files that make up modules: their own and those of all direct and indirect imports.

    Imports for type checkers only do not count, nor do the ``__init__`` files of a module's parent
    packages. A name that is imported from the ``__init__`` of a package counts as imported from the
    module that defines it.

    Args:
        modules: Full module names, such as ``laticauda.models.planar.stepping``; may be kernel templates.
        package: Folder of the package.
    """
    search = _Search(package)
    search.follow(modules)
    return tuple(sorted(search.sources))


def digest_of(*modules: str, package: Path = PACKAGE) -> str:
    """Return the digest of the text of the `closure` of modules, 16 hexadecimal digits.

    Args:
        modules: Full module names.
        package: Folder of the package.
    """
    return _digest_files(closure(*modules, package=package))


@functools.cache
def sources_digest(*modules: str) -> str:
    """Return the `digest_of` modules of this package, computed once per process, and parsed only after an edit.

    Args:
        modules: Full module names.
    """
    path = _record_path(modules)
    record = None
    with contextlib.suppress(OSError, ValueError):
        record = SourceRecord.read(path.read_text(encoding="utf-8"))
    if record is not None and record.is_current():
        return record.digest
    record = SourceRecord.of(*modules)
    # There may be no place for it.
    with contextlib.suppress(OSError):
        files.write(path, record.write())
    return record.digest


def _record_path(modules: Iterable[str]) -> Path:
    """Return the path of the record of modules: where Python keeps what it made of this file."""
    key = hashlib.sha256(" ".join(modules).encode()).hexdigest()[:16]
    return Path(cache_from_source(__file__)).with_name(f"sources-{key}.json")


def _digest_files(paths: Iterable[Path]) -> str:
    digest = hashlib.sha256()
    for path in paths:
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


class _Search:
    """Search for the files that modules of a package are made of."""

    def __init__(self, package: Path) -> None:
        self.package = package
        self.sources: set[Path] = set()
        """Files of the modules."""
        self.faces: set[Path] = set()
        """Files of packages in which the modules of names were looked up."""

    def follow(self, modules: Iterable[str]) -> None:
        """Add modules, and all modules that they import directly or indirectly."""
        pending = [self._file(name.split(".")[1:]) for name in modules]
        while pending:
            path = pending.pop()
            if path is None or path in self.sources:
                continue
            self.sources.add(path)
            for module, name in _list_imports(path.read_bytes()):
                home = list(module) if name is None else self._home(list(module), name)
                if home[0] == self.package.name:
                    pending.append(self._file(home[1:]))

    def _file(self, names: list[str]) -> Path | None:
        """Return the file of a module in the package; None if there is none of that name."""
        if not names:
            return None
        inside = self.package.joinpath(*names)
        for path in (inside.with_suffix(".py"), inside / "__init__.py"):
            if path.is_file():
                return path
        return None

    def _home(self, module: list[str], name: str) -> list[str]:
        """Return the module from which a name comes: it may be a module itself, or be handed on by a package."""
        if self._file([*module[1:], name]):
            return [*module, name]
        face = self.package.joinpath(*module[1:], "__init__.py")
        if module[0] == self.package.name and face.is_file():
            self.faces.add(face)
            return _homes_of_names(face.read_bytes()).get(name, module)
        return module


@functools.cache
def _list_imports(text: bytes) -> list[tuple[tuple[str, ...], str | None]]:
    """Return the imports in a file: modules, each with the name that is taken from it, None for the module itself."""
    return list(_find_imports(ast.parse(text)))


def _find_imports(tree: ast.AST) -> Iterator[tuple[tuple[str, ...], str | None]]:
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.expr) or _is_for_type_checkers(node):
            continue
        yield from _find_imports(node)
        if isinstance(node, ast.Import):
            for alias in node.names:
                yield tuple(alias.name.split(".")), None
        elif isinstance(node, ast.ImportFrom) and node.module:
            for alias in node.names:
                yield tuple(node.module.split(".")), alias.name


def _is_for_type_checkers(node: ast.AST) -> bool:
    return isinstance(node, ast.If) and ast.unparse(node.test).endswith("TYPE_CHECKING")


@functools.cache
def _homes_of_names(face: bytes) -> dict[str, list[str]]:
    """Return the modules of the names that a package imports when they are first used, see `values.packaging`."""
    homes: dict[str, list[str]] = {}
    for node in ast.parse(face).body:
        if not isinstance(node, ast.If) or not _is_for_type_checkers(node):
            continue
        for statement in node.body:
            if isinstance(statement, ast.ImportFrom) and statement.module:
                for alias in statement.names:
                    homes[alias.name] = statement.module.split(".")
    return homes
