"""Modules that are loaded once per specialization: kernels for a number of lanes, for a law.

Templates are the modules of a package that kernels are made of. Each reads what it is made for, and the templates
before it, from its `bindings` while it is loaded, and is loaded once per combination of what it is made for: another
drag law takes the drives as they are. A specialization's name carries a digest of all sources it is made of and of the
laws' own code, so compiled code on disk is found again by the next process and is never stale: an edited law, or an
edited kernel, has another name and compiles anew. The numbers of a law are rows, and not part of it.
"""

import hashlib
import importlib.util
import sys
import threading
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import ModuleType
from typing import Any

from laticauda.compiling import PROCESSOR, Target, compiling_for
from laticauda.compiling.formulas import digest_of
from laticauda.compiling.sources import PACKAGE, sources_digest
from laticauda.formulas import Formula

_loading: dict[str, Mapping[str, Any]] = {}
_loaded: dict[tuple[str, str, Target], ModuleType] = {}
_one_at_a_time = threading.Lock()


def specialized(
    package: str, made_for: Mapping[str, Sequence[str]], names: Mapping[str, Any], target: Target | None = None
) -> ModuleType:
    """The last of a package's templates, compiled on first call.

    Args:
        package: Its name, as ``laticauda.planar``.
        made_for: Names that each template is made for; it may use those before it that are made for no more.
        names: What they are: a number, a law's formula, or None.
        target: What to compile for; None for this machine's processor.
    """
    folder, target = PACKAGE.joinpath(*package.split(".")[1:]), target or PROCESSOR
    digests = {name: digest_of(one) if isinstance(one, Formula) else one for name, one in names.items()}
    found: dict[str, Any] = dict(names)
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
                _loaded[template, key, target] = module
            found[template] = _loaded[template, key, target]
    return found[template]


def load(file: Path, key: str, names: Mapping[str, Any]) -> ModuleType:
    """Load a template as a module of its own; one thread at a time.

    Args:
        file: Of the template.
        key: Digest of all that it is made of, `names` included; the end of the module's name.
        names: What it is specialized for: its `bindings`.
    """
    name = f"laticauda_{file.stem}_{key}"
    spec = importlib.util.spec_from_file_location(name, file)
    if spec is None or spec.loader is None:  # pragma: no cover - the file is part of the package
        raise ImportError(f"cannot load the kernel template {file.stem}")
    module = importlib.util.module_from_spec(spec)
    _loading[name] = names
    sys.modules[name] = module
    spec.loader.exec_module(module)
    del _loading[name]
    return module


def bindings(module_name: str) -> Mapping[str, Any]:
    """What the template that is being loaded under this name is specialized for."""
    return _loading[module_name]
