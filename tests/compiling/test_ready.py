"""Machine code that comes with an installation: taken where all agrees, else Numba compiles."""

import numpy as np
import pytest
from numba import config

from laticauda import compiling
from laticauda.compiling import ready
from laticauda.compiling.templates import is_kept


def _thrice(x):
    return 3.0 * x


def function(digest):
    """One whose name ends in a digest, as those of kernels do."""
    _thrice.__module__ = f"laticauda_thrice_{digest}"
    _thrice.__qualname__ = "thrice"
    return _thrice


@pytest.fixture
def installed(tmp_path, monkeypatch):
    """An installation with the code of one function for floats, and an empty cache."""
    for name in ("ready", "made", "cache"):
        (tmp_path / name).mkdir()
    monkeypatch.setattr(config, "CACHE_DIR", str(tmp_path / "made"))
    made = compiling.entry(function("a"))
    assert made(2.0) == 6.0
    ready.keep(made, tmp_path / "ready")
    monkeypatch.setattr(ready, "FOLDER", tmp_path / "ready")
    monkeypatch.setattr(config, "CACHE_DIR", str(tmp_path / "cache"))
    return tmp_path


def compiled_anew(folder):
    """Whether anything was compiled, and so kept."""
    return any((folder / "cache").rglob("*.nbc"))


def test_code_that_came_with_the_installation_is_run_and_nothing_is_compiled(installed):
    found = compiling.entry(function("a"))
    assert is_kept(found)
    assert found(2.5) == 7.5
    assert not compiled_anew(installed)
    assert list(found.stats.cache_hits.values()) == [1]


def test_code_of_other_sources_is_not_taken(installed):
    found = compiling.entry(function("b"))
    assert not is_kept(found)
    assert found(2.5) == 7.5
    assert compiled_anew(installed)


def test_code_for_other_arguments_is_not_taken(installed):
    found = compiling.entry(function("a"))
    np.testing.assert_array_equal(found(np.ones(2)), [3.0, 3.0])
    assert compiled_anew(installed)


@pytest.mark.parametrize("lacks", ["features", "family"])
def test_a_processor_of_another_family_compiles(installed, monkeypatch, lacks):
    if lacks == "features":
        monkeypatch.setattr(ready.binding, "get_host_cpu_features", lambda: {"avx": True})
    else:
        monkeypatch.setattr(ready.platform, "machine", lambda: "aarch64")
    ready.is_of_family.cache_clear()
    found = compiling.entry(function("a"))
    assert not is_kept(found)
    assert found(2.5) == 7.5
    assert compiled_anew(installed)
    ready.is_of_family.cache_clear()
