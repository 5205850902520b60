"""Does any command harm an older file, or say too much, when the disk is full, when it may not write, or is stopped?

Every command that writes runs over older files of the names of its own, which hold something else:
    full        on a file system without room
    read-only   in a folder that may not be written
    file        over files that may not be written
    killed      ended by SIGKILL at a random moment, then run again
    ctrl-c      stopped by SIGINT at a random moment, then again a little later

Of each file that was there either the older bytes remain or all of the new; after the first three the program ends with
status 2 and one line that names the place; nothing is left beside the files once a killed command has run again; and
Ctrl-C is answered by one line at most, with status 130 (servers and those that were done: 0; by a second one: the
signal). Moments are counted from where the program takes the signal: before that, Python itself is starting.

    python campaigns/full_disk.py              # as root, on Linux: file systems are mounted, rights given up
    python campaigns/full_disk.py --moments 8  # more moments of each

The answer is in full_disk.csv, as far as it was tried (36 of 100 cases); the tests run a slice. Once in two dozen
interrupts of `trial convert` a library printed a traceback before the one line; it did not come again.
"""

import argparse
import contextlib
import csv
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import laticauda as lc

STORED = Path(__file__).with_suffix(".csv")
FAULTS = ("full", "read-only", "file", "killed", "ctrl-c")
DISK = {"full", "read-only", "file"}
PATIENCE = 300.0  # [s]
# Its first line says that Ctrl-C is listened to from now on.
PROGRAM = "import sys; from laticauda.cli import main; print('begun', flush=True); sys.exit(main())"
SHORT = "--vary amplitude-deg=20:60:{} --duration 1"
# By its name: what is typed, and the files in the folder `out` that it writes; a folder ends in /.
COMMANDS: dict[str, tuple[str, tuple[str, ...]]] = {
    "swim": (
        "swim --duration 1 --save out/run.nc --plot out/run.pdf --save-scenario out/run.toml",
        ("run.nc", "run.pdf", "run.toml"),
    ),
    "follow": ("follow --duration 2 --save out/run.nc --plot out/run.png", ("run.nc", "run.png")),
    "sweep": (f"sweep {SHORT.format(5)} --output out/sweep", ()),
    "optimize": ("optimize --vary amplitude-deg=20:40 --duration 1 --budget 100 --output out/optimum", ()),
    "identify": (
        "identify run-0.nc run-1.nc run-2.nc --parameters water.normal_drag --robot mamba "
        "--measured forward_velocity=0.004 --starts 1 --threads 1 --output out",
        ("parameters.toml", "fit.json", "identify.html", "parity.png"),
    ),
    "design-experiment": (
        "design-experiment --parameters water.normal_drag --sensors speed --trials 1 --output out/plan.png",
        ("plan.png",),
    ),
    "export mjcf": ("export mjcf out/robot.xml", ("robot.xml",)),
    "export urdf": ("export urdf out/robot.urdf", ("robot.urdf",)),
    "export fmu": ("export fmu out/robot.fmu", ("robot.fmu",)),
    "export c": ("export c out/robot.h", ("robot.h",)),
    "export web": ("export web out", ("index.html",)),
    "lab": ("lab --duration 1 --port 0 --save out/run.nc", ("run.nc",)),
    "replay": ("replay run.mcap --save out/run.nc", ("run.nc",)),
    "view": ("view run.nc --still out/run.png --size 64 64", ("run.png",)),
    "view, a film": ("view run.nc --video out/run.mp4 --size 64 64 --fps 5 --to 0.4", ("run.mp4",)),
    "trial convert, nc": ("trial convert run.nc out/run.nc", ("run.nc",)),
    "trial convert, csv": ("trial convert run.nc out/run.csv", ("run.csv",)),
    "trial convert, mat": ("trial convert run.nc out/run.mat", ("run.mat",)),
    "trial convert, mcap": ("trial convert run.nc out/run.mcap", ("run.mcap",)),
    "trial convert, parquet": ("trial convert run.nc out/run.parquet", ("run.parquet",)),
}


def prepare(folder: Path) -> None:
    """What the commands read: a stored trial, and a recording."""
    gait = lc.lateral_undulation(amplitude=0.5, frequency=2.3, phase_shift=0.7)
    lc.swim("mamba", gait, 4.0).save(folder / "run.nc")
    for k in range(3):
        lc.swim("mamba", replace(gait, amplitude=0.4 + 0.1 * k), 4.0).save(folder / f"run-{k}.nc")
    sys.path.insert(0, str(Path(__file__).parent))
    from kills import recorded

    recorded(folder)


def lay(out: Path, names: tuple[str, ...]) -> dict[str, bytes]:
    """Put older files in place."""
    out.mkdir()
    kept = {name: f"an older {name}".encode() * 50 for name in (*names, "other.txt")}
    for name, content in kept.items():
        (out / name).write_bytes(content)
    return kept


@contextlib.contextmanager
def fault_at(out: Path, fault: str) -> Iterator[None]:
    """Have a fault of the disk there."""
    if fault == "full":
        older = {file.name: file.read_bytes() for file in out.iterdir()}
        subprocess.run(["mount", "-t", "tmpfs", "-o", "size=256k", "tmpfs", str(out)], check=True)
        try:
            for name, content in older.items():
                (out / name).write_bytes(content)
            with contextlib.suppress(OSError), (out / "rest").open("wb", buffering=0) as rest:
                while rest.write(b"x" * 4096):
                    pass
            yield
        finally:
            for name in older:
                older[name] = (out / name).read_bytes() if (out / name).exists() else b""
            left = [file.name for file in out.iterdir() if file.name not in (*older, "rest")]
            subprocess.run(["umount", str(out)], check=True)
            for name, content in older.items():
                (out / name).write_bytes(content)
            for name in left:
                (out / name).write_bytes(b"left on the full disk")
        return
    places = [out] if fault == "read-only" else [file for file in out.iterdir() if file.is_file()]
    for place in places:
        place.chmod(0o555 if place.is_dir() else 0o444)
    yield
    for place in places:
        place.chmod(0o755 if place.is_dir() else 0o644)


def started(words: str, folder: Path, *, is_bound: bool = False) -> "subprocess.Popen[str]":
    """The program; bound: rights hold for it, as they do not for root."""
    run = [sys.executable, "-c", PROGRAM, *words.split()]
    if is_bound and os.getuid() == 0:
        run = ["setpriv", "--bounding-set", "-dac_override,-dac_read_search", *run]
    return subprocess.Popen(
        run, cwd=folder, text=True, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )


def ended(process: "subprocess.Popen[str]") -> tuple[int, str]:
    """Exit status, and what was said on standard error."""
    told = process.communicate(timeout=PATIENCE)[1]
    return process.returncode, told


def harm(out: Path, older: dict[str, bytes], names: tuple[str, ...], *, is_whole: bool) -> str:
    """What is wrong with the files that were there, in words; "" if nothing is.

    Args:
        out: The folder.
        older: What was there.
        names: Those that the command writes.
        is_whole: Whether all of them have to be the older ones.
    """
    for name, content in older.items():
        if not (out / name).is_file():
            return f"{name} is gone"
        now = (out / name).read_bytes()
        if now != content and (is_whole or name not in names or now == content[: len(now)]):
            return f"{name} is another one"
    return ""


def rubbish(out: Path) -> str:
    """What a writer left behind."""
    return ", ".join(sorted(str(file.relative_to(out)) for file in out.rglob("*") if _is_part(file)))


def _is_part(file: Path) -> bool:
    return file.name.startswith(".") or file.name.endswith(".partial")


def complaint(told: str) -> str:
    """What is wrong with what was said; "" if nothing is."""
    if "Traceback" in told or "Exception ignored" in told:
        return "a traceback: " + told.strip().splitlines()[-1]
    lines = [line for line in told.splitlines() if line.startswith("laticauda: ") and "compil" not in line]
    return "" if len(lines) <= 1 else f"{len(lines)} lines"


def on_disk(words: str, names: tuple[str, ...], folder: Path, fault: str) -> str:
    """What a command does on a disk with a fault: "kept", or what was wrong."""
    out = folder / "out"
    older = lay(out, names)
    with fault_at(out, fault):
        status, told = ended(started(words, folder, is_bound=fault != "full"))
    if fault == "file" and not names:
        return "no such file"
    wrong = harm(out, older, names, is_whole=True) or complaint(told) or rubbish(out)
    if not wrong and status != 2:
        wrong = f"status {status}"
    if not wrong and re.search(r"\bout\b", told) is None:
        wrong = f"names no place: {told.strip()}"
    return wrong or "kept"


def stopped(words: str, names: tuple[str, ...], folder: Path, after: float, *, again: float | None) -> str:
    """What a command does when it is stopped: "kept", or what was wrong.

    Args:
        words: What is typed.
        names: The files that it writes.
        folder: Where it runs.
        after: The moment, since the program listens [s].
        again: The time from there to the second Ctrl-C; None: none, it is killed [s].
    """
    out = folder / "out"
    older = lay(out, names)
    process = started(words, folder)
    assert process.stdout is not None
    process.stdout.readline()
    time.sleep(after)
    process.send_signal(signal.SIGKILL if again is None else signal.SIGINT)
    if again is not None and again < 1.0:
        time.sleep(again)
        process.send_signal(signal.SIGINT)
    status, told = ended(process)
    wrong = harm(out, older, names, is_whole=False)
    if again is None:
        if not wrong:
            status, told = ended(started(words, folder))
            wrong = rubbish(out) or ("" if status == 0 else f"status {status} when run again: {told.strip()}")
        return wrong or "kept"
    wrong = wrong or complaint(told)
    return wrong or ("kept" if status in (0, 130, -signal.SIGINT) else f"status {status}: {told.strip()}")


def answer(command: str, fault: str, scratch: Path, moments: int, seed: int = 0) -> str:
    """What became of a command under a fault: "kept", or the first thing that was wrong."""
    words, names = COMMANDS[command]
    chance = random.Random(f"{command} {fault} {seed}")

    def fresh() -> Path:
        shutil.rmtree(scratch / "out", ignore_errors=True)
        return scratch

    if fault in DISK:
        return on_disk(words, names, fresh(), fault)
    begun = time.monotonic()
    lay(fresh() / "out", names)
    if ended(started(words, scratch))[0] != 0:
        return "it does not run"
    took = time.monotonic() - begun
    for _ in range(moments):
        again = chance.choice((0.0, 0.01, 0.2, 2.0)) if fault == "ctrl-c" else None
        found = stopped(words, names, fresh(), chance.uniform(0.0, took), again=again)
        if found != "kept":
            return found
    return "kept"


def can_mount() -> bool:
    """Whether file systems can be mounted here."""
    with tempfile.TemporaryDirectory() as name:
        done = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=64k", "tmpfs", name], capture_output=True)
        return done.returncode == 0 and subprocess.run(["umount", name]).returncode == 0


def stored() -> dict[str, dict[str, str]]:
    """The answer that is kept, by command."""
    if not STORED.exists():
        return {}
    with STORED.open(newline="") as file:
        return {row["command"]: row for row in csv.DictReader(file)}


def store(row: dict[str, str]) -> None:
    """Keep an answer beside those of other commands and faults."""
    rows = stored()
    rows[row["command"]] = rows.get(row["command"], dict.fromkeys(FAULTS, "not tried")) | row
    with STORED.open("w", newline="") as file:
        table = csv.DictWriter(file, ["command", *FAULTS])
        table.writeheader()
        table.writerows(rows[command] for command in COMMANDS if command in rows)


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--moments", type=int, default=3)
    parser.add_argument("--only", nargs="*", default=list(COMMANDS))
    parser.add_argument("--faults", nargs="*", default=list(FAULTS))
    parser.add_argument("--store", action="store_true")
    options = parser.parse_args()
    rows: list[dict[str, str]] = []
    mounts = can_mount()
    with tempfile.TemporaryDirectory() as name:
        prepare(Path(name))
        for command in options.only:
            row = {"command": command}
            for fault in options.faults:
                is_possible = mounts or fault != "full"
                row[fault] = answer(command, fault, Path(name), options.moments) if is_possible else "not tried"
            print(*row.values(), sep=" | ", flush=True)
            rows.append(row)
            if options.store:
                store(row)
    good = {"kept", "no such file", "not tried"}
    sys.exit(any(cell not in good for row in rows for cell in list(row.values())[1:]))


if __name__ == "__main__":
    main()
