"""Templates of compiled code, loaded once per specialization.

Templates are the modules of a package that kernels are made of. While it is loaded, each reads its
specialization and the preceding templates from its `bindings`. It is loaded once per combination of
the names that it depends on: another drag law reuses the drives. A specialization's name includes a
digest of all its sources and of the laws' own code, so the next process finds the compiled code on
disk again and the code is never stale: an edited law or kernel has another name and is recompiled.
The numbers of a law are rows, and not part of the digest.
"""

import functools
import hashlib
import importlib.util
import sys
import threading
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import ModuleType
from typing import Any, cast

from laticauda.compiling import PROCESSOR, Target, compiling_for, formulas, globals_of
from laticauda.compiling.inner import is_inner
from laticauda.values import Formula
from laticauda.values.sources import PACKAGE, sources_digest

_loading: dict[str, Mapping[str, Any]] = {}
"""Specializations of the templates that are being loaded, by the names of their modules."""
_loaded: dict[tuple[str, str, Target], ModuleType] = {}
"""Loaded templates, by name, digest and target."""
_specialized: dict[tuple[str, str, Target], ModuleType] = {}
"""Last templates of packages, by package, digests and target."""
_inner_functions: dict[tuple[Any, ...], tuple[Any, list[Any]]] = {}
"""Inner functions with what they refer to, by what makes two of them identical."""
_one_at_a_time = threading.Lock()


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
    if compiled.signatures:
        return True
    cached = Path(compiled.stats.cache_path).glob(f"*{compiled.py_func.__qualname__}-*.nbi")
    return any(cached)


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
    target = target or PROCESSOR
    digests = {name: _digest_part(value) for name, value in names.items()}
    key_of_package = (package, str(digests), target)
    if key_of_package in _specialized:
        return _specialized[key_of_package]
    folder = PACKAGE.joinpath(*package.split(".")[1:])
    template_bindings: dict[str, Any] = dict(names)
    with _one_at_a_time, compiling_for(target):
        sources = sources_digest(*(f"{package}.{template}" for template in made_for))
        target_part = ""
        if target is not PROCESSOR:
            target_part = str(id(target))
        for template, template_names in made_for.items():
            values = [digests[name] for name in template_names]
            text = f"{package} {values} {sources} {target_part}"
            key = hashlib.sha256(text.encode()).hexdigest()[:16]
            if (template, key, target) not in _loaded:
                module = load(folder / f"{template}.py", key, template_bindings)
                _finish(module, target)
                _loaded[template, key, target] = module
            template_bindings[template] = _loaded[template, key, target]
        last_template = template_bindings[list(made_for)[-1]]
    return _specialized.setdefault(key_of_package, last_template)


def _finish(module: ModuleType, target: Target) -> None:
    """Put the target's replacements into a loaded template, and the first of identical inner functions."""
    for name in target.replacements.keys() & vars(module).keys():
        setattr(module, name, target.replacements[name])
    for name, value in list(vars(module).items()):
        setattr(module, name, _first_of(value))


def _digest_part(value: object) -> object:
    """Return what represents a name's value in a digest."""
    if isinstance(value, tuple):
        return [_digest_part(part) for part in cast("tuple[object, ...]", value)]
    if isinstance(value, Formula):
        return formulas.digest_of(value)
    return value


def _first_of(value: Any) -> Any:
    """Return the first inner function identical to this one, that is, not affected by how specializations differ.

    A kernel for another flow therefore compiles only what calls the flow, and reuses the rest.
    """
    if is_inner(value):
        return _first_inner(value)
    return value


@functools.cache
def _first_inner(inner: Any) -> Any:
    function = inner.py_func
    code = function.__code__
    references: list[Any] = [*(function.__defaults__ or ())]
    for cell in function.__closure__ or ():
        cell.cell_contents = _first_of(cell.cell_contents)
        references.append(cell.cell_contents)
    for name in globals_of(code):
        if name not in function.__globals__:
            continue
        value = _first_of(function.__globals__[name])
        function.__globals__[name] = value
        references.append(name)
        if isinstance(value, ModuleType) and value in _loaded.values():
            # Of a template, only the names that the function uses count.
            references += [getattr(value, attribute, None) for attribute in code.co_names]
        else:
            references.append(value)
    key = (code, *inner.targetoptions, *map(_identity, references))
    # The table keeps the references alive, and with them their identities.
    first, _ = _inner_functions.setdefault(key, (inner, references))
    return first


def _identity(value: Any) -> object:
    if type(value) in (bool, int, float, str, tuple):
        return repr(value)
    return id(value)


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
