"""Numba is imported here for the first time, so that its doubts about the environment are one line each.

Of a variable that it cannot read, such as NUMBA_NUM_THREADS=x, Numba says so with a whole traceback,
and goes on as if the variable were not set.
"""

import warnings

with warnings.catch_warnings(record=True) as _warnings_of_numba:
    warnings.simplefilter("always")
    import numba as numba

from laticauda.values import ImplausibleWarning, warn_caller


def say_unread_variables() -> None:
    """Warn of each variable that Numba could not read, in one line."""
    for warning in _warnings_of_numba:
        first_line, _, _ = str(warning.message).partition("\n")
        warn_caller(f"{first_line} Numba goes on without it.", ImplausibleWarning)
    _warnings_of_numba.clear()
