"""Write the pages of the Python reference: `python docs/make_reference.py`, after public names changed.

The first page, `api/laticauda.md`, has every name of `import laticauda as lc` with its call, one
line and the example from `api/examples.toml`. The others have what each package offers, in pages of
at most ten screens: a package that offers more has several, each of some of its modules. They are
committed; a test says if they are out of date.
"""

import importlib
import inspect
import itertools
import pkgutil
import re
import tomllib
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import griffe

import laticauda as lc

ROOT = Path(__file__).parent.parent
FOLDER = ROOT / "docs" / "api"
ROOMS = {
    "values": "Errors, declared quantities, and classes that users extend: what all else is made of",
    "compiling": "Scalar laws in machine code",
    "motion": "What the joints are asked for, and how they are driven",
    "water": "Loads on one element, flows, and water for any MuJoCo model",
    "robot": "What swims, and where: robots, modules, joints, fins, water and ground, as values and as files",
    "sensing": "What is in the water around a robot, and what the robot measures of it and of itself",
    "scenarios": "What decides a run, as a value; what bodies and brains agree on",
    "trials": "The log of one run, its figures, and its files",
    "models": "From scenarios to trials: the closed-form model, and the robot in MuJoCo",
    "control": "Paths, guidance and heading; where a robot is, from samples; planning ahead",
    "tank": "CAN frames and motion-capture packets, the virtual tank, the real-time loop and its safety",
    "identify": "Parameters from trials",
    "studies": "Sweeps and optimization",
    "connect": "TCP server, FMU, library in C, page without a server",
    "missions": "Missions: tables of phases by which a robot inspects and docks, by its sensors alone",
    "film": "From film to forces: files of trackers, cameras, printed tags, a chain fitted to all frames",
    "show": "Figures, films and pictures, reports, the live page",
    "paper": "The paper's study, on top of all",
}
MODULES_FOR_EXTENSIONS = {
    "values": ("errors", "extensions", "quantities"),
    "tank": ("operate.drivers.base",),
}
"""Modules that are shown whole, beside what their packages offer: whoever extends laticauda needs them."""
LONGEST_PAGE = 7000
"""Estimated height of a page at most [px]: ten screens of 768 px, less what the estimate may be off."""
NOT_SEARCHED = "---\nsearch:\n  exclude: true\n---\n\n"
"""So that the search gives guides, and `api/laticauda.md` and `api/index.md`, which has all names."""
RESULTS = ("Observation", "Plant", "Swims", "Trial")
"""Classes whose values nobody makes by hand."""
NAVIGATION = re.compile(r"( +# Pages of the packages: .*\n)(?: +- .*\n)+")


@dataclass(frozen=True, kw_only=True)
class Entry:
    """What one directive shows."""

    path: str
    module: str
    height: int
    members: tuple[str, ...] | None = None
    """Members of a class that are shown with it; None: all."""

    @property
    def directive(self) -> str:
        """The text that the page has for it."""
        if self.members is None:
            return f"::: {self.path}\n"
        listed = ", ".join(self.members)
        return f"::: {self.path}\n    options:\n      members: [{listed}]\n"


@dataclass(frozen=True, kw_only=True)
class Page:
    """One page of the reference of a package."""

    room: str
    label: str
    name: str
    """Name of its file."""
    entries: tuple[Entry, ...]

    @property
    def text(self) -> str:
        """Its content."""
        parts = [f"{NOT_SEARCHED}# laticauda.{self.label}\n", f"{ROOMS[self.room]}.\n"]
        parts += [entry.directive for entry in self.entries]
        if not self.entries:
            parts.append(COMPILING)
        return "\n".join(parts)


COMPILING = """\
It offers no names to users: [the planar kernels](../developing/planar.md) says what it is for.
"""


# ---- heights -------------------------------------------------------------------------------------


def estimate_height(content: Any) -> int:
    """Return about how high a name stands on its page at 1366 px [px].

    Within 6 % of what a browser measured of three packages.
    """
    if content.is_alias or (content.kind is griffe.Kind.ATTRIBUTE and content.docstring is None):
        return 0
    height = 55 + _signature_height(content) + _docstring_height(content)
    if content.kind in (griffe.Kind.CLASS, griffe.Kind.MODULE):
        height += sum(estimate_height(member) for member in shown_members(content))
    return height


def shown_members(content: Any) -> Iterator[Any]:
    """Yield the public members that are defined there, without modules."""
    for member in content.members.values():
        is_shown = not member.is_alias and not member.name.startswith("_")
        if is_shown and member.kind is not griffe.Kind.MODULE:
            yield member


def _signature_height(content: Any) -> int:
    if content.kind is griffe.Kind.ATTRIBUTE:
        return 55
    if content.kind is griffe.Kind.MODULE:
        return 0
    parameters = list(content.parameters)
    width = len(content.name) + sum(len(str(parameter)) for parameter in parameters)
    n_lines = 1 if width < 70 else len(parameters) + 2
    return 85 + 20 * n_lines  # with the folded source below it


def _docstring_height(content: Any) -> int:
    if content.docstring is None:
        return 0
    height = 0
    for section in griffe.parse_google(content.docstring, returns_multiple_items=False):
        if section.kind is griffe.DocstringSectionKind.text:
            paragraphs = section.value.split("\n\n")
            height += sum(46 + 26 * (len(paragraph) // 110) for paragraph in paragraphs)
        elif section.kind is griffe.DocstringSectionKind.examples:
            height += 60 + sum(20 * len(str(part[1]).splitlines()) for part in section.value)
        elif isinstance(section.value, list):
            rows = [str(row.description) for row in section.value]
            height += 90 + sum(45 + 26 * (len(row) // 60) for row in rows)
        else:
            height += 60
    return height


# ---- packages ------------------------------------------------------------------------------------


def read_sources() -> Any:
    """Read all sources, without importing them."""
    extensions = griffe.load_extensions(ROOT / "docs" / "declared_fields.py")
    return griffe.load("laticauda", search_paths=[ROOT / "src"], extensions=extensions)


def list_packages(name: str) -> Iterator[str]:
    """Yield a package and those in it."""
    yield name
    for found in pkgutil.iter_modules(importlib.import_module(name).__path__):
        if found.ispkg:
            yield from list_packages(f"{name}.{found.name}")


def list_entries(room: str, sources: Any) -> Iterator[Entry]:
    """Yield what a package and those in it offer, each name once, by the modules that define it."""
    seen = set[str]()
    for package in list_packages(f"laticauda.{room}"):
        entries = list[Entry]()
        for name in getattr(importlib.import_module(package), "__all__", ()):
            path = f"{package}.{name}"
            content = find_content(sources, path)
            if content is None or content.path in seen:
                continue
            seen.add(content.path)
            entries += split_entry(path, content)
        yield from sorted(entries, key=lambda entry: entry.module)
    for module in MODULES_FOR_EXTENSIONS.get(room, ()):
        path = f"laticauda.{room}.{module}"
        for member in shown_members(sources[path.removeprefix("laticauda.")]):
            if member.path not in seen and member.docstring is not None:
                yield from split_entry(member.path, member)


def find_content(sources: Any, path: str) -> Any:
    """Return what a public path leads to; None: a value without a text of its own."""
    try:
        content = sources[path.removeprefix("laticauda.")]
        return content.final_target if content.is_alias else content
    except (KeyError, griffe.AliasResolutionError):
        return None


def split_entry(path: str, content: Any) -> list[Entry]:
    """Return the entry of a name; of a class that is longer than a page, further ones of its last members."""
    module = content.module.path
    height = estimate_height(content)
    if height <= LONGEST_PAGE:
        return [Entry(path=path, module=module, height=height)]
    members = [member for member in shown_members(content) if estimate_height(member)]
    n_kept = len(members)
    while height > LONGEST_PAGE:
        n_kept -= 1
        height -= estimate_height(members[n_kept])
    kept = tuple(member.name for member in members[:n_kept])
    further = [
        Entry(path=f"{path}.{member.name}", module=module, height=estimate_height(member))
        for member in members[n_kept:]
    ]
    return [Entry(path=path, module=module, height=height, members=kept), *further]


def list_pages(sources: Any) -> Iterator[Page]:
    """Yield the pages of all packages."""
    for room in ROOMS:
        sheets = list[list[Entry]]()
        for entry in list_entries(room, sources):
            is_full = not sheets or sum(e.height for e in sheets[-1]) + entry.height > LONGEST_PAGE
            if is_full:
                sheets.append([])
            sheets[-1].append(entry)
        labels = label_sheets(room, sheets)
        if not sheets:
            yield Page(room=room, label=room, name=f"{room}.md", entries=())
        for number, (label, sheet) in enumerate(zip(labels, sheets, strict=True), start=1):
            name = f"{room}.md" if len(sheets) == 1 else f"{room}-{number}.md"
            yield Page(room=room, label=label, name=name, entries=tuple(sheet))


def label_sheets(room: str, sheets: Sequence[Sequence[Entry]]) -> list[str]:
    """Return the title of each page of a package: the modules that it is about."""
    if len(sheets) == 1:
        return [room]
    labels = list[str]()
    for sheet in sheets:
        modules = [entry.module.removeprefix(f"laticauda.{room}") for entry in sheet]
        names = list(dict.fromkeys(module.rpartition(".")[2] for module in modules if module))
        label = f"{room}: {', '.join(names[:3])}"
        n_same = sum(re.fullmatch(re.escape(label) + r"( \d+)?", one) is not None for one in labels)
        labels.append(f"{label} {n_same + 1}" if n_same else label)
    return labels


# ---- the names of `lc` ---------------------------------------------------------------------------


def spell_call(name: str) -> str:
    """Return how a name is called: its arguments, and the defaults that are plain values."""
    content = getattr(lc, name)
    if name in RESULTS:
        return f"lc.{name}"
    try:
        parameters = inspect.signature(content).parameters.values()
    except (TypeError, ValueError):  # a text, or a class of warnings
        return f"lc.{name}"
    words = list[str]()
    for parameter in parameters:
        if parameter.kind is parameter.KEYWORD_ONLY and "*" not in words:
            words.append("*")
        is_plain = isinstance(parameter.default, bool | int | float | str | None)
        words.append(f"{parameter.name}={parameter.default!r}" if is_plain else parameter.name)
    return f"lc.{name}({', '.join(words)})"


def first_sentence(name: str) -> str:
    """Return the first paragraph of a docstring, as one line of a table."""
    if name == "__version__":
        return "Version of laticauda."
    paragraph = (inspect.getdoc(getattr(lc, name)) or "").split("\n\n")[0]
    return paragraph.replace("\n", " ").replace("|", r"\|")


def read_examples() -> dict[str, dict[str, str]]:
    """Return the examples by group and name."""
    return tomllib.loads((FOLDER / "examples.toml").read_text(encoding="utf-8"))


def write_names() -> str:
    """Return the page of `laticauda` itself."""
    parts = [NAMES_HEAD, '<div class="compact" markdown>\n']
    for group, examples in read_examples().items():
        parts.append(f"## {group}\n")
        rows = ["| call | what it is | example |", "|---|---|---|"]
        for name, example in examples.items():
            shown = "<br>".join(f"`{line}`" for line in example.strip().splitlines())
            call = f'<a id="{name}"></a>`{spell_call(name)}`'
            rows.append(f"| {call} | {first_sentence(name)} | {shown} |")
        parts.append("\n".join(rows) + "\n")
    parts.append("</div>\n")
    return "\n".join(parts)


NAMES_HEAD = """\
---
hide:
  - toc
---

# The names of `lc`

What `import laticauda as lc` offers, by what you do with it. The examples run from top to bottom, after
`import warnings` and `from dataclasses import replace`. `help(lc.swim)` says more of each argument, with its
unit; angles are in radians unless a name ends in `_deg`. What the packages offer beyond this stands in
[All names](index.md).
"""
INDEX_HEAD = """\
# All names

Most users need [the names of `lc`](laticauda.md) alone. Here is what every package offers, with its page;
each name there has its unit, shape and frame, what it raises, and its source.
"""


def write_index(pages: Iterable[Page]) -> str:
    """Return the page that has all names."""
    parts = [INDEX_HEAD]
    for room, group in itertools.groupby(pages, key=lambda page: page.room):
        parts.append(f"## laticauda.{room}\n\n{ROOMS[room]}.\n")
        for page in group:
            names = [f"`{entry.path.removeprefix(f'laticauda.{room}.')}`" for entry in page.entries]
            listed = f": {', '.join(names)}" if names else ""
            parts.append(f"- [{page.label}]({page.name}){listed}")
        parts.append("")
    return "\n".join(parts)


def write_navigation(pages: Iterable[Page]) -> str:
    """Return `mkdocs.yml` with these pages."""
    text = (ROOT / "mkdocs.yml").read_text(encoding="utf-8")
    lines = "".join(f'          - "{page.label}": api/{page.name}\n' for page in pages)
    return NAVIGATION.sub(lambda found: found[1] + lines, text)


def make_files() -> dict[Path, str]:
    """Return what every file of the reference has to contain."""
    pages = list(list_pages(read_sources()))
    files = {FOLDER / page.name: page.text for page in pages}
    files[FOLDER / "index.md"] = write_index(pages)
    files[FOLDER / "laticauda.md"] = write_names()
    files[ROOT / "mkdocs.yml"] = write_navigation(pages)
    return files


def main() -> None:
    """Write the files, and remove pages that are no more."""
    files = make_files()
    for path in FOLDER.glob("*.md"):
        if path not in files:
            path.unlink()
    for path, text in files.items():
        path.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
