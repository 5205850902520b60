"""README and the first page of the docs say the same: what it is, what it does, and what is beside it."""

import re
import tomllib
from pathlib import Path

from laticauda.cli.app import DESCRIPTION

ROOT = Path(__file__).parent.parent
WHAT_IT_IS = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"][
    "description"
]
PLACES = (
    "README.md",
    "docs/index.md",
    "CITATION.cff",
    "mkdocs.yml",
    "recipe/recipe.yaml",
    "src/laticauda/__init__.py",
)
HAS_A_SOURCE = re.compile(
    r"\]\(|`benchmarks/|^not found$|^same script$|\(same script[,)]|^as in MuJoCo$|^part of the flow$|^has none$"
)


def words(path: str) -> str:
    return " ".join((ROOT / path).read_text(encoding="utf-8").split())


def test_what_it_is_is_said_in_the_same_words_everywhere():
    assert WHAT_IT_IS.endswith(".") and WHAT_IT_IS.count(".") == 1
    assert DESCRIPTION.startswith(WHAT_IT_IS)
    assert [place for place in PLACES if WHAT_IT_IS not in words(place)] == []


def test_readme_and_the_first_page_are_one():
    first_page = words("docs/index.md").partition("# laticauda")[2]
    readme = words("README.md").partition("# laticauda")[2].partition("## From the shell")[0]
    # They differ only in where their links begin, and in where the exported page is.
    page = re.compile(r"(<a href=\"swim/index.html\">)?\*\*\[?It swims in your browser[^,]*,")
    assert page.sub("", readme).replace("](docs/", "](").strip() == page.sub("", first_page).strip()


def test_every_cell_about_others_has_its_source():
    rows = re.findall(r"(?m)^\| (.+) \|$", (ROOT / "README.md").read_text(encoding="utf-8"))
    compared = [row.split(" | ") for row in rows if row.count(" | ") == 5]
    assert len(compared) == 6
    bare = [cell for row in compared for cell in row[1:] if not HAS_A_SOURCE.search(cell)]
    assert bare == []


def test_the_last_release_is_named():
    changelog = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    release = re.findall(r"(?m)^## (\d+\.\d+\.\d+) - ", changelog)[0]
    assert f"The last release is {release}," in words("README.md")
    assert f"Version {release}, the last release" in words("README.md")
    assert f"(the last is {release};" in words("CITATION.cff")
