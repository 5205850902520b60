"""Run the notebooks and make a page of each: `python docs/make_notebooks.py`, which `make docs` does.

The files keep no results. What was made of today's code is not made again.
"""

import base64
import hashlib
import sys
import tempfile
from pathlib import Path
from typing import Any

import nbformat
from nbclient import NotebookClient

ROOT = Path(__file__).parent.parent
FOLDER = ROOT / "docs" / "notebooks"


def executed(path: Path) -> Any:
    """The notebook with its results, run in an empty folder."""
    notebook = nbformat.read(path, as_version=4)
    with tempfile.TemporaryDirectory() as folder:
        NotebookClient(notebook, timeout=300, resources={"metadata": {"path": folder}}).execute()
    return notebook


def page(notebook: Any, stem: str) -> tuple[str, dict[str, bytes]]:
    """Its page, and the pictures on it by name."""
    parts: list[str] = []
    pictures: dict[str, bytes] = {}
    for cell in notebook.cells:
        if cell.cell_type == "markdown":
            parts.append(cell.source)
            continue
        lines = [line for line in cell.source.splitlines() if not line.startswith("%")]
        parts.append("```python\n" + "\n".join(lines) + "\n```")
        for output in cell.outputs:
            data = output.get("data", {})
            if "image/png" in data:
                name = f"{stem}-{len(pictures) + 1}.png"
                pictures[name] = base64.b64decode(data["image/png"])
                parts.append(f"![What the cell above draws]({name})")
            elif output.output_type == "stream" and output.name == "stdout":
                parts.append(f"```text\n{output.text.rstrip()}\n```")
            elif "text/plain" in data:
                parts.append(f"```text\n{data['text/plain']}\n```")
    head, *rest = parts
    title, _, words = head.partition("\n")
    offer = f"*A notebook: [{stem}.ipynb]({stem}.ipynb), with what it prints and draws.*"
    return "\n\n".join([title, offer, words.strip(), *rest]) + "\n", pictures


def digest(path: Path) -> str:
    """Of all that its page is made of."""
    sources = [path, Path(__file__), *sorted((ROOT / "src").rglob("*.py"))]
    return hashlib.sha256(b"".join(one.read_bytes() for one in sources)).hexdigest()


def make_notebooks() -> None:
    """Write the page of every notebook that is not there yet."""
    for path in sorted(FOLDER.glob("*.ipynb")):
        mark = FOLDER / f".{path.stem}"
        if mark.exists() and mark.read_text() == digest(path):
            continue
        sys.stderr.write(f"{path.name} ...\n")
        text, pictures = page(executed(path), path.stem)
        for old in FOLDER.glob(f"{path.stem}-*.png"):
            old.unlink()
        for name, picture in pictures.items():
            (FOLDER / name).write_bytes(picture)
        (FOLDER / f"{path.stem}.md").write_text(text, encoding="utf-8")
        mark.write_text(digest(path))


if __name__ == "__main__":
    make_notebooks()
