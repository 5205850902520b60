"""Where this laticauda was installed from, and the command that adds one of its extras there."""

import json
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path
from typing import Any

SOURCES = Path(__file__).parents[3]
"""The clone, where the package is used from one."""


def advise_extra(extra: str) -> str:
    """Return what to do to install an extra of laticauda, from where laticauda itself came from.

    A package index is not asked for it: laticauda is on none, and anybody may take its name there.

    Args:
        extra: Name of the extra.
    """
    origin = _read_origin()
    address: str = origin.get("url", "")
    if "vcs_info" in origin:
        return f'run `pip install "laticauda[{extra}] @ {_spell_repository(origin)}"`'
    if "archive_info" in origin:
        return f'run `pip install "laticauda[{extra}] @ {address}"`'
    if "dir_info" not in origin:
        return _advise_in_folder(SOURCES, "", extra)
    # Slow to import, and needed only where an extra is missing.
    from urllib.parse import urlsplit
    from urllib.request import url2pathname

    folder = Path(url2pathname(urlsplit(address).path))
    option = ""
    if origin["dir_info"].get("editable", False):
        option = "--editable "
    return _advise_in_folder(folder, option, extra)


def _read_origin() -> dict[str, Any]:
    """Return what the installer noted, as the packaging specification of `direct_url.json` has it."""
    try:
        noted = distribution("laticauda").read_text("direct_url.json")
    except PackageNotFoundError:  # used from its sources, without an installation
        return {}
    return json.loads(noted or "{}")


def _spell_repository(origin: dict[str, Any]) -> str:
    version = origin["vcs_info"]
    address = f"{version['vcs']}+{origin['url']}"
    revision = version.get("requested_revision", version.get("commit_id"))
    if revision is None:
        return address
    return f"{address}@{revision}"


def _advise_in_folder(folder: Path, option: str, extra: str) -> str:
    if not (folder / "pyproject.toml").is_file():  # the clone has gone, or there never was one
        return f'run `pip install ".[{extra}]"` in a clone of laticauda'
    typed = str(folder)
    if folder.resolve() == Path.cwd().resolve():
        typed = "."
    return f'run `pip install {option}"{typed}[{extra}]"`'
