"""What compiled code is made of: the sources of a module and of all that it imports, as one digest.

Machine code on disk is filed under this digest, so an edited file, wherever it stands among the imports, has another
name and compiles anew; no list of files has to be kept by hand.
"""

import ast
import functools
import hashlib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

PACKAGE = Path(__file__).parent.parent


def closure(*modules: str, package: Path = PACKAGE) -> tuple[Path, ...]:
    """The files of the package that make up modules: their own, and those of all that they import, directly or not.

    What is imported for type checkers only does not count, nor do the ``__init__`` files on the way to a module.

    Args:
        modules: Their full names, as ``laticauda.planar.stepping``; templates of kernels too.
        package: Folder of the package.
    """
    found: set[Path] = set()
    left = [_file(package, name.split(".")[1:]) for name in modules]
    while left:
        path = left.pop()
        if path is not None and path not in found:
            found.add(path)
            left += [_file(package, way) for way in _imported(package, ast.parse(path.read_bytes()))]
    return tuple(sorted(found))


def digest_of(*modules: str, package: Path = PACKAGE) -> str:
    """Digest of the text of the `closure` of modules, 16 hexadecimal digits.

    Args:
        modules: Their full names.
        package: Folder of the package.
    """
    digest = hashlib.sha256()
    for path in closure(*modules, package=package):
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


sources_digest = functools.cache(digest_of)
"""The same, computed once per process."""


def named_after(digest: str, function: Callable[..., Any]) -> Callable[..., Any]:
    """Put a digest into the name under which Numba files the machine code of a function; it looks at nothing else.

    Args:
        digest: Of all that the function is made of.
        function: To be compiled.
    """
    function.__qualname__ += f"_{digest}"
    return function


def is_kept(compiled: Any) -> bool:
    """Whether machine code of a function that Numba caches is at hand or on disk; if not, its first call compiles.

    Args:
        compiled: As Numba's decorator returned it.
    """
    kept = Path(compiled.stats.cache_path).glob(f"*{compiled.py_func.__qualname__}-*.nbi")
    return bool(compiled.signatures) or any(kept)


def _file(package: Path, way: list[str]) -> Path | None:
    """The file of a module below the package; None if there is none of that name."""
    inside = package.joinpath(*way)
    choices = (inside.with_suffix(".py"), inside / "__init__.py") if way else ()
    return next((path for path in choices if path.is_file()), None)


def _imported(package: Path, tree: ast.AST) -> Iterator[list[str]]:
    """The modules of the package that a syntax tree imports, without the package's name."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.If) and ast.unparse(node.test).endswith("TYPE_CHECKING"):
            continue
        yield from _imported(package, node)
        if isinstance(node, ast.Import):
            ways = [alias.name.split(".") for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.module:
            way = node.module.split(".")
            inner = [[*way, alias.name] for alias in node.names]
            ways = [one if _file(package, one[1:]) else way for one in inner]
        else:
            continue
        yield from (way[1:] for way in ways if way[0] == package.name)
