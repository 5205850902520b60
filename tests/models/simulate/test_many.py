import re
import signal
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest

import laticauda as lc
from laticauda.models.simulate import build_plant
from laticauda.motion.gaits.gait import Wave
from laticauda.robot import Tether, load_robot, load_water
from laticauda.scenarios.interfaces import Command
from laticauda.studies.point_trials import labels_of
from laticauda.water.fluid.laws import FunctionDrag

FIGURES = (
    "forward_velocity",
    "steady_velocity",
    "speed_through_water",
    "steady_speed_through_water",
    "mechanical_power",
    "net_power",
    "positive_power",
    "mean_power",
    "cost_of_transport",
)
GAIT = lc.lateral_undulation(amplitude=0.5, frequency=2.0, phase_shift=0.7)
MAMBA = load_robot("mamba")


def random_trials(seed, n):
    """Robots of three shapes, gaits of both kinds, waters with currents, starts."""
    rng = np.random.default_rng(seed)
    shapes = [
        MAMBA,
        load_robot("mamba-fin"),
        replace(MAMBA, modules=MAMBA.modules[:5], joints=MAMBA.joints[:4]),
    ]
    kinds = [lc.lateral_undulation, lc.eel_like]
    robots = [
        replace(shapes[rng.integers(3)], tether=Tether(drag=float(rng.choice([0.0, 1.0]))))
        for _ in range(n)
    ]
    gaits = [
        kinds[rng.integers(2)](
            amplitude=rng.uniform(0.1, 0.7),
            frequency=rng.uniform(1.3, 3.0),
            phase_shift=rng.uniform(0.3, 1.0),
            offset=rng.uniform(-0.1, 0.1),
        )
        for _ in range(n)
    ]
    waters = [
        replace(
            load_water("paper-lateral"),
            current=tuple(rng.uniform(-0.1, 0.1, 2)),
            normal_drag=rng.uniform(1.0, 2.0),
            added_mass_form=str(rng.choice(["relative", "kirchhoff", "classic"])),
        )
        for _ in range(n)
    ]
    starts = [
        lc.Start(heading=rng.uniform(-3, 3), center_of_mass=tuple(rng.uniform(-5.0, 5.0, 2)))
        for _ in range(n)
    ]
    return robots, gaits, waters, starts


def check(swims, i, trial):
    """Trial i of a batch is this trial."""
    assert swims.succeeded[i] == trial.succeeded
    assert swims.status[i] == trial.status
    for name in FIGURES:
        assert getattr(swims, name)[i] == pytest.approx(getattr(trial, name), rel=1e-10), name
    np.testing.assert_allclose(
        swims.center_of_mass[i], trial.center_of_mass[-1], rtol=0, atol=1e-10
    )
    assert swims.heading[i] == pytest.approx(trial.heading[-1], abs=1e-10)


@pytest.mark.parametrize(
    ("joints", "n", "duration"), [("prescribed", 19, 16.0), ("pd", 3, 16.0), ("servo", 3, 16.0)]
)
def test_a_batch_gives_what_single_trials_give(joints, n, duration):
    robots, gaits, waters, starts = random_trials(1, n)
    swims = lc.swim_many(robots, gaits, duration, environments=waters, starts=starts, joints=joints)
    assert len(swims) == n
    for i in range(n):
        trial = lc.swim(
            robots[i], gaits[i], duration, environment=waters[i], start=starts[i], joints=joints
        )
        check(swims, i, trial)


@pytest.mark.parametrize("threads", [1, 2, 3])
def test_neighbors_order_and_threads_do_not_matter(threads):
    robots, gaits, waters, starts = random_trials(2, 21)
    rng = np.random.default_rng(threads)
    whole = lc.swim_many(robots, gaits, 12.0, environments=waters, starts=starts)
    order = rng.permutation(21)[: 5 + 7 * threads]
    some = lc.swim_many(
        [robots[i] for i in order],
        [gaits[i] for i in order],
        12.0,
        environments=[waters[i] for i in order],
        starts=[starts[i] for i in order],
        threads=threads,
    )
    for name in (*FIGURES, "center_of_mass", "heading", "succeeded"):
        np.testing.assert_array_equal(getattr(some, name), getattr(whole, name)[order])


@pytest.mark.usefixtures("limit_case")
def test_a_trial_that_diverges_does_not_disturb_the_others():
    gaits = [
        lc.lateral_undulation(amplitude=a, frequency=2.0, phase_shift=0.7)
        for a in np.linspace(0.2, 0.6, 8)
    ]
    water = load_water("paper-lateral")
    wild = [replace(water, normal_drag=1e4) if i in (2, 7) else water for i in range(8)]
    calm = lc.swim_many(MAMBA, gaits, 12.0, environments=water, dt=0.05)
    swims = lc.swim_many(MAMBA, gaits, 12.0, environments=wild, dt=0.05)
    assert swims.succeeded.tolist() == [True, True, False, True, True, True, True, False]
    for name in FIGURES:
        assert np.isnan(getattr(swims, name)[[2, 7]]).all()
        np.testing.assert_array_equal(
            getattr(swims, name)[swims.succeeded], getattr(calm, name)[swims.succeeded]
        )
    for i in (2, 7):
        single = lc.swim(MAMBA, gaits[i], 12.0, environment=wild[i], dt=0.05)
        assert swims.status[i] == single.status
        assert "The run diverged at t = " in swims.status[i]


@pytest.mark.usefixtures("limit_case")
@pytest.mark.parametrize("model", ["planar", "spatial"])
def test_a_batch_says_how_many_trials_failed_and_how_many_the_robot_cannot_do(model):
    gaits = [replace(GAIT, frequency=frequency) for frequency in (1.0, 4.0, 1e6)]
    scenarios = [lc.build_scenario(MAMBA, gait, 3.0, model=model, dt=0.05) for gait in gaits[:2]]
    if model == "planar":
        scenarios.append(lc.build_scenario(MAMBA, gaits[2], 3.0, dt=0.05))
    swims = lc.swim_many(scenarios, feasibility=True)
    singles = [lc.swim(scenario) for scenario in scenarios[:2]]
    np.testing.assert_allclose(
        swims.utilization[:2], [trial.utilization for trial in singles], rtol=1e-9
    )
    n_infeasible = sum(trial.utilization > 1.0 for trial in singles)
    assert f"<Swims of {len(scenarios)} trials: " in repr(swims)
    assert f"{n_infeasible or 'none'} of them demand more than the robot offers>" in repr(swims)
    if model == "planar":
        assert np.isnan(swims.utilization[2])
        assert " W; 1 failed; " in repr(swims)
    assert list(swims.to_dataset().utilization.values[:2]) == list(swims.utilization[:2])
    unasked = lc.swim_many(scenarios)
    assert unasked.utilization is None
    assert "utilization" not in unasked.to_dataset()
    assert "counted with feasibility=True>" in repr(unasked)


def test_runs_of_many_samples_are_marched_in_parts_without_a_seam():
    gaits = [GAIT, replace(GAIT, amplitude=0.3)]
    swims = lc.swim_many(MAMBA, gaits, 15.0, sample_interval=0.006)
    for i, gait in enumerate(gaits):
        check(swims, i, lc.swim(MAMBA, gait, 15.0, sample_interval=0.006))


@pytest.mark.usefixtures("limit_case")
def test_a_long_run_whose_whole_block_diverges_early_has_no_figures():
    water = replace(load_water("paper-lateral"), normal_drag=1e4)
    choices = {"dt": 0.05, "sample_interval": 0.005}
    swims = lc.swim_many(MAMBA, [GAIT], 30.0, environments=water, **choices)
    assert swims.status[0] == lc.swim(MAMBA, GAIT, 30.0, environment=water, **choices).status
    assert np.isnan(swims.forward_velocity[0])


def test_a_law_that_branches_works_in_a_batch():
    def make_law(factor):  # that of the docs, so that its kernel for single runs is compiled once
        def law(v_t, v_n, across, rate, element):
            if v_n > 0.0:
                return -element.c_t * v_t, -element.c_n * v_n, -element.lambda_2 * rate
            return -element.c_t * v_t, -factor * element.c_n * v_n, -element.lambda_2 * rate

        return law

    water = replace(lc.load_water("paper-lateral"), drag=FunctionDrag(function=make_law(2.0)))
    gaits = [GAIT, replace(GAIT, amplitude=0.3)]
    swims = lc.swim_many(MAMBA, gaits, 14.0, environments=water)
    for i, gait in enumerate(gaits):
        check(swims, i, lc.swim(MAMBA, gait, 14.0, environment=water))


def test_figures_without_meaning_are_nan():
    still = replace(GAIT, amplitude=0.0)
    swims = lc.swim_many(MAMBA, [GAIT, still], 5.0)
    assert np.isnan([swims.steady_velocity, swims.steady_speed_through_water]).all()
    assert swims.forward_velocity[0] > 0.0
    assert np.isnan(swims.cost_of_transport[1])


def test_progress_ends_at_one():
    told = []
    lc.swim_many(MAMBA, [GAIT] * 100, 1.0, progress=told.append)
    assert told == sorted(told)
    assert told[-1] == 1.0


# ---- in space, on threads ------------------------------------------------------------------------


def in_space(n: int) -> list[lc.Scenario]:
    """Two robots in two waters, by prescribed and by pd joints, and as many more that share all but their gait."""
    pytest.importorskip("mujoco")
    robots, waters = (
        [MAMBA, load_robot("mamba-fin")],
        [load_water("paper-lateral"), load_water("paper-eel")],
    )
    gaits, law = [replace(GAIT, amplitude=0.3 + 0.02 * i) for i in range(n)], ["prescribed", "pd"]
    return [
        lc.build_scenario(
            robots[i // 2 % 2],
            g,
            1.0,
            environment=waters[i // 4 % 2],
            model="spatial",
            joints=law[i % 2],
        )
        for i, g in enumerate(gaits)
    ] + [lc.build_scenario(MAMBA, g, 1.0, environment=waters[0], model="spatial") for g in gaits]


@pytest.mark.parametrize("threads", [1, 3])
def test_spatial_trials_on_threads_have_the_bits_of_single_ones(threads):
    scenarios = [
        *in_space(8),
        lc.build_scenario(
            MAMBA, GAIT, 2.5, environment=load_water("paper-lateral"), model="spatial"
        ),
    ]
    order = np.random.default_rng(threads).permutation(len(scenarios))
    swims = lc.swim_many([scenarios[i] for i in order], threads=threads)
    assert swims.center_of_mass.shape == (len(scenarios), 3)
    for k, i in enumerate(order):
        trial = lc.swim(scenarios[i])
        assert [*swims.center_of_mass[k], swims.heading[k]] == [
            *trial.center_of_mass[-1],
            trial.heading[-1],
        ]
        assert (swims.succeeded[k], swims.status[k]) == (True, trial.status)
        for name in set(FIGURES) - {"steady_velocity", "steady_speed_through_water"}:
            assert getattr(swims, name)[k] == getattr(trial, name), name
    assert np.isnan([swims.steady_velocity, swims.steady_speed_through_water]).all()


def test_a_spatial_trial_that_cannot_be_is_named_by_its_place():
    scenarios = in_space(2)
    pitching = replace(GAIT, pitch=Wave(amplitude=0.2, frequency=2.0, phase_shift=0.5))
    scenarios[3] = replace(scenarios[3], motion=pitching)
    with pytest.raises(ValueError, match=r"`scenarios\[3\]\.gait\.pitch` must be None"):
        lc.swim_many(scenarios)
    with pytest.raises(
        ValueError, match=r"`scenarios\[2\]\.model` must be of class Spatial, got Planar"
    ):
        lc.swim_many([*scenarios[:2], replace(scenarios[2], model=lc.Planar())])
    with pytest.raises(ValueError, match="`device` must be one of `cpu`, got 'cuda'"):
        lc.swim_many(scenarios, device="cuda")


def test_an_interrupted_batch_of_spatial_trials_ends_at_once_and_leaves_no_thread():
    long = replace(in_space(1)[0], duration=50_000.0)
    before, told = threading.active_count(), []
    timer = threading.Timer(0.3, signal.pthread_kill, (threading.get_ident(), signal.SIGINT))
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        lc.swim_many([long] * 8, threads=2, progress=told.append)
    timer.join()
    assert told == []  # each of them takes minutes
    assert threading.active_count() == before


def test_a_march_in_space_does_not_freeze_what_else_the_process_does():
    body = build_plant(lc.build_scenario(MAMBA, GAIT, model="spatial"))
    command = Command(gait=GAIT)
    body.march(body.init(lc.Start(), command), command, 1.0, 1.0)
    march = threading.Thread(
        target=body.march, args=(body.init(lc.Start(), command), command, 200.0, 1.0)
    )
    march.start()
    begin = last = time.perf_counter()
    longest = 0.0
    while march.is_alive():
        lc.swim(MAMBA, GAIT, 0.1)
        now = time.perf_counter()
        longest, last = max(longest, now - last), now
    assert longest < 0.5 * (last - begin)  # with the interpreter's lock it is all of it


def test_two_threads_may_ask_one_plant_for_its_forces():
    body = build_plant(lc.build_scenario(MAMBA, GAIT, model="spatial"))
    commands = [Command(gait=replace(GAIT, amplitude=a)) for a in (0.3, 0.6)]

    def forces(command):
        return body.march(body.init(lc.Start(), command), command, 1.0, 0.02, link_forces=True)[
            1
        ].link_force["drag"]

    alone = [forces(command) for command in commands]
    with ThreadPoolExecutor(2) as pool:
        for one, other in zip(alone, pool.map(forces, commands), strict=True):
            np.testing.assert_array_equal(one, other)


def test_a_robot_may_be_given_by_its_name():
    named, given = (lc.swim_many(robot, GAIT, 3.0) for robot in ("mamba", MAMBA))
    assert named.forward_velocity == given.forward_velocity


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"robots": "mamab"}, "there is no robot preset named `mamab`; did you mean `mamba`?"),
        ({"gaits": []}, "`gaits` must hold at least one item, got none."),
        (
            {"robots": [MAMBA] * 3, "gaits": [GAIT] * 2},
            "`robots`, `gaits` must be of equal length, got 3 robots, 2 gaits.",
        ),
        ({"duration": 0.0}, "`duration` must be > 0 s, got 0.0."),
        ({"threads": 0}, "`threads` must be"),
        ({"duration": 2e5}, "`duration` must be <= 100000 s at a `sample_interval` of 0.05 s"),
        ({"gaits": None}, "`robots` must be of class Sequence, got Robot."),
        ({"robots": [MAMBA], "gaits": None}, "`robots[0]` must be of class Scenario, got Robot."),
    ],
)
def test_bad_arguments_are_refused(arguments, message):
    with pytest.raises(ValueError) as refused:
        lc.swim_many(**{"robots": MAMBA, "gaits": GAIT, **arguments})
    assert message in str(refused.value)


def test_a_device_that_no_package_brings_is_refused():
    with pytest.raises(ValueError, match=r"`device` must be one of `cpu`.*, got 'gpu'"):
        lc.swim_many(load_robot("mamba"), GAIT, 1.0, device="gpu")


def test_what_many_trials_came_to_is_a_dataset_with_the_labels_of_a_sweep():
    gaits = [replace(GAIT, amplitude=amplitude) for amplitude in (0.3, 0.5, 0.7)]
    swims = lc.swim_many(MAMBA, gaits, 3.0)
    found = swims.to_dataset().assign_coords(
        amplitude=("trial", [gait.amplitude for gait in gaits])
    )
    assert dict(found.sizes) == {"trial": 3, "axis": 2}
    for name in FIGURES:
        assert found[name].values.tolist() == pytest.approx(
            getattr(swims, name).tolist(), nan_ok=True
        )
    assert found.center_of_mass.sel(axis="y").values.tolist() == swims.center_of_mass[:, 1].tolist()
    assert found.status.values.tolist() == list(swims.status)
    labels = labels_of(lc.build_scenario(MAMBA, GAIT), ())
    shared = labels.keys() & found.variables.keys()
    assert shared == {*FIGURES, "succeeded"} - {"positive_power"}
    assert {name: found[name].attrs for name in shared} == {name: labels[name] for name in shared}
    assert found.heading.attrs["units"] == "rad" and found.center_of_mass.attrs["units"] == "m"
    assert found.heading.attrs["long_name"].endswith("at the end")


def test_the_dataset_of_trials_in_space_has_three_axes():
    swims = lc.swim_many(MAMBA, [GAIT], 0.2, model="spatial")
    assert swims.to_dataset().axis.values.tolist() == ["x", "y", "z"]


def test_fins_with_the_state_of_an_edge_swim_beside_others_as_alone():
    names = ("mamba-textbook", "mamba-identified", "mamba-textbook", "mamba-identified")
    scenarios = [lc.build_scenario("mamba-fin", GAIT, 3.0, parameters=name) for name in names]
    alone = [lc.swim(scenario).forward_velocity for scenario in scenarios]
    assert scenarios[0].environment.trailing_edge == "finite-span"
    assert scenarios[1].environment.trailing_edge == "none"
    for order in ([0, 1, 2, 3], [1, 0, 3, 2]):
        together = lc.swim_many([scenarios[i] for i in order]).forward_velocity
        assert together == pytest.approx([alone[i] for i in order], rel=1e-12)


@pytest.mark.parametrize(
    ("name", "instead"),
    [
        ("environment", "`environments`, one for all trials or one for each"),
        ("start", "`starts`, one for all trials or one for each"),
        ("current", "`environments` with that current"),
        ("parameters", "`environments` and `joints`, or scenarios in place of robots"),
    ],
)
def test_an_argument_of_a_single_run_is_refused_with_that_of_many(name, instead):
    message = f"There is no argument `{name}` for many trials: give {instead}."
    with pytest.raises(TypeError, match=re.escape(message)):
        lc.swim_many(MAMBA, [GAIT], 0.2, **{name: "paper-lateral"})
