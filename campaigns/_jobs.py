"""Every command of the program as a job for other campaigns: what is typed, what is there before, what it writes."""

import csv
import shutil
from collections.abc import Collection
from dataclasses import dataclass, replace
from pathlib import Path

from _program import Forked, recorded
from _terminal import Running

IDENTIFY = "--parameters water.normal_drag --robot mamba --measured forward_velocity=0.004 --threads 1 --output out"
OPERATION = """
kind = "trial"
name = "run"
duration = 1.0
supply_voltage = 35.0
rate = 20
countdown = 0.1
gait = {amplitude_deg = 20, frequency_deg_s = 90, phase_shift_deg = 40}
tank = {volume_x = [-1, 11]}
calibration = {joint_zeros = true, idle_time = 0.3, still_time = 0.3}
limits = {max_lateness = 9, joint_timeout = 9, heartbeat_timeout = 9, mocap_timeout = 9, straighten_time = 0.5}
acceptance = {longest_silence = 9, missing_in_run = 0.9}
"""


@dataclass(frozen=True, kw_only=True)
class Job:
    """A command with all that it needs."""

    words: str
    """What is typed, in a folder that `prepare` has filled."""
    files: tuple[str, ...] = ()
    """What it writes in the folder `out`, where older files of these names are replaced."""
    goes_on: str = ""
    """The folder in `out` in which it goes on if it was stopped; "": it begins anew."""
    is_cut: bool = False
    """Whether it is run cut down."""
    is_server: bool = False
    """Whether it runs until Ctrl-C."""

    def fork(self, folder: Path, *, is_cut: bool = False, is_bound: bool = False) -> Forked:
        """Run it as a fork."""
        return Forked(self.words, folder, is_cut=is_cut or self.is_cut, is_bound=is_bound)

    def start(self, folder: Path) -> Running:
        """Run it in a terminal."""
        return Running(self.words, folder, is_cut=self.is_cut)


def _converted(ending: str) -> Job:
    return Job(words=f"trial convert run.nc out/new.{ending}", files=(f"new.{ending}",))


WRITERS: dict[str, Job] = {
    "swim": Job(
        words="swim --duration 1 --save out/run.nc --plot out/run.pdf --save-scenario out/run.toml",
        files=("run.nc", "run.pdf", "run.toml"),
    ),
    "swim, a film": Job(words="swim --duration 1 --video out/run.mp4", files=("run.mp4",)),
    "follow": Job(
        words="follow --duration 2 --save out/run.nc --plot out/run.png",
        files=("run.nc", "run.png"),
    ),
    "reproduce": Job(
        words="reproduce --only efficiency --workers 2 --output out",
        is_cut=True,
        files=("report.html", "table1.csv"),
    ),
    "sweep": Job(
        words="sweep --vary amplitude-deg=20:60:300 --duration 2 --output out/sweep",
        goes_on="sweep",
    ),
    "optimize": Job(
        words="optimize --vary amplitude-deg=20:30 --duration 5 --frequency-deg-s 110 --budget 300 --seed 3 "
        "--output out/optimum",
        files=("optimum/front.csv", "optimum/front.nc", "optimum/front.png"),
        goes_on="optimum",
    ),
    "identify": Job(
        words=f"identify run-0.nc run-1.nc run-2.nc --starts 1 {IDENTIFY}",
        files=("parameters.toml", "fit.json", "identify.html", "parity.png"),
    ),
    "design-experiment": Job(
        words="design-experiment --parameters water.normal_drag --sensors speed --trials 1 --output out/plan.png",
        files=("plan.png",),
    ),
    "view, a picture": Job(
        words="view run.nc --still out/run.png --size 64 64", files=("run.png",)
    ),
    "view, a film": Job(
        words="view run.nc --video out/run.mp4 --size 64 64 --fps 5 --to 0.4", files=("run.mp4",)
    ),
    "export mjcf": Job(words="export mjcf --output out/robot.xml", files=("robot.xml",)),
    "export urdf": Job(words="export urdf --output out/robot.urdf", files=("robot.urdf",)),
    "export fmu": Job(words="export fmu --output out/robot.fmu", files=("robot.fmu",)),
    "export c": Job(words="export c --output out/robot.h", files=("robot.h",)),
    "export web": Job(words="export web --output out", files=("index.html",)),
    "lab": Job(words="lab --duration 1 --port 0 --save out/run.nc", files=("run.nc",)),
    "operate": Job(
        words="operate operation.toml --no-dashboard --output out", files=("run.nc",), is_cut=True
    ),
    "replay": Job(words="replay run.mcap --save out/run.nc", files=("run.nc",)),
    "trial plot": Job(
        words="trial plot run.nc run-0.nc --output out/plot.svg", files=("plot.svg",)
    ),
    **{
        f"trial convert, {ending}": _converted(ending)
        for ending in ("nc", "csv", "mat", "mcap", "parquet")
    },
}
"""The commands that write, in every way in which they do."""
OTHERS: dict[str, Job] = {
    "cockpit": Job(words="cockpit --port 0", is_server=True),
    "serve": Job(words="serve --port 0", is_server=True),
    "robots": Job(words="robots mamba --toml"),
    "trial show": Job(words="trial show run.nc"),
    "trial compare": Job(words="trial compare run-0.nc run-1.nc"),
}
"""The others."""
JOBS = WRITERS | OTHERS


def prepare(folder: Path) -> None:
    """Make what the commands read: trials, a recording, and what is to be operated."""
    import laticauda as lc

    gait = lc.lateral_undulation(amplitude=0.5, frequency=2.3, phase_shift=0.7)
    recorded(folder, 3.0)
    lc.swim("mamba", gait, 4.0).save(folder / "run.nc")
    for k in range(3):
        lc.swim("mamba", replace(gait, amplitude=0.4 + 0.1 * k), 4.0).save(folder / f"run-{k}.nc")
    (folder / "operation.toml").write_text(OPERATION)
    for job in JOBS.values():
        if job.goes_on:
            (folder / "out").mkdir(exist_ok=True)
            assert job.fork(folder, is_cut=True).end()[0] == 0
            (folder / "out").replace(folder / job.goes_on)
    marks = folder / "sweep" / "sweep" / "regions.done"
    marks.write_bytes(marks.read_bytes()[:2].ljust(marks.stat().st_size, b"\0"))


def lay(folder: Path, job: Job) -> dict[str, bytes]:
    """Fill the folder `out` with what a command finds there: older files, and work that it goes on with.

    Args:
        folder: One that `prepare` has filled.
        job: The command.

    Returns:
        What every file holds.
    """
    out = folder / "out"
    shutil.rmtree(out, ignore_errors=True)
    out.mkdir()
    if job.goes_on:
        shutil.copytree(folder / job.goes_on, out, dirs_exist_ok=True)
    for name in (*job.files, "other.txt"):
        (out / name).write_bytes(f"an older {name}".encode() * 50)
    return {
        str(file.relative_to(out)): file.read_bytes() for file in out.rglob("*") if file.is_file()
    }


def harm(out: Path, older: dict[str, bytes], job: Job, *, is_whole: bool) -> str:
    """What is wrong with the files that were there, in words; "" if nothing is.

    Args:
        out: The folder.
        older: What was there.
        job: The command that ran.
        is_whole: Whether all of them have to be the older ones.
    """
    for name, content in older.items():
        if not (out / name).is_file():
            return f"{name} is gone"
        now, is_own = (
            (out / name).read_bytes(),
            bool(job.goes_on) and name.startswith(f"{job.goes_on}/"),
        )
        if now != content and (
            is_whole or not (name in job.files or is_own) or now == content[: len(now)]
        ):
            return f"{name} is another one"
    return ""


@dataclass(frozen=True)
class Answers:
    """The answers of a campaign, a row for each of its jobs, in a table beside it."""

    file: Path
    """The table."""
    columns: tuple[str, ...]
    """Its columns; the first one is the job."""
    jobs: Collection[str]
    """In their order."""

    def read(self) -> dict[str, dict[str, str]]:
        """What is kept, by job."""
        if not self.file.exists():
            return {}
        with self.file.open(newline="") as file:
            return {row[self.columns[0]]: row for row in csv.DictReader(file)}

    def keep(self, *row: object) -> None:
        """Keep an answer beside those of other jobs; None leaves what there was, or "not tried"."""
        kept = self.read()
        before = kept.get(str(row[0]), dict.fromkeys(self.columns, "not tried"))
        new = {
            name: before[name] if one is None else str(one)
            for name, one in zip(self.columns, row, strict=True)
        }
        rows = kept | {str(row[0]): new}
        with self.file.open("w", newline="") as file:
            table = csv.DictWriter(file, self.columns, lineterminator="\n")
            table.writeheader()
            table.writerows(rows[name] for name in self.jobs if name in rows)
