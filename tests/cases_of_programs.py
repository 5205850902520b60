"""Cases from the field about programs of others that laticauda meets: FMUs, Gymnasium, PettingZoo, CAN, ROS 2.

Each has its source in tests/cases.
"""

import math
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
from mamba_dbc import FILE
from scipy.spatial.transform import Rotation

import laticauda as lc
from laticauda.connect import export_fmu
from laticauda.trials.logs import write_bag

GAIT = lc.lateral_undulation(amplitude=0.5, frequency=2.3, phase_shift=0.7)
PATH_FOLLOWING = "laticauda_gym:laticauda/PathFollowing-v0"


# ---- FMUs ----------------------------------------------------------------------------------------


class Instance:
    """An FMU of FMI 2.0, begun."""

    def __init__(self, file: Path, *, start_time: float = 0.0, **parameters: float) -> None:
        fmpy = pytest.importorskip("fmpy", exc_type=ImportError)
        from fmpy.fmi2 import FMU2Slave

        description = fmpy.read_model_description(str(file))
        self.numbers = {one.name: one.valueReference for one in description.modelVariables}
        self.outputs = [one.name for one in description.modelVariables if one.causality == "output"]
        folder = file.with_suffix("")
        if not folder.exists():  # not over a library that runs
            fmpy.extract(str(file), str(folder))
        self.fmu: Any = FMU2Slave(
            guid=description.guid,
            unzipDirectory=str(folder),
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName="a",
        )
        self.fmu.instantiate()
        self.start_time = start_time
        self.begin(**parameters)

    def begin(self, **parameters: float) -> None:
        self.fmu.setupExperiment(startTime=self.start_time)
        self.set(**parameters)
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()
        self.time = self.start_time

    def set(self, **values: float) -> None:
        self.fmu.setReal([self.numbers[name] for name in values], list(values.values()))

    def set_references(self, size: float) -> None:
        names = [name for name in self.numbers if name.startswith("references[")]
        for k, name in enumerate(names):
            self.fmu.setReal([self.numbers[name]], [size * (-1) ** k])

    def steps(self, *intervals: float) -> None:
        for interval in intervals:
            self.fmu.doStep(self.time, interval)
            self.time += interval

    def get(self, *names: str) -> np.ndarray:
        return np.array(self.fmu.getReal([self.numbers[name] for name in names]))

    def outputs_but_time(self) -> np.ndarray:
        return self.get(*(name for name in self.outputs if name != "time"))


def case_g09_fmu_step_input_work(folder):
    """At every time step that a user may choose, from the default on."""
    file = folder / "m2.fmu"
    export_fmu(file, lc.load_robot("mamba"), GAIT, joints="servo", inputs="references")
    right = (0.0696, 0.3369, 0.2032)
    for parameters in ({}, {"dt": 1e-3}, {"dt": 2e-4}):
        one = Instance(file, **parameters)
        one.set_references(0.3)
        one.steps(1.0)
        found = one.get("net_work", "mechanical_work", "positive_work")
        assert found == pytest.approx(right, rel=0.01)


def case_p17_fmu(folder):
    fmpy = pytest.importorskip("fmpy", exc_type=ImportError)
    from fmpy.validation import validate_fmu

    for version in ("2.0", "3.0"):
        file = folder / f"m{version[0]}.fmu"
        export_fmu(file, lc.load_robot("mamba"), GAIT, fmi=version)
        assert validate_fmu(str(file)) == []
        assert fmpy.read_model_description(str(file)).fmiVersion == version
    ends: list[np.ndarray] = []
    for start_time in (0.0, 10.0):
        one = Instance(folder / "m2.fmu", start_time=start_time)
        one.steps(*[0.05] * 20)
        ends.append(one.outputs_but_time())
    np.testing.assert_allclose(ends[0], ends[1], atol=1e-12)


def case_q27_fmu_state_and_steps(folder):
    file = folder / "m2.fmu"
    export_fmu(file, lc.load_robot("mamba"), GAIT)
    one, other = Instance(file, dt=1e-3), Instance(file, dt=1e-3)
    one.steps(0.5)
    state = one.fmu.getFMUstate()
    one.steps(0.5)
    end = one.outputs_but_time()
    one.fmu.setFMUstate(state)  # rollback
    one.time = 0.5
    one.steps(0.5)
    assert one.outputs_but_time().tobytes() == end.tobytes()
    one.fmu.freeFMUstate(state)
    other.steps(*[0.01] * 100)
    np.testing.assert_allclose(other.outputs_but_time(), end, atol=1e-10)
    one.fmu.reset()
    one.begin(dt=1e-3)
    one.steps(1.0)
    np.testing.assert_allclose(one.outputs_but_time(), end, atol=1e-12)
    bad: list[Callable[[], Any]] = [
        lambda: one.set(**{"gait.amplitude": math.nan}),
        lambda: one.set(**{"water.density": 900.0}),
        lambda: one.set(time=1.0),
        lambda: one.steps(0.0),
        lambda: one.steps(-0.1),
        lambda: one.fmu.doStep(0.3, 0.1),
    ]
    for act in bad:
        with pytest.raises(Exception, match="failed with status 3"):
            act()
    np.testing.assert_allclose(one.outputs_but_time(), end, atol=1e-12)


# ---- environments to learn in --------------------------------------------------------------------


def swims_of(gymnasium: Any, count: int, **settings: Any) -> list[np.ndarray]:
    """What some lanes of an environment say in some steps."""
    envs = gymnasium.make_vec(PATH_FOLLOWING, num_envs=3, **settings)
    said = [envs.reset(seed=5)[0]]
    actions = np.random.default_rng(0).uniform(-1.0, 1.0, (count, *envs.action_space.shape))
    for action in actions:
        said += envs.step(action)[:2]
    envs.close()
    return said


def case_p11_vector_seeds(_):
    gymnasium = pytest.importorskip("gymnasium")
    pytest.importorskip("laticauda_gym")
    ways = [
        swims_of(gymnasium, 4, vectorization_mode="sync"),
        swims_of(gymnasium, 4, vectorization_mode="sync"),
        swims_of(gymnasium, 4, vectorization_mode="async", vector_kwargs={"context": "forkserver"}),
    ]
    for way in ways[1:]:
        for one, other in zip(ways[0], way, strict=True):
            np.testing.assert_array_equal(one, other)


def case_q24_pettingzoo(_):
    pytest.importorskip("pettingzoo")
    pytest.importorskip("laticauda_gym")
    from pettingzoo.test import api_test, parallel_api_test, parallel_seed_test, seed_test
    from pettingzoo.utils import parallel_to_aec

    from laticauda_gym import SwimmingParallelEnv

    def school() -> Any:
        return SwimmingParallelEnv(2, robot="mamba", duration=0.8)

    def turns() -> Any:
        return parallel_to_aec(school())

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of the tests themselves
        parallel_api_test(school(), num_cycles=6)
        parallel_seed_test(school, num_cycles=4)
        api_test(turns(), num_cycles=6)
        seed_test(turns, num_cycles=4)
    env = school()
    env.reset(seed=1)
    action = np.zeros(env.action_space("robot_0").shape)
    with pytest.raises(ValueError, match="robot_1"):
        env.step({"robot_0": action})
    with pytest.raises(ValueError, match="finite"):
        env.step({"robot_0": action, "robot_1": action * math.nan})


def case_q25_gym_vector(_):
    gymnasium = pytest.importorskip("gymnasium")
    pytest.importorskip("laticauda_gym")
    from gymnasium.wrappers.vector import NormalizeObservation, RecordEpisodeStatistics

    single = swims_of(gymnasium, 30, vectorization_mode="sync")
    for one, other in zip(swims_of(gymnasium, 30), single, strict=True):
        np.testing.assert_array_equal(one, other)
    bare = gymnasium.make_vec(PATH_FOLLOWING, num_envs=3, duration=2.0)
    envs = NormalizeObservation(RecordEpisodeStatistics(bare))
    envs.reset(seed=1)
    lengths: list[int] = []
    for _ in range(40):
        _, _, _, _, info = envs.step(np.zeros(envs.action_space.shape))
        if "episode" in info:
            lengths += info["episode"]["l"][info["_episode"]].tolist()
    assert lengths == [10] * 9


# ---- CAN and ROS 2 -------------------------------------------------------------------------------


def case_p18_dbc_limits(_):
    cantools = pytest.importorskip("cantools")
    messages = cantools.database.load_file(str(FILE)).messages
    assert len(messages) == 103
    for message in messages:
        for pick in (min, max):
            values: dict[str, float] = {}
            for signal in message.signals:
                raw = {min: 0, max: 2**signal.length - 1}[pick]
                if signal.is_signed:
                    bound = 2 ** (signal.length - 1)
                    raw = {min: -bound, max: bound - 1}[pick]
                values[signal.name] = raw * signal.scale + signal.offset
            data = message.encode(values, strict=True)
            back = message.decode(data, decode_choices=False)
            assert back == pytest.approx(values, rel=1e-12)


def pose(translation: Any, rotation: Any) -> np.ndarray:
    matrix = np.eye(4)
    matrix[:3, :3] = rotation.as_matrix()
    matrix[:3, 3] = translation
    return matrix


def numbers(text: str) -> list[float]:
    return [float(word) for word in text.split()]


def pose_of_joint(joint: Any, angle: float) -> np.ndarray:
    """Pose of a joint's child in its parent, by the URDF."""
    origin = joint.find("origin")
    turn = Rotation.from_euler("xyz", numbers(origin.get("rpy", "0 0 0")))
    axis = np.array(numbers(joint.find("axis").get("xyz")))
    return pose(numbers(origin.get("xyz")), turn * Rotation.from_rotvec(angle * axis))


def case_q26_rosbag2(folder):
    pytest.importorskip("mcap")
    pytest.importorskip("rosbags")
    from rosbags.highlevel import AnyReader
    from rosbags.typesys import Stores, get_typestore

    write_bag(lc.swim("mamba", GAIT, 0.5), folder / "bag")
    counts: list[int] = []
    stores = (Stores.ROS2_FOXY, Stores.ROS2_HUMBLE, Stores.ROS2_IRON, Stores.ROS2_JAZZY)
    for store in stores:
        found: dict[str, list[Any]] = {}
        with AnyReader([folder / "bag"], default_typestore=get_typestore(store)) as reader:
            for connection, time, raw in reader.messages():
                message = reader.deserialize(raw, connection.msgtype)
                found.setdefault(connection.topic, []).append((time, message))
            counts.append(reader.message_count)
        urdf = ElementTree.fromstring(found["/robot_description"][0][1].data)
        joints = {joint.get("name"): joint for joint in urdf.findall("joint")}
        for (time, states), (same_time, frames) in zip(
            found["/joint_states"], found["/tf"], strict=True
        ):
            assert time == same_time
            seen = {one.child_frame_id: one for one in frames.transforms}
            for name, angle in zip(states.name, states.position, strict=True):
                child = joints[name].find("child").get("link")
                transform = seen[child].transform
                t, q = transform.translation, transform.rotation
                told = pose((t.x, t.y, t.z), Rotation.from_quat((q.x, q.y, q.z, q.w)))
                assert seen[child].header.frame_id == joints[name].find("parent").get("link")
                np.testing.assert_allclose(told, pose_of_joint(joints[name], angle), atol=1e-15)
    assert counts == [counts[0]] * 4 and counts[0] > 100


PROGRAMS: dict[str, Callable[..., None]] = {
    name: value for name, value in globals().items() if name.startswith("case_")
}
