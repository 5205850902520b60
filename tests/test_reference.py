"""The reference of the API has every package, and every field that is declared has its text there."""

import importlib
import re
import sys
import warnings
from dataclasses import replace
from pathlib import Path
from typing import Any

import griffe
import pytest

import laticauda as lc

ROOT = Path(__file__).parent.parent
NOT_THERE = ("cli",)
"""Read by people as commands: `laticauda --help`."""
AGAIN = "run `python docs/make_reference.py`"
SCREEN = 768
"""Height of a laptop's window [px]."""


@pytest.fixture(scope="module")
def reference() -> Any:
    sys.path.insert(0, str(ROOT / "docs"))
    try:
        yield importlib.import_module("make_reference")
    finally:
        sys.path.remove(str(ROOT / "docs"))


def packages() -> set[str]:
    found = {path.parent.name for path in (ROOT / "src/laticauda").glob("*/__init__.py")}
    return found - set(NOT_THERE)


def test_every_page_stands_in_the_contents(reference: Any):
    assert reference.ROOMS.keys() == packages()
    pages = {path.name for path in (ROOT / "docs/api").glob("*.md")}
    listed = re.findall(r"api/([\w-]+\.md)", (ROOT / "mkdocs.yml").read_text(encoding="utf-8"))
    assert sorted(listed) == sorted(pages), AGAIN


def test_every_public_name_is_on_one_page_of_at_most_ten_screens(reference: Any):
    sources = reference.read_sources()
    texts = [path.read_text(encoding="utf-8") for path in (ROOT / "docs/api").glob("*.md")]
    shown = sorted(re.findall(r"(?m)^::: (.+)$", "\n".join(texts)))
    offered = [entry for room in reference.ROOMS for entry in reference.list_entries(room, sources)]
    assert shown == sorted(entry.path for entry in offered), AGAIN
    height_of = {entry.path: entry.height for entry in offered}
    for text in texts:
        paths = re.findall(r"(?m)^::: (.+)$", text)
        assert sum(height_of[path] for path in paths) <= 10 * SCREEN, AGAIN
        # A search finds guides: of the reference only the two pages that list names.
        assert ("exclude: true" in text) == bool(paths) or "offers no names" in text


def test_every_name_of_lc_stands_on_the_first_page_with_its_call_and_an_example(
    reference: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    examples = reference.read_examples()
    names = [name for group in examples.values() for name in group]
    assert sorted(names) == sorted(lc.__all__)
    page = (ROOT / "docs/api/laticauda.md").read_text(encoding="utf-8")
    assert page == reference.write_names(), AGAIN
    monkeypatch.chdir(tmp_path)
    namespace: dict[str, Any] = {"lc": lc, "replace": replace, "warnings": warnings}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", lc.InfeasibleWarning)
        for group in examples.values():
            for example in group.values():
                exec(example, namespace)


def test_a_declared_field_shows_its_text_unit_and_range():
    found = griffe.load(
        "laticauda.robot.environment",
        search_paths=[ROOT / "src"],
        extensions=griffe.load_extensions(ROOT / "docs/declared_fields.py"),
    )
    water = found["Water"]
    assert water["density"].docstring.value == "rho [kg/m^3, > 0.0]."
    assert water["name"].docstring.value.endswith(".")
    assert str(water["density"].value) == "1000.0"


def test_a_series_and_a_figure_show_what_is_declared_of_them():
    extensions = griffe.load_extensions(ROOT / "docs/declared_fields.py")
    log = griffe.load(
        "laticauda.values.series", search_paths=[ROOT / "src"], extensions=extensions
    )["Log"]
    assert log["joint_rate"].docstring.value == "Rate of the joint angle [rad s-1]."
    assert (str(log["joint_rate"].annotation), str(log["electrical_work"].value)) == (
        "Joints",
        "None",
    )
    trial = griffe.load(
        "laticauda.trials.trial", search_paths=[ROOT / "src"], extensions=extensions
    )["Trial"]
    assert (
        trial["mechanical_power"].docstring.value == "Mechanical power, mean of sum |u phi'| [W]."
    )
    assert trial["forward_velocity"].docstring.value.startswith(
        "Straight-line displacement over ground"
    )


@pytest.mark.parametrize("page", ["architecture", "extending", "decisions", "release"])
def test_those_who_carry_it_on_find_their_pages(page):
    assert (ROOT / "docs/developing" / f"{page}.md").stat().st_size > 1000
    assert f"developing/{page}.md" in (ROOT / "mkdocs.yml").read_text(encoding="utf-8")
