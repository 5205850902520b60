"""The reference of the API has every package, and every field that is declared has its text there."""

import re
from pathlib import Path

import griffe
import pytest

ROOT = Path(__file__).parent.parent
NOT_THERE = ("cli",)
"""Read by people as commands: `laticauda --help`."""


def packages() -> set[str]:
    found = {path.parent.name for path in (ROOT / "src/laticauda").glob("*/__init__.py")} - set(
        NOT_THERE
    )
    return found


def test_every_package_has_its_page_and_stands_in_the_contents():
    pages = {path.stem for path in (ROOT / "docs/api").glob("*.md")} - {"index"}
    listed = set(
        re.findall(r"api/(\w+)\.md", (ROOT / "mkdocs.yml").read_text(encoding="utf-8"))
    ) - {"index"}
    assert pages == listed == packages()


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
    assert trial["forward_velocity"].docstring.value.endswith("over the whole run (5) [m/s].")


@pytest.mark.parametrize("page", ["architecture", "extending", "decisions", "release"])
def test_those_who_carry_it_on_find_their_pages(page):
    assert (ROOT / "docs/developing" / f"{page}.md").stat().st_size > 1000
    assert f"developing/{page}.md" in (ROOT / "mkdocs.yml").read_text(encoding="utf-8")
