"""Public interface of a package: its version, and names that are imported when they are first used."""

import dis
import inspect
from collections.abc import Callable
from importlib import import_module
from typing import TYPE_CHECKING, Any

from laticauda.arguments import explained

if TYPE_CHECKING:
    __version__: str  # read when it is first used

_Exports = tuple[Callable[[str], Any], Callable[[], list[str]], list[str]]


def lazy_exports(*own: str) -> _Exports:
    """Return `__getattr__`, `__dir__` and `__all__` of the calling package, whose names are imported when first used.

    The names are those that its `__init__` imports for type checkers only, so that they are listed
    once:

        if TYPE_CHECKING:
            from laticauda.identify.fitting import fit as fit

        __getattr__, __dir__, __all__ = lazy_exports()

    A function in a module of the same name is imported outside that block, at once: otherwise the
    module would replace it. A call that fails because of an argument of the wrong type names that
    argument, see `laticauda.arguments`. The import statements are read from the compiled
    `__init__`, which also exists in zip files and frozen programs.

    Args:
        *own: Further public names, which the `__init__` defines itself.
    """
    frame = inspect.currentframe()
    assert frame is not None and frame.f_back is not None  # always so in CPython
    caller = frame.f_back
    homes: dict[str, str] = {}
    home = ""
    for instruction in dis.get_instructions(caller.f_code):
        if instruction.opname == "IMPORT_NAME":
            home = instruction.argval
        elif instruction.opname == "IMPORT_FROM":
            homes[instruction.argval] = home
    package, there = caller.f_globals["__name__"], set(caller.f_globals)
    imported = {
        name for name, home in homes.items() if name not in there or home.startswith(f"{package}.")
    }
    for name in imported & there:
        caller.f_globals[name] = explained(caller.f_globals[name], package)
    names = sorted(imported.union(own) - {lazy_exports.__name__})

    def get(name: str) -> Any:
        if name not in homes or name in there:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        return explained(getattr(import_module(homes[name]), name), package)

    return get, lambda: names, names


def __getattr__(name: str) -> str:
    if name != "__version__":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib.metadata import version

    return globals().setdefault(name, version("laticauda"))
