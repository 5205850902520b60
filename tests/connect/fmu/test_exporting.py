"""FMUs as FMPy reads, validates and runs them, beside the same runs in Python."""

import importlib.util
import math
import shutil
import struct
import subprocess
import sys
import zipfile
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import laticauda as lc
from laticauda.connect import export_fmu
from laticauda.connect.native.variables import list_variables
from laticauda.models.simulate import build_plant
from laticauda.robot import Joint, Robot
from laticauda.scenarios.interfaces import Command, Start
from laticauda.values.errors import MissingProgram
from laticauda.water.fluid.laws import PolynomialDrag, TotalSpeedDrag

fmpy = pytest.importorskip("fmpy", exc_type=ImportError)

GAIT = lc.lateral_undulation(
    amplitude=math.radians(30), frequency=math.radians(130), phase_shift=math.radians(40)
)
EEL = lc.eel_like(
    amplitude=math.radians(35),
    frequency=math.radians(110),
    phase_shift=math.radians(35),
    offset=0.05,
)
LEADS = (0.3, -0.2, 0.1, 0.0, 0.0, 0.2, -0.1, 0.4)
GUSTS = replace(lc.load_current("turbulence"), modes=6)
# What Python's fused multiply-adds and the FMU's lack of them make of rounding in some seconds.
ROUNDING = 1e-9


def driven_fin() -> tuple[Robot, lc.Gait]:
    robot = lc.load_robot("mamba-fin")
    assert robot.caudal_fin is not None
    fin = replace(robot.caudal_fin, joint=Joint())
    return replace(robot, caudal_fin=fin), replace(
        GAIT, fin=lc.Wave(amplitude=0.3, frequency=3.0, phase=0.5)
    )


def bent_fin() -> Robot:
    robot = lc.load_robot("mamba-fin")
    assert robot.caudal_fin is not None
    return replace(
        robot,
        caudal_fin=replace(
            robot.caudal_fin, n_hinges=2, flexural_rigidity=0.05, bending_damping=0.002
        ),
    )


def lazy() -> Robot:
    """Its prescribed joints do 80 % of the gait's oscillation."""
    robot = lc.load_robot("mamba")
    actuator = replace(robot.joints[0].actuator, tracking=0.8)
    return replace(robot, joints=tuple(replace(joint, actuator=actuator) for joint in robot.joints))


KINDS: dict[str, dict[str, Any]] = {
    "prescribed": {},
    "pd": {"joints": "pd", "robot": "mamba", "gait": EEL},
    "servo": {"joints": "servo", "robot": "mamba-modules-fin"},
    "references": {"joints": "servo", "inputs": "references"},
    "fin reference": {"robot": driven_fin()[0], "joints": "pd", "inputs": "references"},
    "driven fin": dict(zip(("robot", "gait"), driven_fin(), strict=True)),
    "leading joints": {"robot": "mamba", "gait": replace(EEL, phases=LEADS)},
    "bent fin": {"robot": bent_fin()},
    "tracking": {"robot": lazy(), "gait": EEL},
    "kirchhoff": {
        "gait": EEL,
        "environment": replace(
            lc.load_water("paper-eel"),
            added_mass_form="kirchhoff",
            rotational="strip",
            trailing_edge="elongated",
        ),
    },
    "finite span": {
        "joints": "servo",
        "environment": replace(
            lc.load_water("paper-lateral"),
            added_mass_form="kirchhoff",
            trailing_edge="finite-span",
        ),
    },
    "gusts": {
        "environment": replace(lc.load_water("paper-lateral"), current=replace(GUSTS, seed=2))
    },
    "late start": {
        "start": Start(center_of_mass=(1.0, -2.0), heading=0.7, velocity=0.1),
        "robot": "mamba",
    },
}


def in_python(robot: Any = "mamba-fin", gait: Any = GAIT, **settings: Any) -> tuple[Any, Any, Any]:
    """The plant behind an FMU, its command and its first state."""
    inputs, start = settings.pop("inputs", "gait"), settings.pop("start", Start())
    usual = lc.load_water("paper-eel" if gait.kind == "eel_like" else "paper-lateral")
    water = settings.pop("environment", usual)
    body = build_plant(lc.load_robot(robot) if isinstance(robot, str) else robot, water, **settings)
    command = Command(
        gait=gait,
        references=(0.0,) * len(body.robot.driven_joints) if inputs == "references" else None,
    )
    return body, command, body.init(start, command)


def check_equal(slave: Any, body: Any, state: Any, log: Any, tolerance: float = ROUNDING) -> None:
    check_motion(slave, body, state, log, tolerance)
    work = slave.get("mechanical_work", "net_work", "positive_work")
    assert work == pytest.approx(log.work[-1], abs=100 * tolerance)
    if log.electrical_work is not None:
        assert slave.get("electrical_work") == pytest.approx(
            log.electrical_work[-1], abs=100 * tolerance
        )


def check_motion(slave: Any, body: Any, state: Any, log: Any, tolerance: float = ROUNDING) -> None:
    seen = body.observe(state)
    assert slave.get("time") == pytest.approx(seen.time, abs=1e-12)
    for name in (
        "center_of_mass",
        "center_of_mass_velocity",
        "link_angle",
        "joint_angle",
        "joint_rate",
    ):
        assert slave.all(name) == pytest.approx(getattr(seen, name), abs=tolerance), name
    assert slave.get("heading", "heading_rate") == pytest.approx(
        [seen.heading, seen.heading_rate], abs=tolerance
    )
    for name in ("joint_torque", "joint_angle_ref"):
        assert slave.all(name) == pytest.approx(getattr(log, name)[-1], abs=10 * tolerance), name
    for name in [key for key in log.signals if key.startswith("fin_angle") and key[-1].isdigit()]:
        k = name.rsplit("_", 1)[-1]
        assert slave.get(f"fin_angle[{k}]") == pytest.approx(log.signals[name][-1], abs=tolerance)


@pytest.mark.parametrize("fmi", ["2.0", "3.0"])
@pytest.mark.parametrize("kind", KINDS)
def test_the_validator_finds_nothing(make, kind, fmi):
    from fmpy.validation import validate_fmu

    file = make(**KINDS[kind], fmi=fmi).file
    assert validate_fmu(str(file)) == []
    assert fmpy.read_model_description(str(file)).fmiVersion == fmi


@pytest.mark.parametrize("fmi", ["2.0", "3.0"])
@pytest.mark.parametrize("joints", ["prescribed", "servo"])
def test_30_s_in_fmpy_are_those_of_a_swim(make, joints, fmi):
    file = make(joints=joints, fmi=fmi).file
    seen = fmpy.simulate_fmu(str(file), stop_time=30.0, step_size=0.05, output_interval=0.05)
    trial = lc.swim(lc.load_robot("mamba-fin"), GAIT, 30.0, joints=joints, sample_interval=0.05)
    assert seen["time"] == pytest.approx(trial.time, abs=1e-9)

    def columns(stem: str, parts: Any) -> np.ndarray:
        return np.column_stack([seen[f"{stem}{part}"] for part in parts])

    joints_of, links = [f"[{i}]" for i in range(8)], [f"[{i}]" for i in range(9)]
    for name, parts in (
        ("center_of_mass", (".x", ".y")),
        ("center_of_mass_velocity", (".x", ".y")),
        ("link_angle", links),
        ("joint_angle", joints_of),
        ("joint_angle_ref", joints_of),
        ("joint_torque", joints_of),
    ):
        assert columns(name, parts) == pytest.approx(getattr(trial, name), abs=1e-8), name
    assert columns("", ("mechanical_work", "net_work", "positive_work")) == pytest.approx(
        trial.work, abs=1e-6
    )
    power = np.sum(np.abs(trial.joint_torque * trial.joint_rate), axis=1)
    assert seen["mechanical_power"] == pytest.approx(power, abs=1e-7)


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_of_robot_and_drive_moves_as_in_python_from_the_first_moment(make, slave, kind):
    body, command, state = in_python(**KINDS[kind])
    one = slave(make(**KINDS[kind])).begin()
    log = body.march(state, command, 1e-6, 1e-6)[1]
    check_equal(one, body, state, log.at(slice(1)))
    for k, interval in enumerate((0.05, 0.02, 0.113, 0.05, 0.3, 0.01)):
        state, log, _ = body.march(state, command, interval, interval)
        one.steps([interval], time=sum((0.05, 0.02, 0.113, 0.05, 0.3)[:k]))
        check_equal(one, body, state, log)


def test_inputs_that_change_act_as_a_command_that_changes(make, slave):
    one = slave(make()).begin()
    water = lc.load_water("paper-lateral")
    body, _, state = in_python()
    for k in range(60):
        gait = replace(
            GAIT,
            amplitude=0.4 + 0.003 * k,
            frequency=2.0 + 0.02 * k,
            offset=0.1 * math.sin(0.2 * k),
        )
        current = (0.05 * math.sin(0.1 * k), -0.002 * k)
        one.set(
            gait__amplitude=gait.amplitude, gait__frequency=gait.frequency, gait__offset=gait.offset
        )
        one.set(current__x=current[0], current__y=current[1])
        moved = build_plant(body.robot, replace(water, current=current), dt=body.dt)
        state, log, _ = moved.march(state, Command(gait=gait), 0.05, 0.05)
        one.steps([0.05], time=0.05 * k)
    check_equal(one, body, state, log)


def test_a_driven_fins_reference_acts_as_one_more_does_in_python(make, slave):
    one = slave(make(**KINDS["fin reference"])).begin()
    body, command, state = in_python(**KINDS["fin reference"])
    for k, angle in enumerate((0.2, 0.3, 0.4)):
        one.put("fin.reference", angle)
        one.steps([0.05], time=0.05 * k)
        state, log, _ = body.march(
            state, replace(command, references=(0.0,) * 8 + (angle,)), 0.05, 0.05
        )
        check_motion(one, body, state, log)
    assert one.get("fin_angle[0]").item() > 0.01


def test_references_that_change_act_as_references_in_python(make, slave):
    one = slave(make(**KINDS["references"])).begin()
    body, command, state = in_python(**KINDS["references"])
    for k in range(60):
        asked = tuple(2e-3 * k * math.sin(0.1 * k + 0.7 * i) for i in range(8))
        for i, angle in enumerate(asked):
            one.put(f"references[{i}]", angle)
        state, log, _ = body.march(state, replace(command, references=asked), 0.05, 0.05)
        one.steps([0.05], time=0.05 * k)
    check_equal(one, body, state, log)


@pytest.mark.parametrize("jump", [0.03, 0.05, 0.1, 0.3, 0.6])
@pytest.mark.parametrize("kind", ["references", "fin reference"])
def test_works_after_jumps_are_those_of_small_steps_and_the_motion_is_as_in_python(
    make, slave, kind, jump
):
    one = slave(make(**KINDS[kind])).begin()
    body, command, state = in_python(**KINDS[kind])
    fine, _, exact = in_python(**KINDS[kind], dt=2e-5)
    n_joints = len(body.robot.driven_joints)
    names = [name for name in one.number if name.startswith(("references[", "fin.reference"))]
    assert len(names) == n_joints
    for k in range(3):
        asked = tuple(jump * (-1) ** (i + k) for i in range(n_joints))
        for name, angle in zip(names, asked, strict=True):
            one.put(name, angle)
        wanted = replace(command, references=asked)
        state, log, _ = body.march(state, wanted, 0.1, 0.1)
        exact, right, _ = fine.march(exact, wanted, 0.1, 0.1)
        one.steps([0.1], time=0.1 * k)
        check_motion(one, body, state, log)
        work = one.get("mechanical_work", "net_work", "positive_work")
        assert work == pytest.approx(right.work[-1], abs=0.01 * right.work[-1, 0])


@pytest.mark.parametrize(
    "kind",
    [
        {},
        {
            "environment": replace(
                lc.load_water("paper-eel"), rotational="strip", added_mass_form="classic"
            )
        },
        {
            "environment": replace(
                lc.load_water("paper-eel"),
                drag=TotalSpeedDrag(),
                rotational="strip",
                added_mass_form="kirchhoff",
                trailing_edge="elongated",
            )
        },
    ],
)
def test_parameters_make_of_an_fmu_that_of_another_water_gait_and_start(make, slave, kind):
    water = kind.get("environment", lc.load_water("paper-lateral"))
    polynomial = isinstance(water.drag, PolynomialDrag)
    law = (
        {"reference_speed": 0.8, "sway_friction": 0.3}
        if polynomial
        else {"beta": 0.2, "gamma": 0.7}
    )
    other = replace(
        water,
        density=1025.0,
        tangential_friction=0.21,
        normal_drag=1.3,
        added_mass=0.9,
        added_inertia=0.5,
        tangential_added_mass=0.1,
        drag=replace(water.drag, **law),
        current=(0.02, -0.03),
    )
    gait = lc.custom_gait(
        envelope=[0.2 + 0.1 * i for i in range(8)],
        amplitude=0.7,
        frequency=1.7,
        phase_shift=0.5,
        offset=0.1,
    )
    start = Start(center_of_mass=(0.3, -0.4), heading=2.0, velocity=0.05)
    body, command, state = in_python(
        gait=gait, environment=other, start=start, dt=0.02, ramp=2.0, offset_bandwidth=5.0
    )
    one = slave(make(**kind))
    for name in ("density", "tangential_friction", "normal_drag", "added_mass", "added_inertia"):
        one.put(f"water.{name}", getattr(other, name))
    one.put("water.tangential_added_mass", other.tangential_added_mass)
    for name, number in law.items():
        one.put(f"water.drag.{name}", number)
    for name in ("amplitude", "frequency", "phase_shift", "offset"):
        one.put(f"gait.{name}", getattr(gait, name))
    for i in range(8):
        one.put(f"gait.envelope[{i}]", gait.joint_envelope(9)[i])
    one.begin(
        current__x=0.02,
        current__y=-0.03,
        start__x=0.3,
        start__y=-0.4,
        start__heading=2.0,
        start__velocity=0.05,
        dt=0.02,
        ramp=2.0,
        offset_bandwidth=5.0,
    )
    one.steps([0.1] * 50)
    for _ in range(50):
        state, log, _ = body.march(state, command, 0.1, 0.1)
    check_equal(one, body, state, log)


def test_the_joints_of_servos_begin_where_they_are_told(make, slave):
    one = slave(make(**KINDS["references"]))
    one.put("start.joint_angle[2]", 0.3)
    one.begin()
    assert one.get("joint_angle[2]", "joint_angle[3]") == pytest.approx([0.3, 0.0])
    assert one.get("link_angle[3]") - one.get("link_angle[2]") == pytest.approx(0.3)


def test_held_references_come_near_to_a_swim_in_proportion_to_the_communication_step(make, slave):
    robot = lc.load_robot("mamba-fin")
    fmu = make(**KINDS["references"])
    errors: list[float] = []
    for interval in (0.04, 0.02, 0.01):
        trial = lc.swim(robot, GAIT, 4.0, joints="servo", sample_interval=interval)
        one = slave(fmu).begin()
        for k, asked in enumerate(trial.joint_angle_ref[:-1]):
            one.fmu.setReal([one.number[f"references[{i}]"] for i in range(8)], asked.tolist())
            one.steps([interval], time=interval * k)
        errors.append(float(np.linalg.norm(one.all("center_of_mass") - trial.center_of_mass[-1])))
    slopes = np.log2(np.array(errors[:-1]) / errors[1:])
    assert slopes == pytest.approx([1.0, 1.0], abs=0.15)


def test_time_begins_where_it_is_told_and_changes_nothing_else(make, slave):
    fmu = make()
    one, other = slave(fmu).begin(), slave(fmu).begin(start_time=1000.0)
    one.steps([0.05] * 20)
    other.steps([0.05] * 20, time=1000.0)
    assert one.get("time", "center_of_mass.x") == pytest.approx(
        other.get("time", "center_of_mass.x") - [1000.0, 0.0]
    )


def test_instances_side_by_side_do_not_notice_each_other(make, slave):
    fmu = make()
    alone = slave(fmu).begin()
    alone.steps([0.05] * 40)
    one, other = slave(fmu).begin(), slave(fmu).begin(gait__amplitude=0.2, current__y=0.1)
    for k in range(40):
        one.steps([0.05], time=0.05 * k)
        other.steps([0.03], time=0.03 * k)
    assert one.everything() == alone.everything()
    assert other.get("center_of_mass.y") != one.get("center_of_mass.y")


def test_a_reset_instance_is_a_new_one(make, slave):
    one = slave(make()).begin(gait__amplitude=0.2, water__density=900.0)
    first = slave(make()).begin()
    one.steps([0.05] * 10)
    one.fmu.reset()
    one.begin()
    assert one.everything() == first.everything()
    for each in (one, first):
        each.steps([0.05] * 10)
    assert one.everything() == first.everything()


def test_a_state_that_is_put_back_leads_to_the_same_bits(make, slave):
    one = slave(make(joints="servo")).begin()
    one.steps([0.05] * 10)
    state = one.fmu.getFMUstate()
    kept = one.fmu.serializeFMUstate(state)
    one.steps([0.05] * 10, time=0.5)
    there = one.everything()
    one.set(gait__amplitude=0.1)
    one.fmu.setFMUstate(state)
    one.steps([0.05] * 10, time=0.5)
    assert one.everything() == there
    other = slave(make(joints="servo")).begin()
    copy = other.fmu.deSerializeFMUstate(kept)
    other.fmu.setFMUstate(copy)
    other.steps([0.05] * 10, time=0.5)
    assert other.everything() == there
    for holder, thing in ((one, state), (other, copy)):
        holder.fmu.freeFMUstate(thing)


def test_the_state_of_another_robot_is_refused(make, slave):
    one, other = slave(make()).begin(), slave(make(joints="servo")).begin()
    kept = other.fmu.serializeFMUstate(other.fmu.getFMUstate())
    with pytest.raises(Exception, match="fmi2DeSerializeFMUstate failed with status 3"):
        one.fmu.deSerializeFMUstate(kept)
    assert one.messages == ["The state must be one of this model."]


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("water.normal_drag", -1.0, "`water.normal_drag` must be >= 0, got -1."),
        ("water.density", 0.0, "`water.density` must be >= 1e-09, got 0."),
        ("gait.amplitude", math.nan, "`gait.amplitude` must be a finite number, got nan."),
        ("current.x", 1000.0, "`current.x` must be <= 100, got 1000."),
        ("heading", 1.0, "`heading` must not be set: it is neither an input nor a parameter."),
        ("time", 1.0, "`time` must not be set: it is neither an input nor a parameter."),
    ],
)
def test_a_wrong_value_is_an_error_with_a_message_and_changes_nothing(
    make, slave, name, value, message
):
    one = slave(make())
    before = one.everything()
    with pytest.raises(Exception, match="fmi2SetReal failed with status 3"):
        one.put(name, value)
    assert one.messages == [message]
    assert one.everything() == before


def test_a_parameter_is_refused_once_the_robot_swims(make, slave):
    one = slave(make()).begin()
    with pytest.raises(Exception, match="status 3"):
        one.put("water.density", 900.0)
    assert one.messages == [
        "`water.density` must be set before the initialization ends: it is a parameter."
    ]
    one.put("gait.amplitude", 0.3)


@pytest.mark.parametrize(
    ("time", "interval", "message"),
    [
        (0.0, 0.0, "The communication step must be > 0 s, got 0."),
        (0.0, -0.1, "The communication step must be > 0 s, got -0.1."),
        (0.3, 0.1, "The communication point must be t = 0 s, where the last step ended, got 0.3."),
        (0.0, 1e12, "The communication step must be <= 5e+07 s, got 1e+12."),
    ],
)
def test_a_step_out_of_line_is_an_error_with_a_message(make, slave, time, interval, message):
    one = slave(make()).begin()
    with pytest.raises(Exception, match="fmi2DoStep failed with status 3"):
        one.fmu.doStep(time, interval)
    assert one.messages == [message]
    one.steps([0.1])


def test_a_step_before_the_initialization_is_refused(make, slave):
    one = slave(make())
    with pytest.raises(Exception, match="status 3"):
        one.fmu.doStep(0.0, 0.1)
    assert one.messages == ["A step must come after the initialization, and before the end."]


def test_a_motion_that_diverges_is_an_error_and_the_numbers_stay_those_before_it(make, slave):
    one = slave(make("mamba")).begin(dt=10.0, water__normal_drag=50.0, gait__frequency=9.0)
    one.steps([0.05])
    before = one.everything()
    with pytest.raises(Exception, match="fmi2DoStep failed with status 3"):
        for k in range(1, 100):
            one.steps([10.0], time=0.05 + 10.0 * (k - 1))
            before = one.everything()
    (message,) = one.messages
    assert message.startswith("The motion diverged between t = ")
    assert "try a smaller `dt`" in message
    assert one.everything() == before
    assert np.all(np.isfinite(one.get(*one.number)))
    with pytest.raises(Exception, match="status 3"):
        one.steps([0.05], time=float(one.get("time")[0]))
    assert (
        one.messages[1]
        == "A step is no longer possible: the motion diverged. Reset the instance first."
    )
    one.fmu.reset()
    one.begin().steps([0.05] * 20)


def test_fmi_3_keeps_states_and_tells_errors_too(make):
    from fmpy.fmi3 import FMU3Slave

    folder = make(fmi="3.0").folder
    told = fmpy.read_model_description(folder)
    number = {v.name: v.valueReference for v in told.modelVariables}
    messages: list[bytes] = []
    one = FMU3Slave(
        guid=told.guid,
        unzipDirectory=folder,
        modelIdentifier=told.coSimulation.modelIdentifier,
        instanceName="snake",
    )
    one.instantiate(
        logMessage=lambda environment, status, category, message: messages.append(message)
    )
    one.enterInitializationMode(startTime=5.0)
    one.exitInitializationMode()

    def go(first: int, last: int) -> list[float]:
        for k in range(first, last):
            assert one.doStep(5.0 + 0.05 * k, 0.05)[:3] == (False, False, False)
        return list(one.getFloat64(list(number.values())))

    go(0, 10)
    kept = one.serializeFMUState(one.getFMUState())
    there = go(10, 20)
    one.setFMUState(one.deserializeFMUState(kept))
    assert go(10, 20) == there
    for name, value in (("water.density", 900.0), ("gait.amplitude", -1.0)):
        with pytest.raises(Exception, match="fmi3SetFloat64 failed with status 3"):
            one.setFloat64([number[name]], [value])
    assert [str(message) for message in messages] == [
        "b'`water.density` must be set before the initialization ends: it is a parameter.'",
        "b'`gait.amplitude` must be >= 0, got -1.'",
    ]
    one.reset()
    one.terminate()
    one.freeInstance()


def test_an_fmu_of_another_guid_is_not_instantiated(make, slave):
    with pytest.raises(Exception, match="Failed to instantiate"):
        slave(make(), guid="{0}")


ALONE = """
import ctypes, sys
from ctypes import CFUNCTYPE, POINTER, Structure, byref, c_char_p, c_double, c_int, c_size_t, c_uint, c_void_p

class Callbacks(Structure):
    _fields_ = [(name, c_void_p) for name in ("logger", "allocate", "release", "finished", "environment")]

fmu = ctypes.CDLL(sys.argv[1])
fmu.fmi2Instantiate.restype = c_void_p
fmu.fmi2Instantiate.argtypes = [c_char_p, c_int, c_char_p, c_char_p, POINTER(Callbacks), c_int, c_int]
fmu.fmi2SetupExperiment.argtypes = [c_void_p, c_int, c_double, c_double, c_int, c_double]
fmu.fmi2DoStep.argtypes = [c_void_p, c_double, c_double, c_int]
fmu.fmi2GetReal.argtypes = [c_void_p, POINTER(c_uint), c_size_t, POINTER(c_double)]
callbacks = Callbacks()
one = c_void_p(fmu.fmi2Instantiate(b"one", 1, sys.argv[2].encode(), b"", byref(callbacks), 0, 0))
assert fmu.fmi2SetupExperiment(one, 0, 0.0, 0.0, 0, 0.0) == 0
assert fmu.fmi2EnterInitializationMode(one) == 0 and fmu.fmi2ExitInitializationMode(one) == 0
for k in range(200):
    assert fmu.fmi2DoStep(one, 0.05 * k, 0.05, 0) == 0
value = c_double()
assert fmu.fmi2GetReal(one, byref(c_uint(int(sys.argv[3]))), 1, byref(value)) == 0
loaded = [name for name in ("laticauda", "numba", "numpy", "llvmlite") if name in sys.modules]
print(value.value.hex(), *loaded)
"""


def test_the_library_runs_where_there_is_no_laticauda(make, slave):
    fmu = make()
    one = slave(fmu).begin()
    one.steps([0.05] * 200)
    guid = fmpy.read_model_description(fmu.folder).guid
    library = f"{fmu.folder}/binaries/linux64/snake.so"
    # -I -S: this Python sees nothing but its own standard library.
    done = subprocess.run(
        [
            sys.executable,
            "-I",
            "-S",
            "-c",
            ALONE,
            library,
            guid,
            str(one.number["center_of_mass.x"]),
        ],
        capture_output=True,
        text=True,
        env={},
    )
    assert done.stderr == ""
    assert done.stdout.split() == [one.get("center_of_mass.x")[0].hex()]


@pytest.mark.skipif(shutil.which("nm") is None, reason="nm is not installed")
@pytest.mark.parametrize("kind", KINDS)
def test_the_library_asks_for_the_c_library_only_and_offers_fmi_only(make, kind):
    library = f"{make(**KINDS[kind]).folder}/binaries/linux64/snake.so"
    listed = subprocess.run(
        ["nm", "-D", library], capture_output=True, text=True, check=True
    ).stdout
    entries = [line.split()[-2:] for line in listed.splitlines()]
    foreign = {name.split("@")[0] for letter, name in entries if letter == "U"}
    texts = {"memcpy", "memset", "strcmp", "strcpy", "strlen", "vsnprintf", "__vsnprintf_chk"}
    # sincos is not of the standard, but both C libraries of Linux have it.
    maths = {"ceil", "cos", "sin", "sincos", "tanh"}
    maths_of_sensors = {"atan2", "hypot"}
    memory = {"calloc", "free", "malloc", "__stack_chk_fail"}
    assert foreign <= maths | maths_of_sensors | memory | texts
    assert {name[:4] for letter, name in entries if letter == "T"} == {"fmi2"}


def test_the_same_robot_makes_the_same_file_but_for_its_date(make, tmp_path, monkeypatch):
    robot, guid = lc.load_robot("mamba-fin"), fmpy.read_model_description(make().folder).guid
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1000000000")
    (tmp_path / "one").mkdir()
    variables = export_fmu(tmp_path / "one" / "snake.fmu", robot, GAIT)
    assert variables == export_fmu(tmp_path / "snake.fmu", robot, GAIT) == make().variables
    assert (tmp_path / "one" / "snake.fmu").read_bytes() == (tmp_path / "snake.fmu").read_bytes()
    told = fmpy.read_model_description(str(tmp_path / "snake.fmu"))
    assert (told.guid, told.generationDateAndTime) == (guid, "2001-09-09T01:46:40Z")


@pytest.mark.skipif(importlib.util.find_spec("ziglang") is None, reason="ziglang is not installed")
@pytest.mark.parametrize(
    ("fmi", "names", "folders"),
    [
        (
            "2.0",
            ("linux64", "darwin"),
            {"linux64": b"\x7fELF", "darwin64": b"\xca\xfe\xba\xbe\0\0\0\2"},
        ),
        (
            "3.0",
            ("darwin",),
            {"aarch64-darwin": b"\xcf\xfa\xed\xfe\x0c", "x86_64-darwin": b"\xcf\xfa\xed\xfe\x07"},
        ),
    ],
)
def test_an_fmu_holds_a_library_for_each_platform(tmp_path, fmi, names, folders):
    from fmpy.validation import validate_fmu

    file = tmp_path / "snake.fmu"
    export_fmu(
        file,
        "mamba",
        GAIT,
        fmi=fmi,
        platform=names,
        author="A. Snake",
        model_version="1.2",
        license="CC0",
    )
    assert validate_fmu(str(file)) == []
    assert set(fmpy.supported_platforms(str(file))) == (
        {"linux64", "darwin64"} if fmi == "2.0" else {"darwin64"}
    )
    told = fmpy.read_model_description(str(file))
    assert (told.author, told.version, told.license) == ("A. Snake", "1.2", "CC0")
    with zipfile.ZipFile(file) as archive:
        found = {
            Path(name).parent.name: archive.read(name)
            for name in archive.namelist()
            if "binaries" in name
        }
        icon = archive.read("model.png" if fmi == "2.0" else "terminalsAndIcons/icon.png")
        license = archive.read("documentation/licenses/license.txt").decode()
    assert icon.startswith(b"\x89PNG")
    assert license == (Path(__file__).parents[3] / "LICENSE").read_text()
    assert found.keys() == folders.keys()
    for folder, beginning in folders.items():
        assert found[folder].startswith(beginning)
    if (
        fmi == "2.0"
    ):  # both kinds of Mac in one library, each part where the head says, and no longer than that
        for k, kind in enumerate((b"\x0c", b"\x07")):
            at, size = struct.unpack(">2I", found["darwin64"][8 + 20 * k + 8 :][:8])
            assert found["darwin64"][at:].startswith(b"\xcf\xfa\xed\xfe" + kind)
            assert at % 2**14 == 0 and at + size <= len(found["darwin64"])


def test_the_name_of_the_file_becomes_one_that_c_allows(tmp_path):
    export_fmu(tmp_path / "2 snakes-é.fmu", lc.load_robot("mamba"), GAIT)
    told = fmpy.read_model_description(str(tmp_path / "2 snakes-é.fmu"))
    assert told.coSimulation.modelIdentifier == "robot_2_snakes__"
    fmpy.simulate_fmu(str(tmp_path / "2 snakes-é.fmu"), stop_time=0.1)


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        (
            {"inputs": "references"},
            "`inputs` must be 'gait' for prescribed joints, .* got 'references'.",
        ),
        ({"fmi": "1.0"}, "`fmi` must be one of `2.0`, `3.0`, got '1.0'."),
        (
            {"platform": ("linux32",)},
            "`platform` must be one of `linux64`, .*`darwin`, got 'linux32'.",
        ),
        ({"platform": ("wasm32",)}, "`platform` must be one of `linux64`, .* got 'wasm32'."),
        ({"inputs": "torques"}, "`inputs` must be one of `gait`, `references`, got 'torques'."),
        (
            {"environment": lc.load_ground("coulomb")},
            "`environment` must be of class Water, got Ground.",
        ),
        ({"path": "snake.zip"}, "`path` must be a file that ends in .fmu, got snake.zip."),
        (
            {"gait": replace(GAIT, pitch=lc.Wave(amplitude=0.1, frequency=1.0))},
            "`gait.pitch` must be None",
        ),
    ],
)
def test_what_cannot_be_exported_is_refused_by_name(tmp_path, monkeypatch, settings, message):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ValueError, match=message):
        export_fmu(
            **{"path": "snake.fmu", "robot": lc.load_robot("mamba"), "gait": GAIT} | settings
        )
    assert list(tmp_path.iterdir()) == []


def test_without_a_c_compiler_it_says_what_to_install(tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("CC", raising=False)
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    with pytest.raises(
        MissingProgram,
        match=r"^A library of machine code needs a C compiler; .*`apt-get install gcc libc6-dev`.$",
    ):
        export_fmu(tmp_path / "snake.fmu", lc.load_robot("mamba"), GAIT)
    monkeypatch.setenv("CC", "none-such -m64")
    with pytest.raises(
        MissingProgram, match=r"`none-such` \(the environment says CC=none-such -m64\)"
    ):
        export_fmu(tmp_path / "snake.fmu", lc.load_robot("mamba"), GAIT)
    assert list(tmp_path.iterdir()) == []


def test_the_numbers_of_a_flow_of_one_formula_are_parameters_and_water_that_moves_as_one_has_inputs():
    def names(current: Any) -> dict[str, tuple[str, float]]:
        body = in_python(environment=replace(lc.load_water("paper-lateral"), current=current))[0]
        found = list_variables(body, GAIT, Start(), inputs="gait")
        template = body.layout.template
        for one in found:  # each stands in the row that has its value
            assert all(
                template[row] == one.start for row, _ in one.rows if one.name.startswith("current.")
            )
        return {
            one.name: (one.causality, one.start) for one in found if one.name.startswith("current.")
        }

    assert names((0.1, 0.2)) == {"current.x": ("input", 0.1), "current.y": ("input", 0.2)}
    vortex = lc.load_current("vortex")
    expected = {
        f"current.{name}": ("parameter", getattr(vortex, name)) for name in vortex.formula.fields
    }
    assert names(vortex) == expected
    assert names(GUSTS) == {}
