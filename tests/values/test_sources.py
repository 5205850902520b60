"""Records of the files that code is made of: they fit until one of the files is edited."""

import ast
from collections.abc import Callable
from pathlib import Path

import pytest

from laticauda.values import sources
from laticauda.values.sources import SourceRecord, digest_of, sources_digest


@pytest.fixture
def package(tmp_path: Path) -> Path:
    """A package in which one module takes a name from another room, whose face says where it is from."""
    package = tmp_path / "house"
    (package / "room").mkdir(parents=True)
    (package / "__init__.py").write_text("")
    (package / "a.py").write_text("from house.room import X\n")
    (package / "room" / "__init__.py").write_text(
        "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from house.room.b import X as X\n"
    )
    (package / "room" / "b.py").write_text("X = 1\n")
    (package / "room" / "c.py").write_text("X = 2\n")
    return package


def _in(folder: Path) -> Callable[[str], str]:
    """Return a stand-in for `cache_from_source`, which keeps everything in one folder."""

    def cache_from_source(path: str) -> str:
        return str(folder / "made.pyc")

    return cache_from_source


@pytest.mark.parametrize("name", ["a.py", "room/b.py", "room/__init__.py"])
def test_a_record_fits_until_a_file_that_it_is_made_of_or_that_leads_to_one_is_edited(
    package: Path, name: str
):
    record = SourceRecord.of("house.a", package=package)
    assert record.digest == digest_of("house.a", package=package)
    assert SourceRecord.read(record.write()) == record
    assert record.is_current(package)
    text = (package / name).read_text()
    (package / name).write_text(text + "# an edit\n")
    assert not record.is_current(package)
    (package / name).write_text(text)
    assert record.is_current(package)
    (package / name).unlink()
    assert not record.is_current(package)


def test_an_edit_elsewhere_leaves_a_record_valid(package: Path):
    record = SourceRecord.of("house.a", package=package)
    (package / "room" / "c.py").write_text("X = 3\n")
    assert record.is_current(package)


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"sources": []}', "\0"])
def test_what_is_no_record_is_none(text: str):
    assert SourceRecord.read(text) is None


def test_sources_are_parsed_once_and_then_only_after_an_edit(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    module = "laticauda.values.sources"
    monkeypatch.setattr(sources, "cache_from_source", _in(tmp_path))
    sources_digest.cache_clear()
    digest = sources_digest(module)
    assert digest == digest_of(module)
    sources_digest.cache_clear()
    monkeypatch.setattr(ast, "parse", None)  # to parse would fail
    assert sources_digest(module) == digest
    sources_digest.cache_clear()


def test_without_a_place_for_records_sources_are_parsed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(sources, "cache_from_source", _in(tmp_path / "gone"))
    sources_digest.cache_clear()
    assert sources_digest("laticauda.values.sources") == digest_of("laticauda.values.sources")
    sources_digest.cache_clear()
