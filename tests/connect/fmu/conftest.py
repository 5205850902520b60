"""FMUs, and hands that move them: FMPy's binding, with every status and every message kept."""

import logging
import math
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest

import laticauda as lc
from laticauda.connect import export_fmu

fmpy = pytest.importorskip("fmpy", exc_type=ImportError)
fmi2 = pytest.importorskip("fmpy.fmi2", exc_type=ImportError)

GAIT = lc.lateral_undulation(
    amplitude=math.radians(30), frequency=math.radians(130), phase_shift=math.radians(40)
)


class Slave:
    """One instance of an FMU, by the functions of FMI 2.0 and nothing above them."""

    def __init__(self, folder: str, *, guid: str | None = None) -> None:
        told = fmpy.read_model_description(folder)
        self.number = {v.name: v.valueReference for v in told.modelVariables}
        self.messages: list[str] = []
        callbacks = fmi2.fmi2CallbackFunctions()
        callbacks.logger = fmi2.fmi2CallbackLoggerTYPE(
            lambda _, name, status, category, message: self.messages.append(message.decode())
        )
        callbacks.allocateMemory = fmi2.fmi2CallbackAllocateMemoryTYPE(fmi2.calloc)
        callbacks.freeMemory = fmi2.fmi2CallbackFreeMemoryTYPE(fmi2.free)
        self._callbacks = callbacks
        self.fmu: Any = fmi2.FMU2Slave(
            guid=guid or told.guid,
            unzipDirectory=folder,
            modelIdentifier=told.coSimulation.modelIdentifier,
            instanceName="snake",
        )
        self.fmu.instantiate(callbacks=callbacks)

    def begin(self, *, start_time: float = 0.0, **values: float) -> "Slave":
        self.fmu.setupExperiment(startTime=start_time)
        self.set(**values)
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()
        return self

    def set(self, **values: float) -> None:
        """Names with two underscores for the dot."""
        for name, value in values.items():
            self.put(name.replace("__", "."), value)

    def put(self, name: str, value: float) -> None:
        self.fmu.setReal([self.number[name]], [value])

    def get(self, *names: str) -> np.ndarray:
        return np.array(self.fmu.getReal([self.number[name] for name in names]))

    def all(self, stem: str) -> np.ndarray:
        return self.get(
            *(
                name
                for name in self.number
                if name.startswith(f"{stem}[") or name.startswith(f"{stem}.")
            )
        )

    def everything(self) -> bytes:
        return self.get(*self.number).tobytes()

    def steps(self, intervals: Sequence[float], *, time: float = 0.0) -> None:
        for interval in intervals:
            self.fmu.doStep(time, interval)
            time += interval

    def close(self) -> None:
        self.fmu.freeInstance()


class Fmu(NamedTuple):
    file: Path
    folder: str
    """Where it is unpacked."""
    variables: tuple[Any, ...]


@pytest.fixture(scope="session")
def make(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., Fmu]:
    """Export a robot and unpack it; the same one once per session."""
    made: dict[str, Fmu] = {}

    def make(robot: Any = "mamba-fin", gait: Any = GAIT, **settings: Any) -> Fmu:
        key = repr((robot, gait, settings))
        if key not in made:
            folder = tmp_path_factory.mktemp("fmu")
            body = lc.load_robot(robot) if isinstance(robot, str) else robot
            variables = export_fmu(folder / "snake.fmu", body, gait, **settings)
            unpacked = folder / "unpacked"
            fmpy.extract(str(folder / "snake.fmu"), str(unpacked))
            made[key] = Fmu(folder / "snake.fmu", str(unpacked), variables)
        return made[key]

    return make


@pytest.fixture
def slave() -> Iterator[Callable[..., Slave]]:
    logging.getLogger("fmpy").setLevel(logging.CRITICAL)
    slaves: list[Slave] = []

    def open_slave(fmu: Fmu, **options: Any) -> Slave:
        slaves.append(Slave(fmu.folder, **options))
        return slaves[-1]

    yield open_slave
    for one in slaves:
        one.close()
