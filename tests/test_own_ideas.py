"""A law of each kind in a module outside the package, driven through everything that knows laws."""

import importlib.util
import json
import sys
from dataclasses import replace

import numpy as np
import pytest

import laticauda as lc
from laticauda.cli import main
from laticauda.connect import Session, export_fmu
from laticauda.identify import fit, from_trial
from laticauda.models.simulate import compute_sensitivities, list_parameters
from laticauda.models.simulate.numbers import change_parameters
from laticauda.motion.gaits import Envelope, Gait, LateralUndulation
from laticauda.motion.joints import JointLaw
from laticauda.robot import Water, from_toml, to_toml
from laticauda.scenarios import build_scenario
from laticauda.values.codec import decode, encode
from laticauda.water.fluid import DragLaw

pytestmark = pytest.mark.slow

# The laws of the docs, letter by letter: the kernels are compiled for a formula once, whoever holds
# it.
MODULE = '''
from laticauda.motion.joints import JointLaw
from laticauda.water.fluid import DragLaw
from laticauda.motion.gaits import Envelope
from laticauda.values.quantities import quantity, value_class
from laticauda.values.scalars import magnitude


@value_class
class Carangiform(Envelope):
    """A stiff head, and a wave in the rest."""

    share: float = quantity("", "Of the body that is stiff", ge=0.0, le=1.0, default=0.25)

    def __call__(self, i, n):
        return max(0.0, 1.0 - i / n - self.share)


@value_class
class WashedDrag(DragLaw):
    """Drag along that sees the sideways speed, drag across that sees the speed ahead."""

    wash: float = quantity("", "Share of the sideways speed that the drag along sees", ge=0.0, default=0.2)
    floor: float = quantity("m/s", "Speed below which drag is linear", ge=0.0, default=0.1)

    def __call__(self, v_t, v_n, across, rate, element):
        f_t = -element.c_t * v_t * (self.floor + magnitude(v_t) + self.wash * across)
        f_n = -element.c_n * v_n * (self.floor + magnitude(v_n))
        return f_t, f_n, -element.lambda_3 * magnitude(rate) * rate


@value_class
class Spring(JointLaw):
    """A spring to the reference, and a damper to its rate."""

    stiffness: float = quantity("N m/rad", "k", gt=0.0, default=30.0)
    damping: float = quantity("N m s/rad", "d", ge=0.0, default=3.0)

    def __call__(self, angle, rate, reference, reference_rate, reference_acceleration, drive):
        torque = self.stiffness * (reference - angle) + self.damping * (reference_rate - rate)
        return torque, self.stiffness, self.damping
'''
GROUPS = ((Envelope, "carangiform"), (DragLaw, "washed-drag"), (JointLaw, "spring"))
ROBOT, STILL = lc.load_robot("mamba"), lc.load_water("paper-lateral")


@pytest.fixture(scope="module")
def ideas(tmp_path_factory):
    file = tmp_path_factory.mktemp("elsewhere") / "ideas.py"
    file.write_text(MODULE)
    spec = importlib.util.spec_from_file_location("ideas", file)
    module = importlib.util.module_from_spec(spec)
    sys.modules["ideas"] = module
    spec.loader.exec_module(module)
    yield module
    for group, name in GROUPS:
        del group._members[name]
    del sys.modules["ideas"]


@pytest.fixture(scope="module")
def gait(ideas):
    return Gait(
        envelope=ideas.Carangiform(share=0.2), amplitude=0.5, frequency=2.0, phase_shift=0.7
    )


@pytest.fixture(scope="module")
def water(ideas):
    return replace(STILL, drag=ideas.WashedDrag(wash=0.3, floor=0.5))


def test_each_is_known_by_its_name_and_goes_through_files(ideas, gait, water):
    for group, name in GROUPS:
        assert name in group.names()
    assert gait.kind == "carangiform"
    assert decode(Gait, encode(gait)) == gait
    assert from_toml(to_toml(water), Water) == water


def test_they_swim_and_their_numbers_count(ideas, gait, water):
    how = {"duration": 3.0, "joints": ideas.Spring(), "environment": water}
    usual = lc.swim(ROBOT, gait, **how)
    assert usual.succeeded
    assert usual.settings["joints"] == "spring"
    changes = [
        how | {"joints": ideas.Spring(stiffness=10.0)},
        how | {"environment": replace(water, drag=ideas.WashedDrag(wash=0.6, floor=0.5))},
        how | {"environment": replace(water, drag=ideas.WashedDrag(wash=0.3, floor=0.2))},
    ]
    speeds = [lc.swim(ROBOT, gait, **one).forward_velocity for one in changes]
    speeds.append(
        lc.swim(ROBOT, replace(gait, envelope=ideas.Carangiform(share=0.5)), **how).forward_velocity
    )
    assert all(abs(speed / usual.forward_velocity - 1.0) > 1e-3 for speed in speeds)


def test_a_batch_of_other_numbers_is_that_of_single_runs_to_rounding(ideas, gait, water):
    laws = [ideas.WashedDrag(wash=0.1 * i, floor=0.3) for i in range(5)]
    waters = [replace(water, drag=law) for law in laws]
    how = {"joints": ideas.Spring(stiffness=25.0)}
    swims = lc.swim_many(ROBOT, gait, 2.0, environments=waters, **how)
    singles = [lc.swim(ROBOT, gait, 2.0, environment=one, **how) for one in waters]
    speeds = [single.forward_velocity for single in singles]
    np.testing.assert_allclose(swims.forward_velocity, speeds, rtol=1e-14)


def test_the_model_in_space_agrees_with_that_in_the_plane(ideas, gait, water):
    pytest.importorskip("mujoco")
    how = {"environment": water, "joints": ideas.Spring(), "dt": 0.001}
    planar = lc.swim(ROBOT, gait, 2.0, **how)
    spatial = lc.swim(ROBOT, gait, 2.0, model="spatial", root="planar", **how)
    length = np.linalg.norm(planar.center_of_mass[-1])
    np.testing.assert_allclose(
        spatial.center_of_mass[:, :2], planar.center_of_mass, atol=1e-3 * length
    )


def test_sweeps_know_their_numbers(ideas, gait, water):
    own = build_scenario(ROBOT, gait, 2.0, environment=water, joints=ideas.Spring())
    known = list_parameters(own)
    assert {
        "water.drag.wash",
        "water.drag.floor",
        "gait.envelope.share",
        "joints.stiffness",
    } <= known.keys()
    assert known["water.drag.floor"].unit == "m/s"
    assert change_parameters(own, {"joints.stiffness": 12.0}).model.joints == ideas.Spring(
        stiffness=12.0
    )


def test_the_derivatives_to_their_numbers_are_those_of_differences(ideas, gait, water):
    how = {"joints": ideas.Spring(), "dt": 0.002}
    names = ["water.drag.wash", "water.drag.floor", "joints.stiffness"]
    found = compute_sensitivities(ROBOT, gait, 2.0, environments=water, names=names, **how)
    own = build_scenario(ROBOT, gait, 2.0, environment=water, **how)
    ends = [change_parameters(own, {"joints.stiffness": 30.0 + step}) for step in (1e-3, -1e-3)]
    up, down = lc.swim_many(ends).forward_velocity
    assert found.of("forward_velocity", "joints.stiffness")[0] == pytest.approx(
        (up - down) / 2e-3, rel=1e-4
    )
    for name in names[:2]:
        field, step = name.rsplit(".", 1)[1], 1e-5
        value = getattr(water.drag, field)
        ends = [
            replace(water, drag=replace(water.drag, **{field: value + s})) for s in (step, -step)
        ]
        up, down = lc.swim_many(ROBOT, gait, 2.0, environments=ends, **how).forward_velocity
        assert found.of("forward_velocity", name)[0] == pytest.approx(
            (up - down) / (2.0 * step), rel=1e-5
        )


def test_a_fit_finds_their_numbers_and_its_parameter_file_keeps_them(ideas, gait, water, tmp_path):
    how = {"joints": ideas.Spring(stiffness=25.0), "dt": 0.002}
    truth = {"water.drag.wash": 0.3, "water.drag.floor": 0.5, "joints.stiffness": 25.0}
    trial = lc.swim(ROBOT, gait, 4.0, environment=water, **how)
    measured = from_trial(
        trial, name="own", series={"center_of_mass": 0.001, "joint_angle": 0.01}, every=4
    )
    elsewhere = replace(water, drag=ideas.WashedDrag(wash=0.2, floor=0.4))
    measured = replace(measured, scenario=replace(measured.scenario, environment=elsewhere))
    found = fit([measured], parameters=list(truth), joints=ideas.Spring(), dt=0.002, n_starts=1)
    assert {name: found.values[name] for name in truth} == pytest.approx(truth, rel=1e-4)
    found.parameters("own", "our own laws").save(tmp_path / "own.toml")
    kept = lc.load_parameters(tmp_path / "own.toml")
    assert kept.every_gait.drag == ideas.WashedDrag(
        wash=found.values["water.drag.wash"], floor=found.values["water.drag.floor"]
    )
    assert kept.joints == ideas.Spring(stiffness=found.values["joints.stiffness"])


def test_an_fmu_has_their_numbers_as_parameters(ideas, gait, water, tmp_path):
    own = build_scenario(ROBOT, gait, 2.0, environment=water, joints=ideas.Spring())
    variables = {v.name: v for v in export_fmu(tmp_path / "own.fmu", own)}
    assert variables["water.drag.wash"].start == 0.3
    assert variables["water.drag.floor"].unit == "m/s"
    assert variables["water.drag.floor"].least == 0.0
    assert variables["joints.stiffness"].start == 30.0
    fmpy = pytest.importorskip("fmpy", exc_type=ImportError)
    numbers = {"water.drag.wash": 0.1, "joints.stiffness": 20.0}
    seen = fmpy.simulate_fmu(
        str(tmp_path / "own.fmu"), stop_time=2.0, output_interval=0.05, start_values=numbers
    )
    trial = lc.swim(change_parameters(own, numbers))
    assert seen["center_of_mass.x"][-1] == pytest.approx(trial.center_of_mass[-1, 0], rel=1e-9)
    assert seen["heading"][-1] == pytest.approx(trial.heading[-1], rel=1e-9)


def test_another_program_drives_them_over_tcp(ideas, gait, water):
    session = Session()
    own = {
        "robot": "mamba",
        "water": "paper-lateral",
        "gait": {"amplitude": 0.5, "frequency": 2.0, "phase_shift": 0.7}
        | {"envelope": {"kind": "carangiform", "share": 0.2}},
        "joints": {"kind": "spring", "stiffness": 25.0},
        "coefficients": {"drag": {"kind": "washed-drag", "wash": 0.3, "floor": 0.5}},
    }

    def ask(request, **fields):
        return json.loads(session.answer(json.dumps({"do": request, **fields}).encode()))

    trial = lc.swim(ROBOT, gait, 2.0, environment=water, joints=ideas.Spring(stiffness=25.0))
    assert ask("run", duration=2.0, **own)["figures"] == trial.summary()
    assert ask("reset", **own)["settings"]["joints"] == "spring"
    assert ask("step", duration=0.1, gait={"envelope": {"share": 0.3}})["observation"][
        "time"
    ] == pytest.approx(0.1)
    assert ask("get")["command"]["gait"]["envelope"] == {"share": 0.3}


def test_they_are_learnt_with_in_gymnasium(ideas, gait, water):
    environments = pytest.importorskip("laticauda_gym.environments")
    who = {
        "robot": "mamba",
        "gait": gait,
        "environment": water,
        "joints": ideas.Spring(),
        "duration": 2.0,
    }
    env = environments.SwimmingEnv("PathFollowing", **who)
    env.reset(options={"y": 0.0, "heading": 0.0, "current_speed": 0.0})
    for _ in range(env.task.n_steps):
        info = env.step(np.zeros(1))[-1]
    trial = lc.swim(env.task.scenario)
    assert trial.scenario.model.joints == ideas.Spring()
    np.testing.assert_allclose([info["x"], info["y"]], trial.center_of_mass[-1], atol=1e-12)


def test_the_page_shows_and_chooses_them(ideas, gait, water):
    pytest.importorskip("viser")
    from laticauda.show.cockpit import Cockpit, Live

    own = build_scenario(ROBOT, gait, environment=water, joints=ideas.Spring(stiffness=25.0))
    page = Cockpit(Live(replace(own, motion=replace(gait, envelope=LateralUndulation()))), port=0)
    try:
        controls = page._controls.by_name
        assert (
            "carangiform" in controls["kind"].handle.options
            and "spring" in controls["joints"].handle.options
        )
        page.live.alter(**controls["kind"].change("carangiform"))
        page.live.advance(0.2)
        assert (
            page.live.scenario.gait.kind
            == controls["kind"].read(page.live.scenario)
            == "carangiform"
        )
        page.live.alter(**controls["joints"].change("spring"))
        page.live.advance(0.2)
        assert page.live.scenario.model.joints == ideas.Spring()
        assert page.live.scenario.environment.drag == water.drag
        assert page.live.simulation.failure is None
    finally:
        page.close()


LINE = "--robot mamba --gait ideas:Carangiform --law ideas:WashedDrag --joints ideas:Spring --duration 2"


def test_the_command_line_drives_stores_and_resumes_them(ideas, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert (
        main(
            f"swim {LINE} --stiffness 25 --wash 0.4 --save own.nc --save-scenario own.toml".split()
        )
        == 0
    )
    stored = lc.load_trial("own.nc")
    assert stored.scenario.environment.drag == ideas.WashedDrag(wash=0.4)
    assert stored.scenario.model.joints == ideas.Spring(stiffness=25.0)
    assert stored.gait.kind == "carangiform"
    np.testing.assert_array_equal(lc.swim(stored.scenario).center_of_mass, stored.center_of_mass)
    written = lc.load_scenario("own.toml")
    assert (written.environment, written.model.joints) == (
        stored.scenario.environment,
        stored.scenario.model.joints,
    )
    assert main(f"swim own.toml {LINE.removeprefix('--robot mamba')} --save same.nc".split()) == 0
    assert lc.load_trial("same.nc").scenario == stored.scenario
    assert main("swim --resume own.nc --duration 1 --save on.nc".split()) == 0
    assert lc.load_trial("on.nc").time[-1] == pytest.approx(3.0)
    assert (
        main(
            f"sweep {LINE} --vary water.drag.wash=0:0.4:2 joints.stiffness=20,30 --output swept".split()
        )
        == 0
    )
    assert "4 trials" in capsys.readouterr().out


def test_a_file_shows_the_laws_of_those_who_are_not_here(ideas, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(f"swim {LINE} --stiffness 25 --wash 0.4 --save own.nc".split()) == 0
    for group, name in GROUPS:
        monkeypatch.delitem(group._members, name)
    capsys.readouterr()
    assert main("trial show own.nc --json".split()) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["coefficients"]["drag"] == {"kind": "washed-drag", "wash": 0.4, "floor": 0.1}
    assert found["gait_parameters"]["envelope"]["kind"] == "carangiform"
    for line in (
        "trial show own.nc",
        "trial plot own.nc --output own.png",
        "trial convert own.nc own.csv",
    ):
        assert main(line.split()) == 0


def test_a_run_goes_on_with_its_laws(ideas, gait, water):
    body = lc.build_plant(ROBOT, water, joints=ideas.Spring(), ramp=0.0)
    whole = lc.run(body, lc.OpenLoop(command=lc.Command(gait=gait)), 2.0)
    half = lc.run(body, lc.OpenLoop(command=lc.Command(gait=gait)), 1.0)
    after = lc.resume(body, half, 1.0)
    np.testing.assert_array_equal(after.center_of_mass[-1], whole.center_of_mass[-1])


def test_a_law_that_cannot_be_compiled_says_why(ideas):
    class Broken(ideas.Spring):
        def __call__(self, angle, rate, reference, reference_rate, reference_acceleration, drive):
            return self.words, drive.nothing, 0.0

    try:
        with pytest.raises(
            ValueError,
            match=r"`Broken` must have a formula that Numba can compile: Unknown attribute",
        ):
            lc.build_plant(ROBOT, STILL, joints=Broken())
    finally:
        del JointLaw._members["broken"]
