import json
import math
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import laticauda as lc
from laticauda.motion.joints.laws import PD, JointLaw, Servo
from laticauda.trials import FIGURES
from laticauda.water.fluid.laws import PolynomialDrag

PAPER = (
    "swim --robot mamba --gait lateral-undulation --amplitude-deg 30 --frequency-deg-s 130 --phase-shift-deg 40 "
    "--duration 30 --water paper-lateral"
)


def lateral(**changes: float) -> lc.Gait:
    values = {
        "amplitude": math.radians(30),
        "frequency": math.radians(130),
        "phase_shift": math.radians(40),
    }
    return lc.lateral_undulation(**values | changes)


def test_the_command_of_the_design_prints_one_json_object(run):
    trial = lc.swim(
        lc.load_robot("mamba"), lateral()
    )  # compiles what is to be compiled, of which the command would tell
    done = run(f"{PAPER} --json")
    found = json.loads(done.out)
    assert (done.status, done.err) == (0, "")
    assert found["forward_velocity"] == trial.forward_velocity
    assert found["mean_power"] == trial.mean_power
    assert found["status"] == "The run reached its end."
    assert found["measured"]["forward_velocity"] == 0.1514


def test_the_json_has_every_figure_or_the_reason_why_not(run):
    found = json.loads(run("swim --duration 5 --json").out)
    for figure in FIGURES:
        assert (found[figure.name] is None) == (figure.name in found["not_available"])
    assert "must span at least 12.77 s" in found["not_available"]["steady_velocity"]


def test_with_loads_the_screen_the_table_and_the_json_say_how_large_they_get(run):
    trial = lc.swim(lc.load_robot("mamba"), lateral(), 4.0, link_forces=True)
    command = f"{PAPER.replace('--duration 30', '')} --duration 4 --link-forces"
    screen = run(command)
    assert (screen.status, screen.err) == (0, "")
    assert f"loads   a joint carries up to {trial.peak_bending_moment:.3g} N m of" in screen.out
    assert "loads " not in run(command.replace("--link-forces", "")).out
    table = run(f"{command} --all").out
    assert "rms of the shear force in a joint" in table
    found = json.loads(run(f"{command} --json").out)
    assert found["rms_axial_force"] == trial.rms_axial_force


def test_the_json_says_how_the_run_was_made(run):
    found = json.loads(
        run("swim --gait eel-like --normal-drag 1.5 --joints pd --duration 1 --json").out
    )
    assert found["coefficients"]["normal_drag"] == 1.5
    assert found["coefficients"]["tangential_friction"] == 0.17
    assert found["settings"]["joints"] == "pd"
    assert found["gait_parameters"]["amplitude"] == math.radians(30)
    assert found["environment"] == "paper-eel with normal_drag 1.5"


def test_a_water_with_another_law_says_so_in_its_name(run):
    found = json.loads(run("swim --law total-speed-drag --gamma 0.8 --duration 0.1 --json").out)
    assert found["environment"] == "paper-lateral with total-speed-drag with gamma 0.8"
    assert (
        json.loads(run("swim --law polynomial-drag --duration 0.1 --json").out)["environment"]
        == "paper-lateral"
    )


def test_without_options_it_is_the_papers_first_trial_with_the_identified_robot(run):
    named = PAPER.replace("--water paper-lateral", "--parameters mamba-identified")
    assert run("swim").out == run("swim mamba").out == run(named).out


FIRST_SCREEN = """\
mamba-fin, 30 s, water mamba-identified
gait lateral-undulation: amplitude 30 deg, frequency 130 deg/s, phase shift 40 deg

speed   0.221 m/s (tank 0.223)
power   101 W electrical (tank 103)
joints  can do it: 81 % of angle, speed and torque are used

Two numbers are fitted to the 20 speeds of the paper's Table 1; a gait and fin left out is predicted to 5.4 %.
The servo's gear of 7:1 is assumed: 3:1 to 9:1 fit as well.
Tank: Mamba with its fin in the tank, 30 s from rest, the best of a sweep (Table 1 of the paper).
More: --all prints every figure, --plot run.png draws the run, --json is for programs.
"""


def test_the_first_screen_says_how_fast_for_what_power_and_whether_the_robot_can_do_it(run):
    assert run("swim mamba-fin").out == FIRST_SCREEN


@pytest.mark.parametrize(
    "options",
    [
        "--tangential-friction 0.3",
        "--normal-drag=1.75",
        "--no-linear",
        "--law polynomial-drag",
        "--joints prescribed",
        "--parameters paper",
        "--water paper-lateral",
        "--n-links 9",
    ],
)
def test_whoever_names_a_coefficient_or_a_law_starts_from_the_papers_set(run, options):
    found = json.loads(run(f"swim --duration 0.1 {options} --json").out)
    assert found["environment"].startswith("paper")
    assert found["settings"]["joints"] == "prescribed"


@pytest.mark.parametrize("options", ["", "--current 0.1 0", "--gait eel-like", "--model spatial"])
def test_without_a_coefficient_the_robot_is_the_identified_one(run, options):
    found = json.loads(run(f"swim mamba-fin --duration 0.5 {options} --json").out)
    assert found["environment"].startswith("mamba-identified")
    assert found["settings"]["joints"] == "speed-servo"


def test_what_the_robot_cannot_do_is_said_with_what_follows(run):
    text = " ".join(run(f"{PAPER} --robot mamba-fin").out.split())
    assert "joints cannot do it: joint 2 needs 9.3 N m at 65.1 deg/s; its servo has 2.46" in text
    assert "But the robot swam this gait in the tank." in text
    text = " ".join(run("swim --normal-drag 2 --frequency-deg-s 300 --duration 5").out.split())
    assert "So the robot would swim more slowly than this" in text
    assert "--joints servo lets them lag" in text


def test_a_frequency_may_be_given_in_cycles_per_second(run):
    in_degrees = run("swim --frequency-deg-s 180 --duration 1").out
    assert run("swim --frequency-hz 0.5 --duration 1").out == in_degrees
    assert run("swim --frequency-hz=0.5 --duration 1").out == in_degrees
    assert run("swim --frequency-hz fast").err == (
        "laticauda: --frequency-hz must be a number of cycles per second, got 'fast'.\n"
    )


def test_a_robot_goes_by_its_name_alone_and_a_wrong_one_gets_the_right_one(run, folder):
    assert run("swim mamba-fin --duration 1").out == run("swim --robot mamba-fin --duration 1").out
    done = run("swim mamba-fni")
    assert (done.status, done.err) == (
        2,
        "laticauda: there is neither a robot nor a file 'mamba-fni'; did you mean `mamba-fin`?\n",
    )


def test_the_table_has_the_measured_speed_beside_the_simulated(run):
    text = run(f"{PAPER} --all").out
    assert re.search(r"^forward velocity.* 0\.1476  m/s +0\.1514 +-2\.5 %$", text, re.MULTILINE)
    assert "paper-lateral (as requested): tangential_friction 0.3, normal_drag 1.75" in text
    assert "mean power (mechanical)" in text
    assert "do not compare it with a mechanical one" in text
    assert re.search(r"^share of the linear term in the axial drag +0\.8713$", text, re.MULTILINE)


def test_an_electrical_power_is_compared_with_the_measured(run):
    text = run(f"{PAPER} --joints servo --all").out
    assert re.search(r"^mean power \(electrical\) .* W +106\.6 +[-+][\d.]+ %$", text, re.MULTILINE)
    assert "do not compare" not in text


def test_a_setting_that_was_not_measured_has_no_measured_column(run):
    text = run("swim --amplitude-deg 20 --duration 20").out
    assert "measured" not in text.lower()


def test_a_run_of_another_length_than_the_measured_says_so(run):
    assert "This run: 20 s." in " ".join(run("swim --duration 20").out.split())


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ("", "mamba-identified (as mamba-identified says)"),
        (
            "--joints prescribed",
            "paper-lateral (the paper's for lateral undulation)",
        ),
        ("--gait eel-like --joints prescribed", "paper-eel (the paper's for eel-like motion)"),
        (
            "--joints prescribed --gait custom --envelope 1 1 1 1 1 1 1 0.5",
            "paper-lateral (the paper's for lateral undulation, for lack",
        ),
        ("--water paper-vortex", "paper-vortex (as requested)"),
        (
            "--normal-drag 2",
            "paper-lateral with normal_drag 2 (the paper's for lateral undulation)",
        ),
        (
            "--ground viscous",
            "viscous (as requested): friction viscous, tangential 0.5 N s/m per link, normal",
        ),
    ],
)
def test_the_table_says_which_coefficients_and_where_from(run, options, said):
    assert said in " ".join(run(f"swim --duration 1 --all {options}").out.split())


def test_every_option_reaches_the_simulation(run):
    line = (
        "swim --robot mamba-fin --n-links 7 --gait custom --envelope 1 0.9 0.8 0.7 0.6 0.5 --amplitude-deg 25 "
        "--frequency-deg-s 100 --phase-shift-deg 35 --offset-deg 5 --duration 3 --dt 0.01 --sample-interval 0.1 "
        "--heading-deg 20 --joints pd --model planar --ramp 0.5 --offset-bandwidth 5 --water published-2015 "
        "--tangential-friction 0.2 --normal-drag 1.5 --added-mass 1.2 --added-inertia 0.5 --tangential-added-mass 0.1 "
        "--density 1025 --reference-speed 0.5 --linear --no-quadratic --current 0.1 -0.05 --depth 0.5 "
        "--added-mass-form kirchhoff --rotational strip --trailing-edge elongated --link-forces --save run.nc"
    )
    assert run(line).status == 0
    water = replace(
        lc.load_water("published-2015"),
        tangential_friction=0.2,
        normal_drag=1.5,
        added_mass=1.2,
        added_inertia=0.5,
        tangential_added_mass=0.1,
        density=1025.0,
        drag=PolynomialDrag(reference_speed=0.5, quadratic=False),
        current=(0.1, -0.05),
        depth=0.5,
        added_mass_form="kirchhoff",
        rotational="strip",
        trailing_edge="elongated",
    )
    gait = lc.custom_gait(
        envelope=[1, 0.9, 0.8, 0.7, 0.6, 0.5],
        amplitude=math.radians(25),
        frequency=math.radians(100),
        phase_shift=math.radians(35),
        offset=math.radians(5),
    )
    trial = lc.swim(
        lc.load_robot("mamba-fin", n_links=7),
        gait,
        3.0,
        environment=water,
        joints="pd",
        dt=0.01,
        sample_interval=0.1,
        ramp=0.5,
        offset_bandwidth=5.0,
        start=lc.Start(heading=math.radians(20)),
        link_forces=True,
    )
    stored = lc.load_trial("run.nc")
    named = replace(water, name=stored.environment.name)
    scenario = replace(trial.scenario, environment=named)
    assert stored.equals(replace(trial, scenario=scenario, created=stored.created))


def test_the_saved_file_is_the_run(run):
    found = json.loads(run(f"{PAPER} --save run.nc --json").out)
    stored = lc.load_trial("run.nc")
    trial = lc.swim(lc.load_robot("mamba"), lateral())
    assert stored.equals(replace(trial, created=stored.created))
    assert stored.forward_velocity == found["forward_velocity"]


@pytest.mark.parametrize(
    "options", ["", "--joints servo --link-forces", "--robot mamba-fin --offset-deg 8"]
)
def test_a_run_that_goes_on_from_a_file_is_the_same_as_one_that_was_never_cut(run, options):
    assert run(f"swim {options} --duration 10 --save whole.nc").status == 0
    assert run(f"swim {options} --duration 4 --save first.nc").status == 0
    assert run("swim --resume first.nc --duration 6 --save both.nc").status == 0
    whole, both = lc.load_trial("whole.nc"), lc.load_trial("both.nc")
    assert both.time.size == whole.time.size
    np.testing.assert_allclose(both.center_of_mass, whole.center_of_mass, atol=1e-12)
    np.testing.assert_allclose(both.work, whole.work, atol=1e-9)
    assert both.forward_velocity == pytest.approx(whole.forward_velocity, abs=1e-13)


def test_a_resumed_run_says_where_its_coefficients_are_from(run):
    run("swim --water paper-vortex --duration 2 --save first.nc")
    assert (
        "paper-vortex (as stored in first.nc): tangential_friction 0.1"
        in run("swim --resume first.nc --duration 1 --all").out
    )


def test_a_trial_with_a_law_of_its_own_cannot_be_resumed(run):
    trial = lc.swim(lc.load_robot("mamba"), lateral(), 1.0)
    unknown = lc.Planar(joints=JointLaw.stand_in("my-law", {}))
    replace(trial, scenario=replace(trial.scenario, model=unknown)).save("mine.nc")
    done = run("swim --resume mine.nc")
    assert done.status == 2
    assert "cannot be run here: its `my-law` is not defined" in done.err


WILD = "swim --joints prescribed --dt 0.5 --frequency-deg-s 700 --sample-interval 0.5"


def test_a_failed_run_ends_with_status_1_its_sentence_and_its_file(run):
    done = run(f"{WILD} --save wild.nc --plot wild.png")
    assert done.status == 1
    assert done.err.startswith("The run diverged at t = ")
    assert "`dt`" in done.err
    assert "FAILED" in done.out
    assert not lc.load_trial("wild.nc").succeeded
    assert Path("wild.png").stat().st_size > 10_000


def test_a_failed_run_is_still_one_json_object_without_nan(run):
    done = run(f"{WILD} --json")
    found = json.loads(done.out, parse_constant=pytest.fail)
    assert done.status == 1
    assert found["succeeded"] is False
    assert found["status"].startswith("The run diverged")


@pytest.mark.parametrize(("name", "start"), [("run.png", b"\x89PNG"), ("run.pdf", b"%PDF")])
def test_a_picture_is_drawn(run, name, start):
    assert run(f"swim --duration 5 --plot {name}").status == 0
    content = Path(name).read_bytes()
    assert content.startswith(start)
    assert len(content) > 10_000


def test_the_first_run_on_a_machine_says_that_it_compiles(run, monkeypatch):
    monkeypatch.setattr(
        "laticauda.models.simulate.needs_compiling", lambda environment, model, robot: True
    )
    done = run("swim --duration 1 --json")
    assert done.err == "compiling the kernels for this machine (once, about 10 s) ...\n"
    assert json.loads(done.out)["succeeded"]


MINE = """kind = "parameters"
name = "mine"
title = "mine"

[water]
tangential_friction = 0.2
normal_drag = 1.6
added_mass = 1.4

[eel_like.water]
tangential_friction = 0.1
"""


@pytest.mark.parametrize(
    ("gait", "friction"), [("lateral-undulation", 0.2), ("eel-like", 0.1), ("custom", 0.2)]
)
def test_a_parameter_file_gives_the_water_of_the_gait_and_the_trial_keeps_it(
    run, folder, gait, friction
):
    (folder / "mine.toml").write_text(MINE)
    envelope = "--envelope 1 1 1 1 1 1 1 1" if gait == "custom" else ""
    done = run(
        f"swim --duration 1 --gait {gait} {envelope} --parameters mine.toml --save run.nc --all"
    )
    assert done.status == 0
    said = "mine, eel_like" if gait == "eel-like" else "mine"
    assert f"water {said} (as mine.toml says): tangential_friction {friction}" in " ".join(
        done.out.split()
    )
    stored = lc.load_trial("run.nc").environment
    assert stored == lc.load_parameters("mine.toml").water(gait.replace("-", "_"))
    assert stored.tangential_friction == friction


DRIVEN = """joints = "pd"
[actuator]
proportional_gain = 12.0
[eel_like.robot]
active_power = 30.0
"""


@pytest.mark.parametrize("command", ["swim --duration 1", "follow --duration 1"])
def test_a_parameter_file_changes_the_robot_and_its_joint_law_unless_a_flag_says_otherwise(
    run, folder, command
):
    head, tables = MINE.split("[water]")
    joints, *rest = DRIVEN.splitlines(keepends=True)
    (folder / "mine.toml").write_text(f"{head}{joints}[water]{tables}{''.join(rest)}")
    assert run(f"{command} --gait eel-like --parameters mine.toml --save run.nc").status == 0
    stored = lc.load_trial("run.nc")
    assert (stored.settings["joints"], stored.environment.name) == ("pd", "mine, eel_like")
    assert {joint.actuator.proportional_gain for joint in stored.robot.joints} == {12.0}
    assert (stored.robot.active_power, stored.mean_power_kind) == (30.0, "electrical")
    assert run(f"{command} --parameters mine.toml --joints prescribed --save run.nc").status == 0
    stored = lc.load_trial("run.nc")
    assert stored.settings["joints"] == "prescribed"
    assert (stored.robot.active_power, stored.mean_power_kind) == (None, "mechanical")


def test_a_preset_of_parameters_goes_by_its_name(run):
    assert "water paper, eel_like (as paper says): tangential_friction 0.17" in " ".join(
        run("swim --duration 1 --gait eel-like --parameters paper --all").out.split()
    )


def test_single_coefficients_replace_those_of_a_parameter_file(run, folder):
    (folder / "mine.toml").write_text(MINE)
    found = json.loads(run("swim --duration 1 --parameters mine.toml --normal-drag 2 --json").out)
    assert found["environment"] == "mine with normal_drag 2"
    assert (found["coefficients"]["tangential_friction"], found["coefficients"]["normal_drag"]) == (
        0.2,
        2.0,
    )


def test_a_scenario_is_a_file_that_options_change(run):
    first = run(
        "swim --duration 2 --joints pd --heading-deg 10 --save-scenario run.toml --save first.nc"
    )
    assert first.status == 0
    assert lc.load_scenario("run.toml") == replace(
        lc.load_trial("first.nc").scenario, model=lc.Planar(joints=PD())
    )
    assert run("swim run.toml --save again.nc").status == 0
    np.testing.assert_array_equal(
        lc.load_trial("again.nc").center_of_mass, lc.load_trial("first.nc").center_of_mass
    )
    options = "--amplitude-deg 20 --normal-drag 1.5 --joints servo --n-links 5 --duration 1"
    assert run(f"swim run.toml {options} --save other.nc").status == 0
    other = lc.load_trial("other.nc").scenario
    assert (math.degrees(other.motion.amplitude), other.environment.normal_drag) == (
        pytest.approx(20.0),
        1.5,
    )
    assert (other.robot.n_links, other.model.joints, other.duration) == (5, Servo(), 1.0)
    assert run("swim none.toml").status == 2
    refused = run("swim run.toml --pitch-amplitude-deg 3")
    assert (
        refused.status,
        "--pitch-... must be None unless --model is `spatial`" in refused.err,
    ) == (2, True)


def test_a_gait_of_ones_own_in_a_scenario_file_is_typed_beside_it_and_keeps_its_numbers(
    run, folder, monkeypatch
):
    monkeypatch.setattr(lc.Envelope, "_members", dict(lc.Envelope._members))  # forgotten afterwards
    (folder / "unheard.py").write_text(
        "import laticauda as lc\nfrom laticauda.values.quantities import quantity, value_class\n\n\n@value_class\n"
        'class UnheardOf(lc.Envelope):\n    share: float = quantity("", "Of it", ge=0.0, le=1.0, default=0.9)\n\n'
        "    def __call__(self, i, n):\n        return self.share\n"
    )
    (folder / "own.toml").write_text(
        'kind = "scenario"\nrobot = "mamba"\nduration = 1.0\n\n[gait]\namplitude_deg = 30\nfrequency_deg_s = 130\n'
        'phase_shift_deg = 40\nenvelope = { kind = "unheard-of", share = 0.5 }\n'
    )
    assert "got 'unheard-of'" in run("swim own.toml").err
    done = run("swim own.toml --gait unheard:UnheardOf --json")
    assert json.loads(done.out)["gait_parameters"]["envelope"] == {"share": 0.5}


def test_a_water_that_is_named_beside_a_scenario_file_keeps_its_name(run):
    assert run("swim --duration 1 --save-scenario run.toml").status == 0
    assert (
        json.loads(run("swim run.toml --water paper-eel --json").out)["environment"] == "paper-eel"
    )


def test_robots_of_further_scenario_files_swim_in_the_same_scene(run):
    pytest.importorskip("mujoco")
    scene = "swim --model spatial --scene open --duration 0.2"
    assert run(f"{scene} --save-scenario other.toml").status == 0
    done = run(
        f"{scene} --robot mamba-fin --position 0 0.6 --beside other.toml --save two.nc --json"
    )
    found = json.loads(done.out)
    first, second = lc.load_trial("two.nc"), lc.load_trial("two-1.nc")
    assert (first.robot.name, second.robot.name) == ("mamba-fin", "mamba")
    assert found["mean_power"] == first.mean_power
    assert found["beside"][0]["mean_power"] == second.mean_power
    refused = run(
        "swim --model spatial --scene open --duration 0.3 --position 0 1 --beside other.toml"
    )
    assert (refused.status, refused.err) == (
        2,
        "laticauda: --duration must be the same for all robots in one scene.\n",
    )


def test_a_scene_that_needs_water_is_refused_on_the_ground(run):
    done = run("swim --model spatial --scene shore --ground viscous")
    said = "laticauda: --scene must not be `shore` without water, got the ground `viscous`.\n"
    assert (done.status, done.err) == (2, said)


def test_a_trial_is_saved_in_the_formats_that_convert_writes(run, folder: Path):
    for line in (
        "swim --duration 1 --save a.nc",
        "swim --duration 1 --save b.csv",
        "trial convert a.nc c.csv",
    ):
        assert run(line).status == 0
    assert (folder / "b.csv").read_bytes() == (folder / "c.csv").read_bytes()


def test_what_is_not_available_is_said_in_words_of_the_command(run):
    text = " ".join(run("swim --joints prescribed --duration 5 --all").out.split())
    assert (
        "Not available: electrical power, total power. The power of the motors is unknown: give --joints"
        in text
    )
    assert "The run must span at least" in text
    assert "`time`" not in text and "electrical_work" not in text


def test_an_interval_says_which_coefficients_were_varied(run):
    done = run("swim --robot amphibot --normal-drag 1.3 --duration 0.5 --interval")
    assert done.status == 0
    note = " ".join(done.out.split("\n\n")[-1].split())
    assert re.fullmatch(
        r"Varied within the textbook's intervals: tangential_friction, added_mass, .*beta\. All other coefficients are "
        r"taken as known\.",
        note,
    )
    assert "normal_drag" not in note


def test_in_a_current_both_speeds_stand_on_the_first_screen_and_a_swept_robot_is_told(run):
    done = run("swim --joints prescribed --current -1 0 --duration 12")
    screen = " ".join(done.out.split())
    assert " m/s over ground, " in screen and " m/s through the water " in screen
    assert "The water sweeps the robot backward: it heads " in screen
    everything = run("swim --joints prescribed --current -1 0 --duration 12 --all").out
    assert "speed through the water, straight line" in everything
    assert "costs per distance rest on the speed through the water" in " ".join(everything.split())
    facts = json.loads(run("swim --joints prescribed --current -1 0 --duration 12 --json").out)
    assert facts["forward_velocity"] > 0.7
    assert facts["speed_through_water"] < 0.3
    assert facts["joules_per_meter"] == facts["mean_power"] / facts["speed_through_water"]
    assert facts["swept"].startswith("The water sweeps the robot backward")
    still = run("swim --joints prescribed --duration 2 --all").out
    assert "through the water" not in still.split("robot")[-1]
