"""What to type for an extra depends on where laticauda was installed from."""

import json
import subprocess
from pathlib import Path

import pytest

from laticauda.values import installation

ROOT = Path(__file__).parents[2]
NAMED_ONLY_IN = (
    "docs/developing/release.md",  # says when it will be printed
    "src/laticauda/values/installation.py",  # only together with an address
    "tests/values/test_installation.py",
)
WHEEL = "https://example.org/laticauda-0.3.0-py3-none-any.whl"
REPOSITORY = "https://example.org/laticauda.git"


@pytest.fixture
def installed_from(monkeypatch: pytest.MonkeyPatch):
    def note(origin: dict[str, object]) -> str:
        class Noted:
            def read_text(self, name: str) -> str | None:
                assert name == "direct_url.json"
                if not origin:
                    return None
                return json.dumps(origin)

        monkeypatch.setattr(installation, "distribution", lambda name: Noted())
        return installation.advise_extra("scale")

    return note


def test_a_clone_is_named_by_its_folder(installed_from, tmp_path, monkeypatch):
    clone = tmp_path / "a clone"
    clone.mkdir()
    (clone / "pyproject.toml").touch()
    plain = {"url": clone.as_uri(), "dir_info": {}}
    assert installed_from(plain) == f'run `pip install "{clone}[scale]"`'
    monkeypatch.chdir(clone)
    assert installed_from(plain) == 'run `pip install ".[scale]"`'
    editable = {"url": clone.as_uri(), "dir_info": {"editable": True}}
    assert installed_from(editable) == 'run `pip install --editable ".[scale]"`'


def test_an_address_is_named_with_its_revision(installed_from):
    found = {"vcs": "git", "commit_id": "abc123"}
    origin = {"url": REPOSITORY, "vcs_info": found}
    begin = f'run `pip install "laticauda[scale] @ git+{REPOSITORY}'
    assert installed_from(origin) == f'{begin}@abc123"`'
    asked = {"url": REPOSITORY, "vcs_info": found | {"requested_revision": "v0.3"}}
    assert installed_from(asked) == f'{begin}@v0.3"`'
    assert installed_from({"url": REPOSITORY, "vcs_info": {"vcs": "git"}}) == f'{begin}"`'
    wheel = {"url": WHEEL, "archive_info": {}}
    assert installed_from(wheel) == f'run `pip install "laticauda[scale] @ {WHEEL}"`'


def test_a_clone_that_has_gone_or_never_was_is_not_named(installed_from, tmp_path, monkeypatch):
    advice = 'run `pip install ".[scale]"` in a clone of laticauda'
    gone = {"url": (tmp_path / "gone").as_uri(), "dir_info": {"editable": True}}
    assert installed_from(gone) == advice
    monkeypatch.setattr(installation, "SOURCES", tmp_path)
    assert installed_from({}) == advice
    monkeypatch.setattr(installation, "SOURCES", ROOT)
    monkeypatch.chdir(tmp_path)
    assert installed_from({}) == f'run `pip install "{ROOT}[scale]"`'


def test_sources_that_were_never_installed_are_a_clone_too(monkeypatch):
    def refuse(name: str):
        raise installation.PackageNotFoundError(name)

    monkeypatch.setattr(installation, "distribution", refuse)
    monkeypatch.chdir(ROOT)
    assert installation.advise_extra("mpc") == 'run `pip install ".[mpc]"`'


def test_nobody_is_told_to_install_laticauda_from_an_index():
    listed = subprocess.run(
        ["git", "grep", "-l", "-I", "-E", "pip install (-[^ ]+ )*[\"']?laticauda"],
        cwd=ROOT,
        capture_output=True,
        text=True,
    )
    if listed.returncode > 1:
        pytest.skip("not a git checkout")
    assert not set(listed.stdout.splitlines()) - {*NAMED_ONLY_IN}
