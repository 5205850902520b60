"""Loads of many trials: those of `swim`, trial by trial, and the figures of what joints carry."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

import laticauda as lc
from laticauda.robot import Joint, Thruster
from laticauda.scenarios import Controller, VectorController
from laticauda.trials import LOAD_FIGURES
from laticauda.trials.feasibility import find_settled_samples

ALONG, LEFT, UP = range(3)
GAITS = [
    lc.lateral_undulation(amplitude_deg=amplitude, frequency_deg_s=200, phase_shift_deg=40)
    for amplitude in (15, 25, 30)
]
SERIES = ("time", "joint_force", "joint_moment", "water_force")
MAMBA = lc.load_robot("mamba")
HEAVIER = replace(
    MAMBA, modules=tuple(replace(module, mass=1.01 * module.mass) for module in MAMBA.modules)
)
MAMBA_FIN = lc.load_robot("mamba-fin")
WITH_DRIVEN_FIN = replace(MAMBA_FIN, caudal_fin=replace(MAMBA_FIN.caudal_fin, joint=Joint()))
WITH_THRUSTER = replace(
    MAMBA, thrusters=(Thruster(link=0, thrust=2.0, max_thrust=3.0, rise_time=0.2),)
)


def check_as_swim(scenarios, within=1e-12, **how):
    """Check loads and figures of many trials against those of each alone; return both."""
    swims = lc.swim_many(scenarios, link_forces=True, **how)
    trials = [lc.swim(scenario, link_forces=True) for scenario in scenarios]
    for i, trial in enumerate(trials):
        loads = swims.loads[i]
        for name in SERIES:
            expected = getattr(trial, name)
            scale = np.abs(expected).max()
            np.testing.assert_allclose(
                getattr(loads, name), expected, rtol=0.0, atol=within * scale, err_msg=name
            )
        for name, expected in trial.link_force.items():
            np.testing.assert_allclose(loads.link_force[name], expected, atol=within)
        for name in LOAD_FIGURES:
            np.testing.assert_allclose(
                getattr(swims, name)[i], getattr(trial, name), rtol=within, err_msg=name
            )
    return swims, trials


@dataclass(frozen=True)
class Turns(Controller[float]):
    """Turns to the left, to the right and so on; written for one robot."""

    gait: lc.Gait = GAITS[1]
    interval: float = 0.1
    offset: float = 0.1
    thrusts: tuple[float, ...] | None = None

    def init(self):
        return 1.0

    def step(self, state, observation):
        command = lc.Command(gait=self.gait, offset=state * self.offset, thrusts=self.thrusts)
        return -state, command


class TurnsInArrays(Turns):
    """The same, also written for arrays."""

    @classmethod
    def vectorize(cls, controllers):
        return ManyTurns(np.array([controller.offset for controller in controllers]))


class ManyTurns(VectorController):
    def __init__(self, offsets):
        self.offsets = offsets

    def step(self, observations):
        offsets = self.offsets
        self.offsets = -offsets
        return {"offset": offsets}


def scenario_of(motion, robot=MAMBA, duration=2.0, **changes):
    return lc.build_scenario(robot, motion, duration, **changes)


def prescribed():
    return [
        *map(scenario_of, GAITS),
        scenario_of(GAITS[1], HEAVIER),
        scenario_of(GAITS[1], "mamba-fin"),
    ]


CASES = {
    "prescribed": prescribed,
    "servos": lambda: [scenario_of(gait, "mamba-fin", joints="servo") for gait in GAITS],
    "ground": lambda: [
        scenario_of(gait, environment=lc.load_ground("viscous"), dt=0.005) for gait in GAITS
    ],
    "steered": lambda: [scenario_of(Turns(offset=offset)) for offset in (0.1, 0.2, -0.1)],
    "steered by arrays": lambda: [
        scenario_of(TurnsInArrays(offset=offset), "mamba-fin") for offset in (0.1, 0.2)
    ],
    "each alone": lambda: [
        scenario_of(Turns(offset=offset, thrusts=(1.0,)), WITH_THRUSTER) for offset in (0.1, 0.2)
    ],
    "steered late": lambda: [
        scenario_of(Turns(offset=offset), loop_delay=0.03, sample_interval=0.1)
        for offset in (0.1, 0.2)
    ],
}


@pytest.mark.parametrize("name", CASES)
def test_many_trials_bear_what_each_bears_alone(name):
    scenarios = CASES[name]()
    swims, trials = check_as_swim(scenarios)
    for loads, trial in zip(swims.loads, trials, strict=True):
        if name == "ground":
            assert loads.pressure_difference is None
        else:
            np.testing.assert_allclose(
                loads.pressure_difference, trial.pressure_difference, rtol=1e-12, atol=1e-9
            )
    assert max(swims.peak_bending_moment) > 0.3
    assert repr(swims.loads[0]) == f"<TrialLoads of 8 joints at {trials[0].time.size} samples>"


def test_the_tail_s_sum_equals_the_head_s_in_every_joint_of_many():
    """In a run that is so long that its log is written in two parts."""
    scenario = scenario_of(GAITS[1], duration=4.2, sample_interval=0.002)
    (loads,) = lc.swim_many([scenario], link_forces=True).loads
    trial = lc.swim(scenario)
    needed = MAMBA.modules[0].mass * acceleration_of_links(trial) - sum(loads.link_force.values())
    from_tail = -np.cumsum(needed, axis=1)[:, :-1]
    from_head = np.cumsum(needed[:, ::-1], axis=1)[:, ::-1][:, 1:]
    angle = trial.link_angle[:, :-1]
    along, left, _ = np.moveaxis(loads.joint_force, 2, 0)
    c, s = np.cos(angle), np.sin(angle)
    force = np.stack((c * along - s * left, s * along + c * left), axis=2)
    late = slice(1000, -5)  # past the ramp, without the ends of the differences
    scale = np.abs(force).max()
    assert scale > 5.0
    for sums in (from_tail, from_head):
        np.testing.assert_allclose(force[late], sums[late], atol=2e-4 * scale)


def acceleration_of_links(trial):
    """Return the accelerations of the links' middles by differences, for equal links of uniform mass."""
    half = 0.5 * trial.robot.modules[0].length * direction_of_links(trial)
    steps = half[:, 1:] + half[:, :-1]
    relative = np.concatenate((np.zeros_like(half[:, :1]), np.cumsum(steps, axis=1)), axis=1)
    middle = relative - relative.mean(axis=1, keepdims=True) + trial.center_of_mass[:, np.newaxis]
    velocity = np.gradient(middle, trial.time, axis=0)
    return np.gradient(velocity, trial.time, axis=0)


def direction_of_links(trial):
    return np.stack((np.cos(trial.link_angle), np.sin(trial.link_angle)), axis=-1)


def test_the_bending_moment_falls_to_zero_toward_both_free_ends():
    gait = lc.lateral_undulation(amplitude_deg=15, frequency_deg_s=130, phase_shift_deg=16)
    (loads,) = lc.swim_many(lc.load_robot("chain", 24), [gait], 4.0, link_forces=True).loads
    moment = np.abs(loads.joint_moment[..., UP]).max(axis=0)
    middle = int(np.argmax(moment))
    assert np.all(np.diff(moment[: middle + 1]) > 0.0)
    assert np.all(np.diff(moment[middle:]) < 0.0)
    assert max(moment[0], moment[-1]) < 0.02 * moment[middle]


def test_figures_are_the_largest_of_the_trial_s_own_loads():
    trial = lc.swim(scenario_of(GAITS[2], "mamba-fin", duration=4.0), link_forces=True)
    late = find_settled_samples(trial.time, trial.period)
    assert 10 < late.sum() < late.size - 10
    moment = trial.joint_moment[late, :, UP]
    across = trial.joint_force[late, :, LEFT]
    along = trial.joint_force[late, :, ALONG]
    for name, values in (
        ("bending_moment", moment),
        ("shear_force", across),
        ("axial_force", along),
    ):
        largest = np.abs(values).max()
        rms = np.sqrt((values**2).mean(axis=0)).max()
        assert getattr(trial, f"peak_{name}") == pytest.approx(largest, rel=1e-12)
        assert getattr(trial, f"rms_{name}") == pytest.approx(rms, rel=1e-12)
        assert 0.3 * largest < rms < largest
    # Without a skin, the drives bear all of the bending moment.
    assert trial.peak_bending_moment == pytest.approx(trial.peak_joint_torque, rel=1e-9)


def test_a_robot_of_one_link_has_no_joint_to_bear_anything():
    swims = lc.swim_many(lc.load_robot("chain", 1), [GAITS[0]], 1.0, link_forces=True)
    assert swims.peak_bending_moment[0] == 0.0
    assert swims.loads[0].joint_force.shape[1:] == (0, 3)


def test_figures_come_alone_or_with_all_samples_or_not_at_all():
    scenarios = [scenario_of(gait, duration=1.0) for gait in GAITS]
    without = lc.swim_many(scenarios)
    assert (without.loads, without.peak_shear_force) == (None, None)
    figures = lc.swim_many(scenarios, load_figures=True)
    assert figures.loads is None
    both = lc.swim_many(scenarios, link_forces=True, feasibility=True)
    for name in LOAD_FIGURES:
        np.testing.assert_array_equal(getattr(both, name), getattr(figures, name))
    np.testing.assert_array_equal(both.forward_velocity, without.forward_velocity)
    dataset = both.to_dataset()
    assert "loads" not in dataset
    assert dataset["peak_bending_moment"].attrs["units"] == "N m"
    assert "peak_bending_moment" not in without.to_dataset()


@pytest.mark.parametrize("parts", [1, 3])
def test_columns_bear_the_same(parts, monkeypatch):
    monkeypatch.setattr("laticauda.models.simulate.many.COLUMNS_AT_ONCE", 3 // parts)
    scenarios = [scenario_of(gait, duration=1.0) for gait in GAITS]
    expected = lc.swim_many(scenarios, link_forces=True)
    columns = {"gait.amplitude": [gait.amplitude for gait in GAITS]}
    swims = lc.swim_many(scenarios[0], columns=columns, link_forces=True)
    np.testing.assert_allclose(swims.rms_shear_force, expected.rms_shear_force, rtol=1e-12)
    for loads, expected_loads in zip(swims.loads, expected.loads, strict=True):
        np.testing.assert_allclose(loads.joint_force, expected_loads.joint_force, atol=1e-12)
    figures = lc.swim_many(scenarios[0], columns=columns, load_figures=True)
    np.testing.assert_array_equal(figures.peak_axial_force, swims.peak_axial_force)


def test_columns_of_a_steered_robot_bear_the_same():
    scenario = scenario_of(Turns(), duration=1.0)
    columns = {"water.normal_drag": [1.0, 2.0]}
    swims = lc.swim_many(scenario, columns=columns, link_forces=True)
    for i, drag in enumerate(columns["water.normal_drag"]):
        water = replace(scenario.environment, normal_drag=drag)
        trial = lc.swim(replace(scenario, environment=water), link_forces=True)
        np.testing.assert_allclose(swims.loads[i].joint_force, trial.joint_force, atol=1e-12)
        assert swims.peak_shear_force[i] == pytest.approx(trial.peak_shear_force, rel=1e-12)


WILD = replace(GAITS[0], amplitude=1.0, frequency=30.0)


@pytest.mark.usefixtures("limit_case")
@pytest.mark.parametrize(
    "motions", [(WILD, GAITS[0]), (Turns(gait=WILD, offset=0.01), Turns(offset=0.01))]
)
def test_a_trial_that_diverges_has_no_loads_and_does_not_disturb_the_others(motions):
    wild_motion, calm_motion = motions
    calm = scenario_of(calm_motion, joints="pd", dt=0.05, offset_bandwidth=5.0)
    wild = replace(calm, motion=wild_motion)
    swims = lc.swim_many([wild, calm], link_forces=True)
    assert swims.succeeded.tolist() == [False, True]
    assert swims.loads[0] is None
    assert np.isnan(swims.peak_bending_moment[0])
    trial = lc.swim(calm, link_forces=True)
    np.testing.assert_allclose(swims.loads[1].joint_moment, trial.joint_moment, atol=1e-12)


def test_many_in_space_bear_what_each_bears_alone():
    gait = replace(GAITS[1], pitch=lc.Wave(amplitude=0.2, frequency=2.0, phase_shift=0.5))
    scenarios = [
        scenario_of(GAITS[1], duration=0.5, model="spatial"),
        scenario_of(gait, "mamba-modules", duration=0.5, model="spatial"),
    ]
    _, trials = check_as_swim(scenarios, within=1e-15)
    joint_force = trials[1].joint_force
    across = np.hypot(joint_force[..., LEFT], joint_force[..., UP])
    assert trials[1].peak_shear_force == pytest.approx(across.max(), rel=1e-12)
    assert across.max() > 1.01 * np.abs(joint_force[..., LEFT]).max()  # it is vertical, too
    assert lc.swim_many(scenarios[:1], load_figures=True).loads is None


def test_only_the_cpu_has_loads():
    with pytest.raises(ValueError, match="`device` must be one of `cpu`, got"):
        lc.swim_many("mamba", GAITS, 1.0, device="cuda", load_figures=True)


def test_a_trial_without_loads_has_no_figures_of_them_and_says_how_to_get_them():
    trial = lc.swim(scenario_of(GAITS[0], duration=1.0))
    assert "peak_bending_moment" not in trial.summary()
    with pytest.raises(ValueError, match="swim it again with `link_forces=True`"):
        _ = trial.peak_bending_moment
    loaded = lc.swim(trial.scenario, link_forces=True)
    assert loaded.summary()["peak_bending_moment"] == loaded.peak_bending_moment
    figures = {row.figure.name: row.values for row in lc.compare(loaded, trial)}
    assert figures["rms_axial_force"] == (loaded.rms_axial_force, None)


def test_robots_in_one_scene_bear_what_each_bears_alone_in_it():
    def scenario(robot, y):
        return scenario_of(
            Turns(interval=0.25),
            robot,
            duration=0.5,
            model="spatial",
            scene="open",
            start=lc.Start(center_of_mass=(0.0, y)),
        )

    scenarios = [scenario("mamba", 0.0), scenario(WITH_DRIVEN_FIN, 1.0), scenario(HEAVIER, 2.0)]
    together = lc.swim_together(scenarios, link_forces=True)
    for trial, one in zip(together, scenarios, strict=True):
        alone = lc.swim(one, link_forces=True)
        for name in SERIES:
            expected = getattr(alone, name)
            scale = np.abs(expected).max()
            np.testing.assert_allclose(getattr(trial, name), expected, atol=1e-6 * scale)
        assert trial.peak_bending_moment == pytest.approx(alone.peak_bending_moment, rel=1e-6)
    of_fin = together[1].signals["fin_force_left"]
    assert np.abs(of_fin).max() > 0.1
    expected = lc.swim(scenarios[1], link_forces=True).signals["fin_force_left"]
    np.testing.assert_allclose(of_fin, expected, atol=1e-6 * np.abs(of_fin).max())
    assert lc.swim_together(scenarios[:2])[1].joint_force is None
