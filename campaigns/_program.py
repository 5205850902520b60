"""The program as a process for other campaigns, a fork of theirs; cut down where its work is long.

    python campaigns/_program.py [--cut] WORDS...

Cut down, `reproduce` repeats a part of the paper with two workers and one figure per study,
`operate` has the virtual tank in its own process, and of `sweep` the regions are smaller;
`recorded SECONDS` is an operation without wires.
"""

import contextlib
import ctypes
import os
import signal
import subprocess
import sys
import tempfile
import time
import traceback
import warnings
from dataclasses import replace
from importlib import import_module
from itertools import islice
from pathlib import Path
from typing import Any

PATIENCE = 300.0  # [s]
SLOWLY = 0.25  # of real time: the computer may be busy
NOT_BEFORE_A_FORK = ("mujoco.", "OpenGL", "__mp_main__")  # what draws is made by each process


class Forked:
    """A program that is a fork of this process, without a terminal; what it imported stays imported here at its end.

    Args:
        words: What is typed.
        folder: Where.
        is_cut: Whether its work is cut down.
        is_bound: Whether rights hold for it, as they do not for root.
    """

    def __init__(
        self, words: str, folder: Path, *, is_cut: bool = False, is_bound: bool = False
    ) -> None:
        self._told, self._modules = tempfile.TemporaryFile(), tempfile.TemporaryFile("w+")
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DeprecationWarning)  # of threads, which no child misses
            self.pid = os.fork()
        if self.pid == 0:
            status = 1
            try:
                self._detach(folder, is_bound=is_bound)
                status = run(words.split(), is_cut=is_cut)
                print(*sys.modules, sep="\n", file=self._modules, flush=True)
            except BaseException:
                traceback.print_exc()
            finally:
                sys.stderr.flush()
                os._exit(status)

    def _detach(self, folder: Path, *, is_bound: bool) -> None:
        """Be a process of its own."""
        os.setsid()
        os.chdir(folder)
        for place, number in (
            (os.open(os.devnull, os.O_RDWR), (0, 1)),
            (self._told.fileno(), (2,)),
        ):
            for one in number:
                os.dup2(place, one)
        sys.stdout, sys.stderr = (
            os.fdopen(number, "w", buffering=1, closefd=False) for number in (1, 2)
        )
        if (
            is_bound
        ):  # all capabilities are given up; those to write anywhere are lost to its children, too
            system = ctypes.CDLL(None)
            for override in (1, 2):
                system.prctl(24, override, 0, 0, 0)
            system.capset((ctypes.c_uint32 * 2)(0x20080522, 0), (ctypes.c_uint32 * 6)())

    def kill(self) -> None:
        """Kill it, and it alone."""
        os.kill(self.pid, signal.SIGKILL)

    def end(self) -> tuple[int, str]:
        """Wait for its end; returns its status, and what stands on standard error."""
        status = os.waitstatus_to_exitcode(os.waitpid(self.pid, 0)[1])
        with self._told as told, self._modules as modules:
            modules.seek(0)
            for name in modules.read().split():
                if name not in sys.modules and not name.startswith(NOT_BEFORE_A_FORK):
                    with contextlib.suppress(Exception):
                        import_module(name)
            told.seek(0)
            return status, told.read().decode(errors="replace")

    def left_over(self) -> int:
        """How many processes are left of it when it has ended."""
        return left_over_of(self.pid)


def left_over_of(session: int) -> int:
    """How many processes there are in a session, after some time to end; those that nobody waits for do not count."""
    n, until = 1, time.monotonic() + 10.0
    while n and time.monotonic() < until:
        listed = subprocess.run(
            ["ps", "-o", "stat=", "-s", str(session)], capture_output=True, text=True
        ).stdout
        n = sum(not state.startswith("Z") for state in listed.split())
        time.sleep(0.05 if n else 0.0)
    return n


# ---- the program ---------------------------------------------------------------------------------


def recorded(folder: Path, duration: float) -> None:
    """Operate a robot in the virtual tank, without wires and bit for bit repeatable: ``run.mcap`` and ``run.nc``."""
    import laticauda as lc
    from laticauda.tank.lab import LabSettings, NodeSettings, Tank, VirtualRobot
    from laticauda.tank.operate.session import operate
    from laticauda.tank.operate.settings import Calibration, CaptureVolume, Connection, Operation

    robot = lc.load_robot("mamba")
    world = VirtualRobot(
        robot, lc.build_plant(robot, lc.load_water("paper-lateral"), joints="servo")
    )
    nodes = NodeSettings(startup_time=0.2, calibration_time=0.2)
    operation = Operation(
        name="run",
        gait=lc.lateral_undulation(amplitude=0.5, frequency=2.3, phase_shift=0.7),
        duration=duration,
        rate=50.0,
        countdown=0.1,
        tank=CaptureVolume(volume_x=(-5.0, 11.0), volume_y=(-5.0, 5.0)),
        connection=Connection(meter_address="stepped"),
        supply_voltage=35.0,
        calibration=Calibration(joint_zeros=True, idle_time=0.5, still_time=0.5),
    )
    operate(operation, folder, tank=Tank(world, LabSettings(seed=1, nodes=nodes)))


def do_part(*args: Any) -> Any:
    """A study of the paper, of which a report shows one figure; workers look it up by this name."""
    module: Any = import_module("laticauda.paper.report.reproduce")

    def shortened(chapter: Any) -> Any:
        def short(*args: Any, **more: Any) -> Any:
            whole = chapter(*args, **more)
            return replace(whole, n_figures=1, figures=lambda: islice(whole.figures(), 1))

        return short

    module.CHAPTERS = {
        name: chapter._replace(build=shortened(chapter.build))
        for name, chapter in module.CHAPTERS.items()
    }
    return getattr(module, "_run_whole_study", module._run_study)(*args)


def _cut_reproduce() -> None:
    module: Any = import_module("laticauda.paper.report.reproduce")
    whole = module.plan_experiments()
    sweeps = tuple(replace(sweep, step=20 * sweep.step) for sweep in whole.efficiency.sweeps)
    small = replace(
        whole,
        efficiency=replace(whole.efficiency, sweeps=sweeps, models=whole.efficiency.models[:1]),
        side=replace(whole.side, phase_shifts=sweeps[2], duration=10.0),
    )
    module.plan_experiments = lambda parameters: small
    # A worker's module has only its own.
    module._run_whole_study = module._run_study
    module._run_study = do_part


def _operate(words: list[str]) -> int:
    import laticauda as lc
    from laticauda import cli
    from laticauda.tank.lab import Lab, LabSettings, NodeSettings, Tank, VirtualRobot
    from laticauda.tank.protocol import bus_address

    robot = lc.load_robot("mamba")
    world = VirtualRobot(
        robot, lc.build_plant(robot, lc.load_water("paper-lateral"), joints="servo")
    )
    settings = LabSettings(seed=2, nodes=NodeSettings(startup_time=0.1, calibration_time=0.1))
    with Lab(Tank(world, settings), bus=bus_address("virtual:kept"), port=0, speed=SLOWLY) as at:
        print("begun", flush=True)
        where = f"--bus virtual:kept --mocap {at.mocap_host}:{at.mocap_port} --meter {at.meter} --speed {SLOWLY}"
        return cli.main([*words, *where.split()])


def run(words: list[str], *, is_cut: bool) -> int:
    """Say that it has begun, and be the program; returns its exit status."""
    from laticauda import cli

    if words[0] == "recorded":
        recorded(Path("out"), float(words[1]))
        return 0
    if is_cut and words[0] == "operate":
        return _operate(words)
    if is_cut and words[0] == "reproduce":
        _cut_reproduce()
    if is_cut and words[0] == "sweep":
        import_module("laticauda.studies.sweep").REGION_TIME = 0.001  # type: ignore[attr-defined]
    print("begun", flush=True)
    sys.argv = ["laticauda", *words]
    return cli.main()


if __name__ == "__main__":
    given = sys.argv[1:]
    sys.exit(run(given[given[0] == "--cut" :], is_cut=given[0] == "--cut"))
