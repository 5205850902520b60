"""What is wrong and looks right: each input is refused, or there is one warning; no true robot meets either."""

import json
import math
import time
import warnings
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from odd_robots import MM_ROBOT

import laticauda as lc
from laticauda.cli import app
from laticauda.connect.session import Session
from laticauda.motion.gaits import JointAngles, Wave, recorded_gait
from laticauda.robot import Water, robot_names
from laticauda.scenarios import judge_scenario, limit_case, warn_of_speed
from laticauda.values import BadArgument

NUMBERS: dict[str, Any] = {"amplitude_deg": 30, "frequency_deg_s": 130, "phase_shift_deg": 40}
GAIT = lc.lateral_undulation(**NUMBERS)
MAMBA = lc.load_robot("mamba")
FINNED = lc.load_robot("mamba-fin")
WATER = lc.load_water("paper-lateral")
REFUSED, WARNED = "refused", "warned"


def answer_to(make: Callable[[], lc.Scenario]) -> tuple[str, str]:
    """Return whether a scenario is refused or warned of when it is about to run, and with which words."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            lc.build_plant(make())
        except BadArgument as error:
            return REFUSED, str(error)
    said = [str(warning.message) for warning in caught]
    return (WARNED if said else "silent"), " ".join(said)


def built(**changes: Any) -> lc.Scenario:
    robot = changes.pop("robot", MAMBA)
    gait = changes.pop("gait", GAIT)
    return lc.build_scenario(robot, gait, changes.pop("duration", 30.0), **changes)


def gait(**changes: float) -> lc.Scenario:
    return built(gait=replace(GAIT, **changes))


def modules(**changes: Any) -> lc.Scenario:
    parts = tuple(replace(module, **changes) for module in MAMBA.modules)
    return built(robot=replace(MAMBA, modules=parts), environment=WATER)


def section(**changes: float) -> lc.Scenario:
    return modules(section=replace(MAMBA.modules[0].section, **changes))


def fin(**changes: float) -> lc.Scenario:
    assert FINNED.caudal_fin is not None
    caudal_fin = replace(FINNED.caudal_fin, **changes)
    return built(robot=replace(FINNED, caudal_fin=caudal_fin), environment=WATER)


def servo(**changes: float) -> lc.Scenario:
    joints = tuple(
        replace(joint, actuator=replace(joint.actuator, **changes)) for joint in MAMBA.joints
    )
    return built(robot=replace(MAMBA, joints=joints), joints="servo")


def water(**changes: Any) -> lc.Scenario:
    return built(environment=replace(WATER, **changes))


def start(**changes: Any) -> lc.Scenario:
    return built(start=lc.Start(**changes))


def recorded(
    step: float = 0.05,
    n_samples: int = 601,
    *,
    begin: float = 0.0,
    unit: float = 1.0,
    gap: tuple[float, float] | None = None,
    size: float = 1.0,
    duration: float = 30.0,
) -> lc.Scenario:
    """A run with Mamba's first gait as recorded angles, whose times are in some unit, and may have a gap."""
    seconds = step * np.arange(n_samples)
    if gap is not None:
        seconds = seconds[(seconds <= gap[0]) | (seconds >= gap[1])]
    phases = GAIT.frequency * seconds + GAIT.phase_shift * np.arange(8)[:, np.newaxis]
    angles = size * GAIT.amplitude * np.sin(phases)
    times = begin + unit * seconds
    motion = JointAngles(time=tuple(times.tolist()), angle=tuple(map(tuple, angles.tolist())))
    return built(gait=recorded_gait(motion), duration=duration)


CYCLE = 2.0 * math.pi / GAIT.frequency

WRONG: dict[str, tuple[Callable[[], lc.Scenario], str, str]] = {
    # ---- robots
    "a module in mm": (lambda: modules(length=90.0), REFUSED, "did you mean 0.09 (90 mm)?"),
    "a longer module in mm": (lambda: modules(length=180.0), REFUSED, "between 0 and 100 m"),
    "a module in cm": (lambda: modules(length=18.0), REFUSED, "did you mean 0.18 (18 cm)?"),
    "a section in mm": (
        lambda: section(half_height=55.0, half_width=50.0),
        REFUSED,
        "`modules[0].section.half_height` must be <= 2 m, got 55; did you mean 0.055 (55 mm)?",
    ),
    "a section in cm": (
        lambda: section(half_height=5.5, half_width=5.0),
        REFUSED,
        "did you mean 0.055 (5.5 cm)?",
    ),
    "a section of 0.55 m in a snake": (
        lambda: section(half_height=0.55, half_width=0.5),
        REFUSED,
        "kg of water, got 0.8",
    ),
    "diameters as half-axes": (
        lambda: section(half_height=0.11, half_width=0.1),
        WARNED,
        "are `half_height` and `half_width` diameters",
    ),
    "a mass in g": (lambda: modules(mass=800.0), REFUSED, "did you mean 0.8 (800 g)?"),
    "a mass in t": (lambda: modules(mass=0.0008), REFUSED, "did you mean 0.8 (0.0008 t)?"),
    "a robot that sinks": (lambda: modules(mass=2.0), WARNED, "it would sink"),
    "a robot of foam": (lambda: modules(mass=0.1), WARNED, "it would lie on the water"),
    "the robot's mass for every module": (
        lambda: modules(mass=7.2),
        WARNED,
        "that of the whole robot",
    ),
    "an inertia in kg mm^2": (
        lambda: modules(inertia=2160.0),
        REFUSED,
        "did you mean 0.00216 (2160 kg mm^2)?",
    ),
    "an inertia in kg cm^2": (
        lambda: modules(inertia=21.6),
        REFUSED,
        "did you mean 0.00216 (21.6 kg cm^2)?",
    ),
    "an inertia of a robot": (
        lambda: modules(inertia=1.6),
        REFUSED,
        "all of 0.8 kg at the corners",
    ),
    "an inertia of a point": (lambda: modules(inertia=2e-6), WARNED, "little beside a rod's"),
    # ---- fins
    "a fin of 50 m": (lambda: fin(length=50.0), REFUSED, "did you mean 0.05 (50 mm)?"),
    "a fin longer than its robot": (lambda: fin(length=2.0), WARNED, "the robot's whole length"),
    "a fin 90 m high": (lambda: fin(height=90.0), REFUSED, "did you mean 0.09 (90 mm)?"),
    "a fin 9 m high": (lambda: fin(height=9.0), REFUSED, "did you mean 0.09 (9 cm)?"),
    "a fin 2 m high": (lambda: fin(height=2.0), WARNED, "the robot's whole length"),
    "a fin 5 m thick": (lambda: fin(thickness=5.0), REFUSED, "did you mean 0.005 (5 mm)?"),
    "a fin as thick as a pipe": (lambda: fin(thickness=0.05), WARNED, "is much for a plate"),
    "a fin in g/cm^3": (lambda: fin(density=1.35), REFUSED, "did you mean 1350 (1.35 g/cm^3)?"),
    # ---- servos
    "a servo in deg/s": (
        lambda: servo(no_load_speed=428.0),
        REFUSED,
        "did you mean 7.47 (428 deg/s)?",
    ),
    "a servo in rpm": (lambda: servo(no_load_speed=71.0), REFUSED, "did you mean 7.435 (71 rpm)?"),
    "a servo in kg cm": (
        lambda: servo(stall_torque=30.0),
        REFUSED,
        "did you mean 2.942 (30 kg cm)?",
    ),
    "a servo in N cm": (
        lambda: servo(stall_torque=290.0),
        REFUSED,
        "did you mean 2.9 (290 N cm)?",
    ),
    "a servo in mV": (lambda: servo(voltage=7400.0), WARNED, "did you mean 7.4 (7400 mV)?"),
    "a servo in mA": (lambda: servo(stall_current=4600.0), WARNED, "did you mean 4.6 (4600 mA)?"),
    "an idle current in mA": (
        lambda: servo(idle_current=150.0),
        REFUSED,
        "did you mean 0.15 (150 mA)?",
    ),
    "electronics in mW": (
        lambda: built(robot=replace(MAMBA, electronics_power=41300.0)),
        WARNED,
        "did you mean 41.3 (41300 mW)?",
    ),
    "a thrust in mN": (
        lambda: built(
            robot=replace(MAMBA, thrusters=(lc.robot.Thruster(link=0, thrust=5000.0),)),
            environment=WATER,
        ),
        WARNED,
        "times the weight of the robot",
    ),
    # ---- water
    "water in g/cm^3": (
        lambda: water(density=1.0),
        REFUSED,
        "must be between 500 and 1500 kg/m^3, got 1; did you mean 1000 (1 g/cm^3)?",
    ),
    "water like air": (lambda: water(density=1.2), REFUSED, "between 500 and 1500 kg/m^3"),
    "water like mercury": (lambda: water(density=13500.0), REFUSED, "got 13500"),
    "an added mass in kg": (lambda: water(added_mass=1500.0), REFUSED, "without unit"),
    "an added mass of tens": (lambda: water(added_mass=15.0), WARNED, "without unit"),
    "a drag in kg/m": (lambda: water(normal_drag=192.5), WARNED, "without unit"),
    "a friction of hundreds": (lambda: water(tangential_friction=300.0), REFUSED, "without unit"),
    "a module with an added mass in kg": (
        lambda: modules(added_mass=1500.0),
        REFUSED,
        "`modules[0].added_mass`",
    ),
    "a fin with an added mass in kg": (
        lambda: fin(added_mass=400.0),
        REFUSED,
        "`caudal_fin.added_mass`",
    ),
    "a current in cm/s": (
        lambda: water(current=(50.0, 0.0)),
        REFUSED,
        "did you mean 0.5 (50 cm/s)?",
    ),
    "a torrent": (lambda: water(current=(5.0, 0.0)), WARNED, "did you mean 0.05 (5 cm/s)?"),
    "a depth in mm": (lambda: water(depth=15000.0), REFUSED, "did you mean 15 (15000 mm)?"),
    # ---- gaits
    "a frequency of 70": (
        lambda: gait(frequency=70.0),
        WARNED,
        "11.1 cycles per second; did you mean frequency_deg_s=70?",
    ),
    "a frequency of 130": (lambda: gait(frequency=130.0), WARNED, "frequency_deg_s=130?"),
    "130 Hz": (lambda: gait(frequency=130.0 * math.tau), REFUSED, "frequency_deg_s=130?"),
    "20 Hz": (lambda: gait(frequency=20.0 * math.tau), WARNED, "frequency_deg_s=20?"),
    "a frequency of 40": (lambda: gait(frequency=40.0), WARNED, "frequency_deg_s=40?"),
    "a frequency of 1000": (lambda: gait(frequency=1000.0), REFUSED, "100 cycles per second"),
    "a frequency in Hz": (
        lambda: gait(frequency=0.36),
        WARNED,
        "did you mean frequency_hz=0.36?",
    ),
    "rad/s taken for deg/s": (
        lambda: gait(frequency=math.radians(2.27)),
        WARNED,
        "did you mean 2.27 rad/s?",
    ),
    "rad taken for degrees": (
        lambda: gait(amplitude=math.radians(0.52)),
        WARNED,
        "did you mean 0.52 rad?",
    ),
    "a phase shift of 3 deg": (
        lambda: gait(phase_shift=3.0),
        WARNED,
        "did you mean phase_shift_deg=3?",
    ),
    "a phase shift of 0.7 deg": (
        lambda: gait(phase_shift=math.radians(0.7)),
        WARNED,
        "did you mean 0.7 rad?",
    ),
    "a phase shift of 40 rad": (
        lambda: gait(phase_shift=40.0),
        REFUSED,
        "did you mean phase_shift_deg=40?",
    ),
    "five times what servos can": (
        lambda: gait(frequency=30.0, amplitude=1.3),
        WARNED,
        "times the no-load speed of the servos",
    ),
    "a fin's wave of 130": (
        lambda: built(
            robot=replace(FINNED, caudal_fin=replace(FINNED.caudal_fin, joint=MAMBA.joints[0])),
            gait=replace(GAIT, fin=Wave(amplitude=0.3, frequency=130.0)),
        ),
        WARNED,
        "`fin.frequency`",
    ),
    # ---- starts and models
    "a heading of 180 deg": (
        lambda: start(heading=180.0),
        REFUSED,
        "`heading` must be within a turn, 2 pi = 6.28 rad, got 180; did you mean degrees: heading_deg=180?",
    ),
    "a heading of 90 deg": (lambda: start(heading=90.0), REFUSED, "heading_deg=90?"),
    "a heading of -7 turns": (lambda: start(heading=-44.0), REFUSED, "within a turn"),
    "a start at 5 m/s": (lambda: start(velocity=5.0), WARNED, "body lengths per second"),
    "a start in cm/s": (lambda: start(velocity=50.0), REFUSED, "did you mean 0.5 (50 cm/s)?"),
    "a start in mm": (
        lambda: start(center_of_mass=(20000.0, 0.0)),
        WARNED,
        "did you mean 20 (20000 mm)?",
    ),
    "a delay in ms": (lambda: built(loop_delay=50.0), WARNED, "did you mean 0.05 (50 ms)?"),
    # ---- recordings
    "times in ms": (lambda: recorded(unit=1000.0), REFUSED, "(30000 ms)?"),
    "times of a clock": (lambda: recorded(begin=1.7e9), REFUSED, "not those of a clock?"),
    "clock times in ms": (
        lambda: recorded(begin=1.7e12, unit=1000.0),
        REFUSED,
        "must be <= 1e+12 s",
    ),
    "2 s for a run of 30 s": (
        lambda: recorded(n_samples=41),
        WARNED,
        "covers 0 to 2 s of a run of 30 s",
    ),
    "a recording that begins late": (lambda: recorded(begin=10.0), WARNED, "covers 10 to 40 s"),
    "a gap of 3 s": (lambda: recorded(gap=(10.0, 13.0)), WARNED, "a gap of 3 s at 10 s"),
    "one sample a cycle": (
        lambda: recorded(step=CYCLE, n_samples=12),
        WARNED,
        "is it sampled once a cycle?",
    ),
    "nearly one sample a cycle": (
        lambda: recorded(step=0.95 * CYCLE, n_samples=13),
        WARNED,
        "too few to show how the joints move",
    ),
    "three samples a cycle": (
        lambda: recorded(step=CYCLE / 3.0, n_samples=34),
        WARNED,
        "too few to show how the joints move",
    ),
    "8 times of 8 joints, transposed": (
        lambda: recorded(step=30.0 / 7.0, n_samples=8),
        WARNED,
        "too few to show how the joints move",
    ),
    "recorded degrees": (
        lambda: recorded(size=math.degrees(1.0)),
        REFUSED,
        "did you mean degrees (angle_deg)?",
    ),
}
"""What is given, whether it is refused or warned of, and what the answer must hold."""


TRUE: dict[str, Callable[[], lc.Scenario]] = {
    "the lowest frequency of the gait map, 20 deg/s": lambda: gait(frequency=math.radians(20.0)),
    "a recording that begins with its first sample": lambda: recorded(begin=0.008),
    "a recording after which the robot glides": lambda: recorded(n_samples=371),
    "a motor that is off": lambda: servo(stall_torque=1e-9, stall_current=1e-9),
}
"""What is meant as it is given, and looks odd only at first sight."""


@pytest.mark.parametrize("case", TRUE)
def test_what_is_odd_only_at_first_sight_is_not_doubted(case):
    assert list(judge_scenario(TRUE[case]())) == []


def test_there_are_40_and_more():
    assert len(WRONG) >= 40


@pytest.mark.parametrize("mistake", WRONG)
def test_what_is_wrong_and_looks_right_is_refused_or_said(mistake):
    make, verdict, words = WRONG[mistake]
    answer, said = answer_to(make)
    assert answer == verdict, said
    assert words in said
    assert said.count("did you mean") <= 1 or answer == WARNED


@pytest.mark.parametrize("robot", robot_names())
@pytest.mark.parametrize("kind", ["lateral-undulation", "eel-like"])
def test_no_preset_robot_is_doubted(robot, kind):
    plain = lc.build_scenario(robot, kind, **NUMBERS)
    assert list(judge_scenario(plain)) == []
    servos = lc.build_scenario(robot, kind, **NUMBERS, joints="servo", environment="textbook")
    assert list(judge_scenario(servos)) == []
    for name in lc.robot.parameter_names():
        known = lc.build_scenario(robot, kind, **NUMBERS, parameters=name)
        assert list(judge_scenario(known)) == []


@pytest.mark.parametrize("water_name", lc.robot.water_names())
def test_no_preset_water_and_current_is_doubted(water_name):
    environment = lc.load_water(water_name)
    for current in lc.robot.current_names():
        flowing = replace(environment, current=lc.robot.load_current(current))
        assert list(judge_scenario(built(environment=flowing))) == []


def test_no_measured_trial_is_doubted():
    from laticauda.trials import measured

    for collection in measured.all_measured():
        for trial in collection.trials():
            assert list(judge_scenario(built(robot=trial.robot, gait=trial.gait))) == []


def test_the_preset_motion_is_not_doubted():
    angles = lc.load_joint_angles("amphibot-1")
    duration = angles.time[-1]
    scenario = lc.build_scenario("amphibot", recorded_gait(angles), duration)
    assert list(judge_scenario(scenario)) == []


IN_SHELL: dict[str, tuple[str, str, int]] = {
    "frequency": (
        "swim mamba --frequency-hz 20 --duration 0.1",
        "laticauda: `frequency` of 125.7 rad/s is 20 cycles per second",
        0,
    ),
    "density": ("swim mamba --density 1.0 --duration 0.1", "did you mean 1000 (1 g/cm^3)?", 2),
    "phase shift": (
        "swim mamba --phase-shift-deg 172 --duration 0.1",
        "`phase_shift` of 3.002 rad is 172 deg",
        0,
    ),
    "heading": ("swim mamba --heading-deg 720 --duration 0.1", "within a turn", 2),
    "velocity": ("swim mamba --velocity 50 --duration 0.1", "(50 cm/s)?", 2),
    "added mass": ("swim mamba --added-mass 1500 --duration 0.1", "without unit", 2),
    "a robot in mm": ("robots mm.toml", "did you mean 0.1 (100 mm)?", 2),
    "a sweep": (
        "sweep mamba --vary frequency-deg-s=2800,5700,8600 --duration 1 --output swept",
        "cycles per second",
        0,
    ),
    "a sweep in thin water": (
        "sweep mamba --vary density=1:1000:3 --duration 1 --output swept",
        "must be between 500 and 1500 kg/m^3",
        2,
    ),
}


@pytest.mark.parametrize("mistake", IN_SHELL)
def test_the_shell_says_it_in_one_line(mistake, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mm.toml").write_text(MM_ROBOT)
    typed, words, status = IN_SHELL[mistake]
    assert app.main(typed.split()) == status
    lines = [line for line in capsys.readouterr().err.splitlines() if words in line]
    assert len(lines) == 1
    assert lines[0].startswith("laticauda: ")


def test_a_file_says_it_too(tmp_path, capsys):
    file = tmp_path / "heavy.toml"
    text = 'kind = "scenario"\nrobot = "mamba"\nduration = 0.1\n[water]\nextends = "paper-lateral"\ndensity = 1.0\n'
    file.write_text(
        f"{text}[gait]\namplitude_deg = 30\nfrequency_deg_s = 130\nphase_shift_deg = 40\n"
    )
    assert app.main(["swim", str(file)]) == 2
    assert "did you mean 1000 (1 g/cm^3)?" in capsys.readouterr().err


def ask(session: Session, **message: Any) -> dict[str, Any]:
    return json.loads(session.answer(json.dumps(message).encode()))


def test_a_client_of_the_server_is_refused_and_warned():
    session = Session()
    refusal = ask(session, do="reset", robot="mamba", heading=180.0)
    assert "did you mean degrees: heading_deg=180?" in refusal["error"]
    assert (
        "1 g/cm^3"
        in ask(session, do="reset", robot="mamba", coefficients={"density": 1.0})["error"]
    )
    fast = ask(session, do="reset", robot="mamba", gait={"frequency": 130.0})
    assert fast["warnings"] == [
        "`frequency` of 130 rad/s is 20.7 cycles per second; did you mean frequency_deg_s=130?"
    ]
    assert "warnings" not in ask(session, do="step", duration=0.01)
    slower = ask(session, do="set", gait={"frequency": 2.0})
    assert "warnings" not in slower
    assert "cycles per second" in ask(session, do="set", gait={"frequency": 100.0})["warnings"][0]
    ran = ask(session, do="run", robot="mamba", gait={"phase_shift": 3.0}, duration=0.1)
    assert [text for text in ran["warnings"] if "phase_shift_deg=3?" in text] == ran["warnings"]


def test_a_batch_is_judged_at_its_extremes():
    gaits = [replace(GAIT, frequency=frequency) for frequency in (2.0, 130.0, 3.0, 200.0)]
    with pytest.warns(lc.ImplausibleWarning, match="20.7 cycles|31.8 cycles") as caught:
        lc.swim_many("mamba", gaits, 0.1)
    assert len([one for one in caught if one.category is lc.ImplausibleWarning]) == 1
    with pytest.raises(BadArgument, match="did you mean 1000"):
        lc.swim_many("mamba", gaits[:1], 0.1, environments=replace(WATER, density=1.0))


def test_a_robot_that_swims_many_lengths_a_second_is_said():
    with pytest.warns(lc.ImplausibleWarning, match="mamba swam 8 m/s, 4.9 body lengths per second"):
        warn_of_speed(MAMBA, 8.0, WATER)
    carried = replace(WATER, current=(3.9, 0.0))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warn_of_speed(MAMBA, 8.0, carried)
        warn_of_speed(MAMBA, 0.2, WATER)


def test_a_limit_case_is_not_judged():
    vacuum = Water(density=1e-6, tangential_friction=0.0, normal_drag=0.0, added_mass=0.0)
    with limit_case():
        lc.build_plant(MAMBA, vacuum)
    with pytest.raises(BadArgument, match="density"):
        lc.build_plant(MAMBA, vacuum)


def test_a_number_is_warned_of_once():
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        fast = lc.eel_like(amplitude=0.5, frequency=130.0, phase_shift=0.7)
        lc.build_plant(built(gait=fast))
    assert len(caught) == 1


@pytest.mark.parametrize("changes", [{"density": 950.0}, {"density": 1025.0}])
def test_a_measurement_in_other_water_is_not_shown_beside_a_run(changes):
    from laticauda.trials import measured_setting

    assert measured_setting(MAMBA, GAIT, WATER) is not None
    assert measured_setting(MAMBA, GAIT, replace(WATER, **changes)) is None
    assert measured_setting(modules(mass=0.9).robot, GAIT, WATER) is None


def test_judging_takes_less_than_a_hundredth_of_a_run():
    scenario = built()
    lc.swim(scenario)
    runs = min(_seconds(lambda: lc.swim(scenario)) for _ in range(5))
    judged = min(
        _seconds(lambda: [list(judge_scenario(scenario)) for _ in range(50)]) for _ in range(5)
    )
    assert judged / 50 < 0.01 * runs


def _seconds(call: Callable[[], object]) -> float:
    begin = time.perf_counter()
    call()
    return time.perf_counter() - begin
