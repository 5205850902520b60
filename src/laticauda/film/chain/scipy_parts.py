"""Parts of SciPy that the fit needs, imported when it begins: SciPy is part of the extra `film`."""

from functools import cache
from typing import Any

from laticauda.values import optional_import


@cache
def load_scipy(part: str) -> Any:
    """Return a module of SciPy.

    Args:
        part: Its name, such as `linalg`.

    Raises:
        MissingExtra: If SciPy is not installed.
    """
    return optional_import("Fitting a chain to a film", "scipy", "film", f"scipy.{part}")
