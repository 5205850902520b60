"""Public interface of a package: its version, names that are imported when they are first used, and old names.

A package states its public names in a table, by the module that defines them:

    if TYPE_CHECKING:  # written by tests/faces.py
        from laticauda.identify.fitting import fit as fit

    __getattr__, __dir__, __all__ = lazy_exports(
        __name__,
        {"laticauda.identify.fitting": ["fit"]},
    )

Whatever is renamed keeps its old name for one release, with a `DeprecationWarning`: names of a
package by `renamed`, those of a module by `renamed_names`, and modules by `moved_modules`.
"""

import sys
import warnings
from collections.abc import Callable, Mapping, Sequence
from importlib import import_module
from importlib.machinery import ModuleSpec
from types import MappingProxyType, ModuleType
from typing import TYPE_CHECKING, Any, cast

from laticauda.values.arguments import explained
from laticauda.values.misnamed import NOTHING_KNOWN, Meant, UnknownName, hint_at

if TYPE_CHECKING:
    __version__: str  # read when it is first used

_NOTHING: Mapping[str, str] = MappingProxyType({})
_NO_NAMES: Mapping[str, Sequence[str]] = MappingProxyType({})


def lazy_exports(
    package: str,
    homes: Mapping[str, Sequence[str]],
    *,
    own: Sequence[str] = (),
    plain: Mapping[str, Sequence[str]] = _NO_NAMES,
    renamed: Mapping[str, str] = _NOTHING,
    meant: Meant = NOTHING_KNOWN,
) -> tuple[Callable[[str], Any], Callable[[], list[str]], list[str]]:
    """Return `__getattr__`, `__dir__` and `__all__` of a package whose names are imported when first used.

    A call that fails because of an argument of the wrong type names that argument, see
    `laticauda.values.arguments`.

    Args:
        package: The package, `__name__`.
        homes: Public names, by the module that defines them.
        own: Further public names, which the `__init__` defines or imports itself, above this call.
            A function is imported there if a module of the package has its name: otherwise the
            module would take its place as soon as it is imported.
        plain: Names for the other rooms of laticauda, by the module that defines them: handed on as
            they are, also what kernels call, and not shown to users.
        renamed: New names, by old ones, as in `renamed_names`.
        meant: What is probably meant, by names that people try; a name that is merely mistyped
            needs no entry.
    """
    plain_home_of = {name: home for home, names in plain.items() for name in names}
    home_of = {name: home for home, names in homes.items() for name in names}
    public_names = sorted([*home_of, *own])
    namespace = vars(sys.modules[package])
    for name in own:
        namespace[name] = explained(namespace[name], package)

    def find_hint(name: str) -> str:
        if name.startswith("_"):
            return ""
        if name not in meant and _is_module(f"{package}.{name}"):
            return f": it is a module, `import {package}.{name}` first"
        return hint_at(name, meant, public_names)

    def get(name: str) -> Any:
        if name in plain_home_of:
            return getattr(import_module(plain_home_of[name]), name)
        if name in home_of:
            return explained(getattr(import_module(home_of[name]), name), package)
        if name in renamed:
            return _get_renamed(package, name, renamed)
        raise UnknownName(f"module {package!r}", name, lambda: find_hint(name))

    return get, lambda: public_names, public_names


def _is_module(name: str) -> bool:
    from importlib.util import find_spec  # rarely needed, and slow to import

    return find_spec(name) is not None


def renamed_names(module: str, renamed: Mapping[str, str]) -> Callable[[str], Any]:
    """Return `__getattr__` of a module in which names were renamed: the old ones still work, with a warning.

    Args:
        module: The module, `__name__`.
        renamed: New names, by old ones. A name that is now defined elsewhere is written as
            `laticauda.robot.files:load_robot`, and a module as `laticauda.robot.files:`.
    """

    def get(name: str) -> Any:
        return _get_renamed(module, name, renamed)

    return get


def _get_renamed(module: str, old_name: str, renamed: Mapping[str, str]) -> Any:
    """Return what had this name; called by `__getattr__` itself, so that the warning is about its caller."""
    if old_name not in renamed:
        raise AttributeError(f"module {module!r} has no attribute {old_name!r}")
    new_module, _, new_name = renamed[old_name].rpartition(":")
    new_module = new_module or module
    full_name = f"{new_module}.{new_name}".rstrip(".")
    warnings.warn(f"{module}.{old_name} is now {full_name}", DeprecationWarning, stacklevel=3)
    found = import_module(new_module)
    return getattr(found, new_name) if new_name else found


def moved_modules(moved: Mapping[str, str]) -> None:
    """Let modules and packages be imported by their old names, too, with a warning.

    An old name gives the module of today itself, not a second one, so that classes stay the same.

    Args:
        moved: New names of modules, by old ones. The modules in a moved package move with it,
            unless they are named themselves.
    """
    # First of all finders: the next would find the modules of a moved package in its new folder,
    # and load them a second time under their old names.
    sys.meta_path.insert(0, _MovedModules(moved))


class _MovedModules:
    """A finder and loader as `importlib.abc` describes them, which takes time to import."""

    def __init__(self, moved: Mapping[str, str]) -> None:
        self.moved = moved

    def find_spec(
        self, fullname: str, path: object = None, target: object = None
    ) -> ModuleSpec | None:
        if self._new_name(fullname) is None:
            return None
        return ModuleSpec(fullname, cast(Any, self))

    def create_module(self, spec: ModuleSpec) -> None:
        """Let Python make the module that `exec_module` replaces."""

    def exec_module(self, module: ModuleType) -> None:
        old_name = module.__name__
        new_name = self._new_name(old_name)
        assert new_name is not None  # `find_spec` accepted it
        # Level 2 is whoever imports, because Python does not count its own frames of an import.
        warnings.warn(f"{old_name} is now {new_name}", DeprecationWarning, stacklevel=2)
        # Python hands on what stands here after this call.
        sys.modules[old_name] = import_module(new_name)

    def _new_name(self, old_name: str) -> str | None:
        parent = old_name
        inner_path = ""
        while parent:
            if parent in self.moved:
                return self.moved[parent] + inner_path
            parent, dot, last = parent.rpartition(".")
            inner_path = f"{dot}{last}{inner_path}"
        return None


def __getattr__(name: str) -> str:
    if name != "__version__":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib.metadata import version

    return globals().setdefault(name, version("laticauda"))
