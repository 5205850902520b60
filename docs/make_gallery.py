"""Run the examples and make the gallery of them: `python docs/make_gallery.py`, which `make docs` does.

Each gets a page with its code, what it prints and the pictures that it saves. What was made of
today's code is not made again.
"""

import ast
import hashlib
import os
import re
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parent.parent
FOLDER = ROOT / "docs" / "gallery"
INDEX = """# Gallery of examples

Each script shows one idea. What it prints and draws was made by running it when these pages were built.

<div class="gallery" markdown>
"""


@dataclass(frozen=True, kw_only=True)
class Found:
    """What an example left."""

    printed: str
    pictures: list[tuple[str, bytes]]


def run(example: Path) -> Found:
    """Run it in an empty folder."""
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run(
            [sys.executable, str(example)],
            cwd=folder,
            env={**os.environ, "MPLBACKEND": "Agg"},
            capture_output=True,
            text=True,
        )
        if done.returncode:
            raise RuntimeError(f"{example.name} failed:\n{done.stderr}")
        pictures = [(path.name, path.read_bytes()) for path in sorted(Path(folder).glob("*.png"))]
    return Found(printed=done.stdout, pictures=pictures)


def page(example: Path, title: str, found: Found) -> str:
    """Its page: what it is about, pictures, code, and what it prints."""
    text = example.read_text(encoding="utf-8")
    about = ast.get_docstring(ast.parse(text)) or ""
    words = re.sub(r"(?m)^( {4})?(python examples/|pip install ).*\n?", "", about).strip()
    code = text[text.index('"""', 3) + 3 :].strip()
    name = title.split(": ")[1]
    shown = [
        f"![{name}: the picture that the example draws]({example.stem}-{picture})"
        for picture, _ in found.pictures
    ]
    prints = ["It prints", f"```text\n{found.printed.rstrip()}\n```"]
    return "\n\n".join([f"# {title}", words, *shown, f"```python\n{code}\n```", *prints]) + "\n"


def digest(example: Path) -> str:
    """Of all that its page is made of."""
    sources = [example, Path(__file__), *sorted((ROOT / "src").rglob("*.py"))]
    return hashlib.sha256(b"".join(path.read_bytes() for path in sources)).hexdigest()


def make_gallery() -> None:
    """Write the page of every example that is not there yet, and the page with all of them."""
    FOLDER.mkdir(exist_ok=True)
    listed = re.findall(
        r'"(\d\d: .+)": gallery/(\w+)\.md', (ROOT / "mkdocs.yml").read_text(encoding="utf-8")
    )
    cards = [INDEX]
    for title, stem in listed:
        example, mark = ROOT / "examples" / f"{stem}.py", FOLDER / f".{stem}"
        if not mark.exists() or mark.read_text() != digest(example):
            sys.stderr.write(f"{example.name} ...\n")
            found = run(example)
            for old in FOLDER.glob(f"{stem}-*.png"):
                old.unlink()
            for name, picture in found.pictures:
                (FOLDER / f"{stem}-{name}").write_bytes(picture)
            (FOLDER / f"{stem}.md").write_text(page(example, title, found), encoding="utf-8")
            mark.write_text(digest(example))
        pictures = sorted(FOLDER.glob(f"{stem}-*.png"))
        picture = f"![{title}]({pictures[0].name})" if pictures else ""
        cards.append(f"<div markdown>\n[{picture}<br>{title}]({stem}.md)\n</div>\n")
    (FOLDER / "index.md").write_text("\n".join([*cards, "</div>"]) + "\n", encoding="utf-8")


if __name__ == "__main__":
    make_gallery()
