"""Reading is bounded and says what is wrong; writing replaces a file as a whole or leaves it as it was."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from laticauda.values.errors import RobotFileError, StorageFailed
from laticauda.values.files import parse_toml, read_bytes, read_text, read_toml, to_json, write


def test_a_text_is_read_without_its_byte_order_mark(tmp_path: Path):
    (tmp_path / "a.toml").write_bytes(b"\xef\xbb\xbfx = 1\r\ny = 2\r\n")
    assert read_text(tmp_path / "a.toml") == "x = 1\ny = 2\n"
    assert read_toml(tmp_path / "a.toml") == {"x": 1, "y": 2}


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"x = \xff", r"a\.toml: is not UTF-8 text \(invalid start byte at byte 4\)$"),
        (b"x = ", r"a\.toml: is not valid TOML: Invalid value"),
        (b"x = " + b"[" * 100_000, r"a\.toml: is not valid TOML: nested too deeply$"),
        (b"x = 1" + b"0" * 5000, r"a\.toml: is not valid TOML: Exceeds the limit"),
    ],
)
def test_what_is_no_toml_is_refused_with_its_name_and_the_reason(
    tmp_path: Path, content: bytes, message: str
):
    (tmp_path / "a.toml").write_bytes(content)
    with pytest.raises(RobotFileError, match=message):
        read_toml(tmp_path / "a.toml", RobotFileError)


def test_what_is_no_file_is_refused(tmp_path: Path):
    with pytest.raises(RobotFileError, match="is a folder, not a file"):
        read_text(tmp_path, RobotFileError)
    with pytest.raises(StorageFailed, match="no such file"):
        read_text(tmp_path / "none", RobotFileError, missing=StorageFailed)
    with pytest.raises(RobotFileError, match="cannot be read: embedded null byte"):
        read_text("a\0b", RobotFileError)
    with pytest.raises(RobotFileError, match="cannot be read: File name too long"):
        read_text("a" * 500, RobotFileError)


@pytest.mark.skipif(not Path("/dev/zero").exists(), reason="no such device")
def test_what_never_ends_is_not_read_to_its_end():
    with pytest.raises(
        RobotFileError, match="is larger than 64 MiB, too large for a file of this kind"
    ):
        read_text("/dev/zero", RobotFileError)


def test_a_text_that_is_no_toml_is_refused_by_its_name():
    with pytest.raises(RobotFileError, match=r"^<text>: is not valid TOML"):
        parse_toml("=", "<text>", RobotFileError)


@pytest.mark.parametrize(
    "content", ["größer", "größer".encode(), lambda path: path.write_text("größer", "utf-8")]
)
def test_bytes_texts_and_functions_write_a_file_and_leave_nothing_beside_it(
    tmp_path: Path, content
):
    write(tmp_path / "a.txt", "old")
    write(tmp_path / "a.txt", content)
    assert (tmp_path / "a.txt").read_text("utf-8") == "größer"
    assert os.listdir(tmp_path) == ["a.txt"]


def test_a_function_is_given_a_name_with_the_same_ending(tmp_path: Path):
    seen: list[str] = []
    write(tmp_path / "a.png", lambda path: (seen.append(path.suffix), path.write_text("x")))
    assert seen == [".png"]


def _fails_halfway(path: Path) -> None:
    path.write_text("half")
    raise OSError(28, "No space left on device")


def test_when_it_fails_the_old_file_stays_and_the_message_says_what_to_do(tmp_path: Path):
    write(tmp_path / "a.txt", "old")
    with pytest.raises(
        StorageFailed,
        match=r"a\.txt: cannot be written: No space left on device; make room there, or",
    ):
        write(tmp_path / "a.txt", _fails_halfway)
    assert (tmp_path / "a.txt").read_text() == "old"
    assert os.listdir(tmp_path) == ["a.txt"]


def test_what_cannot_be_written_is_refused(tmp_path: Path):
    with pytest.raises(StorageFailed, match="none/a: cannot be written: No such file or directory"):
        write(tmp_path / "none" / "a", "x")
    with pytest.raises(StorageFailed, match="cannot be written: Is a directory"):
        write(tmp_path, "x")


@pytest.mark.skipif(os.name != "posix", reason="links and modes of POSIX")
def test_a_link_goes_on_pointing_to_its_file_whose_mode_stays_and_a_device_stays_a_device(
    tmp_path: Path,
):
    write(tmp_path / "a.txt", "old")
    (tmp_path / "a.txt").chmod(0o640)
    (tmp_path / "link").symlink_to("a.txt")
    write(tmp_path / "link", "new")
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "a.txt").read_text() == "new"
    assert (tmp_path / "a.txt").stat().st_mode & 0o777 == 0o640
    write("/dev/null", "x")
    assert Path("/dev/null").is_char_device()


def test_data_that_never_end_are_not_read_to_their_end():
    with pytest.raises(OSError, match="File too large"):
        read_bytes("/dev/zero", most_bytes=1000)


KILLED = """
import os, signal, sys
from pathlib import Path
from laticauda.values.files import write

write(Path(sys.argv[1]), lambda new: (new.write_text("half"), os.kill(os.getpid(), signal.SIGKILL)))
"""


@pytest.mark.skipif(
    os.name != "posix", reason="elsewhere nobody can ask whether a process is there"
)
def test_what_a_killed_writer_left_is_removed_by_the_next_and_what_a_living_one_writes_stays(
    tmp_path: Path,
):
    write(tmp_path / "a.txt", "old")
    subprocess.run([sys.executable, "-c", KILLED, str(tmp_path / "a.txt")], check=False)
    assert len(os.listdir(tmp_path)) == 2
    seen: list[list[str]] = []

    def also_writes(new: Path) -> None:
        new.write_text("b")
        write(tmp_path / "c.txt", "c")
        seen.append(sorted(os.listdir(tmp_path)))

    write(tmp_path / "b.txt", also_writes)
    assert [name for name in seen[0] if not name.startswith(".")] == ["a.txt", "c.txt"]
    assert len(seen[0]) == 3  # its own, which it is just writing
    assert sorted(os.listdir(tmp_path)) == ["a.txt", "b.txt", "c.txt"]
    assert (tmp_path / "a.txt").read_text() == "old"


READ_ONLY = """
import os, sys
from laticauda.values.files import write

if os.getuid() == 0:
    os.setuid(65534)
write(sys.argv[1], "new")
"""


@pytest.mark.skipif(os.name != "posix", reason="no such rights")
def test_a_file_that_was_made_read_only_stays_as_it_is(tmp_path: Path):
    file = tmp_path / "a.txt"
    file.write_text("old")
    file.chmod(0o444)
    for folder in (tmp_path, *tmp_path.parents):
        if folder.name.startswith(
            ("test_", "popen-", "pytest-")
        ):  # others may look into what is ours
            folder.chmod(0o777)
    done = subprocess.run(
        [sys.executable, "-c", READ_ONLY, str(file)], capture_output=True, text=True, check=False
    )
    assert done.returncode != 0
    assert (
        "a.txt: cannot be written: it is read-only; correct this, or name another place."
        in done.stderr
    )
    assert (file.read_text(), os.listdir(tmp_path)) == ("old", ["a.txt"])


@pytest.mark.parametrize(
    "address", ["s3://bucket/run.toml", "memory://x", Path("gs://a/b"), "file:///tmp/x.toml"]
)
def test_an_address_is_no_file_and_never_becomes_a_folder(tmp_path: Path, monkeypatch, address):
    monkeypatch.chdir(tmp_path)
    for read_or_write in (read_text, read_bytes, lambda path: write(path, b"x")):
        with pytest.raises(
            StorageFailed, match=r"^\w+:/.* is an address; give a path on this computer"
        ):
            read_or_write(address)
    assert not list(tmp_path.iterdir())


def test_a_number_that_is_not_finite_is_null_in_json():
    content = {"speed": float("nan"), "rows": [(1.0, float("inf"))], "name": "x", "n": 3}
    assert json.loads(to_json(content)) == {
        "speed": None,
        "rows": [[1.0, None]],
        "name": "x",
        "n": 3,
    }


def test_an_empty_text_is_the_name_of_no_file():
    with pytest.raises(StorageFailed, match="'': an empty text is not the name of a file"):
        read_text("")


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no such pipes")
def test_a_pipe_that_nobody_reads_is_refused_and_one_that_is_read_gets_all(tmp_path):
    pipe = tmp_path / "a.txt"
    os.mkfifo(pipe)
    with pytest.raises(StorageFailed, match=r"a\.txt: cannot be written: it is a pipe that nobody"):
        write(pipe, "x")
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    write(pipe, "whole")
    assert os.read(reader, 100) == b"whole"
    os.close(reader)
