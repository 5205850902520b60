"""Modules that are loaded once per specialization: kernels for a number of lanes, for a law."""

import importlib.util
import sys
from collections.abc import Mapping
from pathlib import Path
from types import ModuleType
from typing import Any

_loading: dict[str, Mapping[str, Any]] = {}


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
