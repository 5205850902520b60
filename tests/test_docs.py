"""The code of the README and of the docs runs, and their links lead somewhere.

Every page is followed from top to bottom, as a reader would, in an empty folder:

- a block whose fence names a file (``title="eel.toml"``) is written to that file;
- ``python`` blocks run in one namespace;
- a ``text`` block that is titled "it prints" is what the block before it printed, numbers to 1 %: a
  line `...` stands for any lines, and one that ends so is the beginning of a line;
- of ``bash`` blocks, lines that start with ``laticauda`` run, and of ``make`` lines the target must
  exist. Those of the README run in a shell, by the installed command; the others in this process,
  which has loaded all they need.

A block after the comment ``<!-- not run: reason -->`` is skipped. Blocks that include an example
are run elsewhere.
"""

import json
import math
import os
import re
import runpy
import shlex
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import matplotlib.pyplot as plt
import pytest
from markdown import Markdown
from rendering import skip_without_rendering

from laticauda.cli import main
from laticauda.values.extensions import Extensible

ROOT = Path(__file__).parent.parent
MADE = {"gallery": "examples/*.py", "notebooks": "docs/notebooks/*.ipynb"}
"""Folders of pages that are made when the docs are built, and what of."""
NOTEBOOKS = sorted((ROOT / "docs" / "notebooks").glob("*.ipynb"))
PAGES = [
    ROOT / "README.md",
    ROOT / "CONTRIBUTING.md",
    *(page for page in sorted((ROOT / "docs").rglob("*.md")) if page.parent.name not in MADE),
]
FENCE = re.compile(
    r"(?P<skip><!-- not run: [^\n]+ -->\n+)?^```(?P<language>\w+)(?P<options>[^\n]*)\n(?P<code>.*?)^```$",
    re.MULTILINE | re.DOTALL,
)
MATHEMATICS = "[\u0391-\u03c9\u2202\u2207\u221a\u2080-\u2099] *[\u0391-\u03c9=(a-z]"
NUMBER = re.compile(r"\d+(?:\.\d+)?(?:e[+-]?\d+)?")
LINK = re.compile(r"\]\((?!https?://|#|mailto:)([^)#\s]+)")


class Block(NamedTuple):
    language: str
    title: str
    code: str
    line: int


def blocks(page: Path) -> list[Block]:
    text = page.read_text(encoding="utf-8")
    return [
        Block(
            language=match["language"],
            title=(re.search(r'title="([^"]+)"', match["options"]) or ["", ""])[1],
            code=match["code"],
            line=text.count("\n", 0, match.start("code")),
        )
        for match in FENCE.finditer(text)
        if not match["skip"] and not match["code"].startswith("--8<--")
    ]


def shell_lines(code: str) -> list[str]:
    return [line.strip() for line in code.replace("\\\n", " ").splitlines()]


def run_in_shell(line: str) -> None:
    # The command of this environment comes first, whatever else is installed.
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    done = subprocess.run(
        ["bash", "-c", line],
        env={**os.environ, "PATH": path},
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, f"{line}\n{done.stdout}\n{done.stderr}"


def run_here(line: str) -> None:
    assert main(shlex.split(line)[1:]) == 0, line


def same_words(expected: str, line: str) -> bool:
    """Whether they say the same, numbers to 1 %."""
    words, found = expected.split(), line.split()
    if words and words[-1] == "...":
        words = words[:-1]
        found = found[: len(words)]
    return len(words) == len(found) and all(map(same_word, words, found))


def same_word(expected: str, found: str) -> bool:
    if NUMBER.sub("#", expected) != NUMBER.sub("#", found):
        return False
    pairs = zip(NUMBER.findall(expected), NUMBER.findall(found), strict=True)
    return all(math.isclose(float(one), float(other), rel_tol=0.01) for one, other in pairs)


def check_printed(expected: str, printed: str) -> None:
    """Find every line, in order, and one right after the other but for where `...` stands."""
    lines, place, jump = [line for line in printed.splitlines() if line.strip()], 0, False
    for line in filter(str.strip, expected.splitlines()):
        if line.strip() == "...":
            jump = True
            continue
        while jump and place < len(lines) and not same_words(line, lines[place]):
            place += 1
        assert place < len(lines), f"not printed: {line}\n{printed}"
        assert same_words(line, lines[place]), f"printed: {lines[place]}"
        place, jump = place + 1, False


def follow(page: Path, capture: Callable[[], str] = str) -> None:
    namespace: dict[str, object] = {"__name__": "__main__"}
    for block in blocks(page):
        if block.title == "it prints":
            check_printed(block.code, capture())
            continue
        capture()
        if block.title:
            Path(block.title).write_text(block.code, encoding="utf-8")
        elif block.language == "python":
            # Empty lines in front: a traceback shows the line of the page.
            exec(compile("\n" * block.line + block.code, str(page), "exec"), namespace)
        elif block.language == "bash":
            for line in shell_lines(block.code):
                if line.startswith("laticauda "):
                    (run_in_shell if page.name == "README.md" else run_here)(line)
                elif line.startswith("make "):
                    run_in_shell(
                        f"make -C {ROOT} --dry-run {line.removeprefix('make ')} > {os.devnull}"
                    )


@pytest.fixture(autouse=True)
def laws_of_pages_are_forgotten():
    """What a page defines is known to the page alone: messages of other tests list all that there is.

    What the package's own modules define stays, for they are imported only once.
    """
    before = {base: set(base._members) for base in Extensible.__subclasses__()}
    yield
    for base, names in before.items():
        for name in base._members.keys() - names:
            if not base._members[name].__module__.startswith("laticauda"):
                del base._members[name]


def renders(page: Path) -> bool:
    return any("--video" in block.code or "pictures.render" in block.code for block in blocks(page))


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_the_code_of_the_page_runs_from_top_to_bottom(
    page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    if renders(page):
        skip_without_rendering()
    monkeypatch.chdir(tmp_path)
    follow(page, lambda: capsys.readouterr().out)


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda notebook: notebook.stem)
def test_the_notebook_runs_and_keeps_no_results(
    notebook: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.chdir(tmp_path)
    namespace: dict[str, object] = {"__name__": "__main__"}
    for cell in json.loads(notebook.read_text(encoding="utf-8"))["cells"]:
        if cell["cell_type"] == "code":
            assert not cell["outputs"]
            exec("".join(line for line in cell["source"] if not line.startswith("%")), namespace)
    plt.close("all")


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_every_link_of_the_page_leads_to_a_file(page: Path):
    links = LINK.findall(page.read_text(encoding="utf-8"))
    made = {
        ROOT / "docs" / folder / f"{name}.md"
        for folder, sources in MADE.items()
        for name in ("index", *(source.stem for source in ROOT.glob(sources)))
    }
    pictures = runpy.run_path(str(ROOT / "docs" / "images" / "make.py"))
    made |= {ROOT / "docs" / "images" / file for file in pictures["MADE_FILES"]}
    assert not [
        link
        for link in links
        if not (page.parent / link).exists() and (page.parent / link).resolve() not in made
    ]


def test_every_page_of_the_docs_can_be_reached():
    navigation = (ROOT / "mkdocs.yml").read_text(encoding="utf-8")
    pages = [str(page.relative_to(ROOT / "docs")) for page in (ROOT / "docs").rglob("*.md")]
    assert not [page for page in pages if f" {page}\n" not in navigation]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_every_formula_of_the_page_is_typeset(page: Path):
    text = page.read_text(encoding="utf-8")
    formulas = runpy.run_path(str(ROOT / "docs" / "mathematics.py"))["makeExtension"]()
    reader = Markdown(extensions=[formulas, "tables", "pymdownx.superfences"])
    shown = re.sub(r"<(math|pre|code).*?</\1>", "", reader.convert(text), flags=re.DOTALL)
    assert "$" not in shown
    assert not [
        block.code
        for block in blocks(page)
        if block.language == "text" and re.search(MATHEMATICS, block.code)
    ]


def test_what_a_page_says_is_printed_is_looked_for_line_by_line():
    printed = "one 1.00 m\ntwo [2]\n\nthree, and so on\nfour 4e-3\n"
    check_printed("one 1.001 m\n...\nthree, ...\nfour 4.01e-3\n", printed)
    for wrong in (
        "two [2]\n",
        "...\nfive\n",
        "one 1.02 m\n",
        "one 1.00 m\nthree, and so on\n",
        "one 1.00\n",
    ):
        with pytest.raises(AssertionError, match="printed"):
            check_printed(wrong, printed)


PAGE = """\
```python
x = 1
```

<!-- not run: it would fail -->
```python
x = 1 / 0
```

```toml title="a.toml"
b = 2
```

```python
from pathlib import Path

x += 1
assert Path("a.toml").read_text() == "b = 2\\n"
raise KeyError(x)
```
"""


def test_a_page_is_followed_as_a_reader_would(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    page = tmp_path / "page.md"
    page.write_text(PAGE, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    with pytest.raises(KeyError, match="2") as caught:
        follow(page)
    assert caught.traceback[-1].lineno + 1 == PAGE[: PAGE.index("raise")].count("\n") + 1
