"""Compiled code and its sources: templates, loaded once per specialization, and digests of sources.

Machine code on disk is stored under a digest of a module and everything that it imports, so editing
any of these files changes the name and triggers recompilation; no list of files has to be
maintained by hand.

Templates are the modules of a package that kernels are made of. While it is loaded, each reads its
specialization and the preceding templates from its `bindings`. It is loaded once per combination of
the names that it depends on: another drag law reuses the drives. A specialization's name includes a
digest of all its sources and of the laws' own code, so the next process finds the compiled code on
disk again and the code is never stale: an edited law or kernel has another name and is recompiled.
The numbers of a law are rows, and not part of the digest.
"""

import ast
import functools
import hashlib
import importlib.util
import sys
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from types import ModuleType
from typing import Any, cast

from laticauda.compiling import PROCESSOR, Target, compiling_for, formulas, globals_of, ready
from laticauda.compiling.inner import is_inner
from laticauda.values.formulas import Formula

PACKAGE = Path(__file__).parent.parent
_loading: dict[str, Mapping[str, Any]] = {}
_loaded: dict[tuple[str, str, Target], ModuleType] = {}
_specialized: dict[tuple[str, str, Target], ModuleType] = {}
_inner: dict[tuple[Any, ...], tuple[Any, list[Any]]] = {}
_one_at_a_time = threading.Lock()


def closure(*modules: str, package: Path = PACKAGE) -> tuple[Path, ...]:
    """Return the package's files that make up modules: their own and those of all direct and indirect imports.

    Imports for type checkers only do not count, nor do the ``__init__`` files of a module's parent
    packages. A name that is imported from the ``__init__`` of a package counts as imported from the
    module that defines it.

    Args:
        modules: Full module names, such as ``laticauda.models.planar.stepping``; may be kernel templates.
        package: Folder of the package.
    """
    found: set[Path] = set()
    left = [_file(package, name.split(".")[1:]) for name in modules]
    while left:
        path = left.pop()
        if path is not None and path not in found:
            found.add(path)
            left += [_file(package, way) for way in _ways(package, path.read_bytes())]
    return tuple(sorted(found))


def digest_of(*modules: str, package: Path = PACKAGE) -> str:
    """Return the digest of the text of the `closure` of modules, 16 hexadecimal digits.

    Args:
        modules: Full module names.
        package: Folder of the package.
    """
    digest = hashlib.sha256()
    for path in closure(*modules, package=package):
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


sources_digest = functools.cache(digest_of)
"""`digest_of`, computed once per process."""


def named_after(digest: str, function: Callable[..., Any]) -> Callable[..., Any]:
    """Add a digest to the name under which Numba stores a function's machine code; Numba looks at nothing else.

    Args:
        digest: Digest of everything that the function is made of.
        function: Function to compile.
    """
    function.__qualname__ += f"_{digest}"
    return function


def is_kept(compiled: Any) -> bool:
    """Return whether the machine code of a cached function is in memory or on disk; if not, its first call compiles.

    Args:
        compiled: Function as returned by Numba's decorator.
    """
    kept = Path(compiled.stats.cache_path).glob(f"*{compiled.py_func.__qualname__}-*.nbi")
    return bool(compiled.signatures) or any(kept) or ready.is_ready(compiled.py_func)


def _file(package: Path, way: list[str]) -> Path | None:
    """Return the file of a module in the package; None if there is none of that name."""
    inside = package.joinpath(*way)
    choices = (inside.with_suffix(".py"), inside / "__init__.py") if way else ()
    return next((path for path in choices if path.is_file()), None)


@functools.cache
def _ways(package: Path, text: bytes) -> list[list[str]]:
    return list(_imported(package, ast.parse(text)))


def _imported(package: Path, tree: ast.AST) -> Iterator[list[str]]:
    """Yield the modules of the package that a syntax tree imports, without the package's name."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.If) and ast.unparse(node.test).endswith("TYPE_CHECKING"):
            continue
        yield from _imported(package, node)
        if isinstance(node, ast.Import):
            ways = [alias.name.split(".") for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.module:
            way = node.module.split(".")
            ways = [_home(package, way, alias.name) for alias in node.names]
        else:
            continue
        yield from (way[1:] for way in ways if way[0] == package.name)


def _home(package: Path, way: list[str], name: str) -> list[str]:
    """Return the module from which a name comes: it may be a module itself, or be handed on by a package."""
    if _file(package, [*way[1:], name]):
        return [*way, name]
    face = package.joinpath(*way[1:], "__init__.py")
    if way[0] == package.name and face.is_file():
        return _handed_on(face.read_bytes()).get(name, way)
    return way


@functools.cache
def _handed_on(face: bytes) -> dict[str, list[str]]:
    """Return the modules of the names that a package imports when they are first used, see `values.packaging`."""
    homes: dict[str, list[str]] = {}
    for node in ast.parse(face).body:
        if isinstance(node, ast.If) and ast.unparse(node.test).endswith("TYPE_CHECKING"):
            for one in node.body:
                if isinstance(one, ast.ImportFrom) and one.module:
                    homes |= {alias.name: one.module.split(".") for alias in one.names}
    return homes


def specialized(
    package: str,
    made_for: Mapping[str, Sequence[str]],
    names: Mapping[str, Any],
    target: Target | None = None,
) -> ModuleType:
    """Return the last of a package's templates, compiled on first call.

    Args:
        package: Name of the package, such as ``laticauda.models.planar``.
        made_for: Names that each template is specialized for; it may use earlier templates with no
            further names.
        names: Values of the names: a number, a law's formula, or None.
        target: What to compile for; None: this machine's processor.
    """
    target, digests = target or PROCESSOR, {name: _made_of(one) for name, one in names.items()}
    if (known := _specialized.get((package, str(digests), target))) is not None:
        return known
    folder, found = PACKAGE.joinpath(*package.split(".")[1:]), dict[str, Any](names)
    template = ""
    with _one_at_a_time, compiling_for(target):
        sources = sources_digest(*(f"{package}.{template}" for template in made_for))
        other = "" if target is PROCESSOR else id(target)
        for template, own in made_for.items():
            made_of = f"{package} {[digests[name] for name in own]} {sources} {other}"
            key = hashlib.sha256(made_of.encode()).hexdigest()[:16]
            if (template, key, target) not in _loaded:
                module = load(folder / f"{template}.py", key, found)
                for name in target.instead.keys() & vars(module).keys():
                    setattr(module, name, target.instead[name])
                vars(module).update({name: _first_of(one) for name, one in vars(module).items()})
                _loaded[template, key, target] = module
            found[template] = _loaded[template, key, target]
    return _specialized.setdefault((package, str(digests), target), found[template])


def _made_of(one: object) -> object:
    """Return what represents a name's value in a digest."""
    if isinstance(one, tuple):
        return [_made_of(part) for part in cast("tuple[object, ...]", one)]
    return formulas.digest_of(one) if isinstance(one, Formula) else one


def _first_of(one: Any) -> Any:
    """Return the first inner function identical to this one, that is, not affected by how specializations differ.

    A kernel for another flow therefore compiles only what calls the flow, and reuses the rest.
    """
    return _first_inner(one) if is_inner(one) else one


@functools.cache
def _first_inner(inner: Any) -> Any:
    function, refers = inner.py_func, [*(inner.py_func.__defaults__ or ())]
    for cell in function.__closure__ or ():
        cell.cell_contents = _first_of(cell.cell_contents)
        refers.append(cell.cell_contents)
    for name in filter(function.__globals__.__contains__, globals_of(function.__code__)):
        found = function.__globals__[name] = _first_of(function.__globals__[name])
        is_template = (
            isinstance(found, ModuleType) and found in _loaded.values()
        )  # only the names it uses count
        refers += [
            name,
            *(getattr(found, way, None) for way in function.__code__.co_names if is_template),
        ]
        refers += [] if is_template else [found]
    key = function.__code__, *inner.targetoptions, *map(_identity, refers)
    return _inner.setdefault(key, (inner, refers))[
        0
    ]  # keeps its references alive, and with them the identities


def _identity(one: Any) -> object:
    return repr(one) if type(one) in (bool, int, float, str, tuple) else id(one)


def load(file: Path, key: str, names: Mapping[str, Any]) -> ModuleType:
    """Load a template as a separate module; one thread at a time.

    Args:
        file: File of the template.
        key: Digest of everything that it is made of, including `names`; the end of the module's
            name.
        names: Specialization of the template: its `bindings`.
    """
    name = f"laticauda_{file.stem}_{key}"
    spec = importlib.util.spec_from_file_location(name, file)
    if spec is None or spec.loader is None:  # pragma: no cover - the file is part of the package
        raise ImportError(f"cannot load the kernel template {file.stem}")
    module = importlib.util.module_from_spec(spec)
    _loading[name] = names
    sys.modules[name] = module
    spec.loader.exec_module(module)
    # Machine code on disk names the modules of its functions, which must exist when it is loaded;
    # in another process these may belong to another specialization.
    module.__name__ = __name__
    del _loading[name]
    return module


def bindings(module_name: str) -> Mapping[str, Any]:
    """Return the specialization of the template that is being loaded under this name."""
    return _loading[module_name]
