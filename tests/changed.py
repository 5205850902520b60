"""What `make quick` looks at: sources that differ from the last landing, and the tests of their packages or plugins.

    python tests/changed.py sources|tests [BASE]

Prints paths, one line each; BASE is a commit, by default the upstream branch, else HEAD.
"""

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parent.parent


def git(*words: str) -> list[str]:
    """The lines that git prints; none if it fails."""
    done = subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True, check=False)
    return done.stdout.splitlines() if done.returncode == 0 else []


def changed(base: str | None) -> list[Path]:
    """Files that differ from a commit, new ones too, that are still there."""
    base = base or next(iter(git("rev-parse", "--abbrev-ref", "@{upstream}")), "HEAD")
    names = {*git("diff", "--name-only", base), *git("ls-files", "--others", "--exclude-standard")}
    return sorted(
        path for path in map(Path, names) if path.suffix == ".py" and (ROOT / path).exists()
    )


def tests_of(paths: list[Path]) -> list[Path]:
    """The folders and files of tests that belong to these files."""
    found: set[Path] = set()
    for path in paths:
        if path.parts[:2] == ("src", "laticauda"):
            place = Path("tests", *path.parts[2:3])
            found.add(place if len(path.parts) > 3 else place.with_name(f"test_{path.name}"))
        elif path.parts[0] == "plugins":
            found.add(Path(*path.parts[:2], "tests"))
        elif path.parts[0] == "tests" and path.name.startswith("test_"):
            found.add(path)
    return sorted(path for path in found if (ROOT / path).exists())


def main() -> None:
    """Print what was asked for."""
    what, *rest = sys.argv[1:]
    paths = changed(rest[0] if rest else None)
    sources = [path for path in paths if "src" in path.parts[:3]]  # of a plugin, too
    sys.stdout.writelines(f"{path}\n" for path in (tests_of(paths) if what == "tests" else sources))


if __name__ == "__main__":
    main()
