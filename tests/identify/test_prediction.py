import json
import math
from dataclasses import replace

import campaign_scripts
import numpy as np
import pytest

import laticauda as lc
from laticauda.identify import (
    Measurement,
    PredictionBasis,
    Unknown,
    basis_of,
    fit,
    leave_out,
    load_basis,
    predict_scenario,
    with_checksum,
)
from laticauda.identify.model_error import measure_error_of_groups, measure_model_error
from laticauda.robot import Joint, Module, Robot, Section, textbook_water
from laticauda.values import SimulationFailed, TrialFileError

FRICTION, DRAG = "water.tangential_friction", "water.normal_drag"
SECTION = Section(half_height=0.05, half_width=0.05)
BODY = Robot(
    name="body",
    modules=(Module(length=0.15, mass=1.0, section=SECTION),) * 7,
    joints=(Joint(),) * 6,
)
TEXTBOOK = textbook_water(BODY)
PRIOR = Unknown(name=DRAG, prior=(TEXTBOOK.water.normal_drag, 0.15))
DURATION = 8.0


def gait(amplitude: float, frequency: float, phase_shift: float = 0.7) -> lc.Gait:
    return lc.lateral_undulation(amplitude=amplitude, frequency=frequency, phase_shift=phase_shift)


GAITS = [
    gait(alpha, omega, delta)
    for alpha, omega, delta in zip(
        (0.35, 0.45, 0.55, 0.65, 0.35, 0.45, 0.55, 0.65),
        (1.5, 2.0, 2.5, 2.0, 2.5, 1.5, 2.0, 2.5),
        (0.6, 0.7, 0.8, 0.9, 0.9, 0.8, 0.7, 0.6),
        strict=True,
    )
]
NEW = gait(0.5, 2.2, 0.75)


def rows(water=TEXTBOOK.water, *, off=0.0, sigma=0.03, figure="forward_velocity", **true):
    """Speeds in another water; every second one is off to the other side."""
    true_water = replace(TEXTBOOK.water, **({"tangential_friction": 0.05} | true))
    found = getattr(lc.swim_many(BODY, GAITS, DURATION, environments=true_water), figure)
    signs = np.where(np.arange(len(GAITS)) % 2, 1.0, -1.0)
    return [
        Measurement(
            name=f"{number}",
            scenario=lc.build_scenario(BODY, asked, DURATION, environment=water),
            figures={figure: (float(value), sigma * float(value))},
        )
        for number, (asked, value) in enumerate(
            zip(GAITS, found * np.exp(off * signs), strict=True)
        )
    ]


def scenario_of(found, asked=NEW):
    return replace(found.problem.scenarios_at(found.best)[0], motion=asked)


@pytest.fixture(scope="module")
def found():
    return fit(rows(off=0.02), parameters=[FRICTION, PRIOR], n_starts=1)


@pytest.fixture(scope="module")
def basis(found):
    return basis_of(found)


def test_a_prediction_is_the_models_with_the_fitted_numbers(found, basis):
    prediction = predict_scenario(basis, scenario_of(found))
    trial = lc.swim(scenario_of(found))
    speed, power = (prediction.figures[name] for name in ("forward_velocity", "mean_power"))
    assert speed.value == pytest.approx(trial.forward_velocity, rel=1e-6)
    assert power.value == pytest.approx(trial.mean_power, rel=1e-6)
    assert (speed.unit, power.unit) == ("m/s", "W")
    np.testing.assert_allclose(
        prediction.path.center_of_mass[-1], trial.center_of_mass[-1], atol=1e-6
    )
    assert prediction.figures["x"].value == pytest.approx(trial.center_of_mass[-1, 0], abs=1e-6)
    assert prediction.figures["heading"].shares.left_out is None


def test_the_shares_add_in_quadrature_on_the_logarithm(found, basis):
    speed = predict_scenario(basis, scenario_of(found)).figures["forward_velocity"]
    shares = speed.shares
    assert shares.left_out is not None
    whole = math.sqrt(shares.coefficients**2 + shares.held_fixed**2 + shares.left_out**2)
    assert shares.sigma == pytest.approx(whole)
    assert math.log(speed.high / speed.low) == pytest.approx(2.0 * 1.959964 * whole, rel=1e-5)


def test_what_was_held_fixed_is_refitted_and_not_varied_beside_the_fit(found, basis):
    """One linearised step is what a refit with another added mass does, to first order."""
    assert [number.name for number in basis.held_numbers] == ["water.added_mass", "water.drag.beta"]
    step = 0.02
    for j, changes in enumerate(
        (
            {"added_mass": TEXTBOOK.water.added_mass + step},
            {"drag": replace(TEXTBOOK.water.drag, beta=0.5 + step)},
        )
    ):
        water = replace(TEXTBOOK.water, **changes)
        again = fit(rows(water, off=0.02), parameters=[FRICTION, PRIOR], n_starts=1)
        refitted = (again.x - found.x) / step
        np.testing.assert_allclose(basis.following[:, j], refitted, rtol=0.1, atol=0.02)
        moved = scenario_of(again)
        before = predict_scenario(basis, scenario_of(found)).figures["forward_velocity"]
        total = math.log(lc.swim(moved).forward_velocity / before.value) / step
        alone = replace(
            basis, held_numbers=(basis.held_numbers[j],), following=basis.following[:, [j]]
        )
        share = predict_scenario(alone, scenario_of(found)).figures["forward_velocity"].shares
        assert share.held_fixed == pytest.approx(abs(total) * basis.held_numbers[j].sigma, abs=6e-4)
        beside = replace(alone, following=np.zeros((2, 1)))
        varied = predict_scenario(beside, scenario_of(found)).figures["forward_velocity"].shares
        assert varied.held_fixed > 3.0 * share.held_fixed


def test_a_number_that_was_not_in_the_middle_of_its_interval_moves_the_middle(found, basis):
    low = replace(basis.held_numbers[0], low=basis.held_numbers[0].value)
    shifted = replace(basis, held_numbers=(low, basis.held_numbers[1]))
    usual, other = (
        predict_scenario(one, scenario_of(found)).figures["forward_velocity"]
        for one in (basis, shifted)
    )
    assert other.value == usual.value
    assert other.low * other.high != pytest.approx(other.value**2, rel=1e-6)
    assert usual.low * usual.high == pytest.approx(usual.value**2, rel=1e-6)


def test_numbers_that_the_user_stated_are_known():
    water = replace(TEXTBOOK.water, added_mass=1.1)
    found = fit(rows(water), parameters=[FRICTION, DRAG], n_starts=1)
    assert [number.name for number in basis_of(found).held_numbers] == ["water.drag.beta"]
    paper = lc.load_water("paper-lateral")
    found = fit(rows(paper), parameters=[FRICTION], n_starts=1)
    basis = basis_of(found)
    assert basis.held_numbers == ()
    assert (
        predict_scenario(basis, scenario_of(found)).figures["mean_power"].shares.held_fixed == 0.0
    )


def test_the_basis_is_kept_in_json_to_the_last_digit(found, basis, tmp_path):
    table = json.loads(json.dumps(basis.to_table()))
    again = PredictionBasis.of_table(table)
    assert again.to_table() == basis.to_table()
    (tmp_path / "fit.json").write_text(json.dumps({"prediction": table}))
    assert load_basis(tmp_path).to_table() == basis.to_table()


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (None, "must be the folder that `laticauda identify` wrote"),
        ("{", "cannot be read"),
        ("[]", "holds no basis of predictions"),
        ('{"prediction": null}', "holds no basis of predictions"),
        ('{"prediction": {"fitted": []}}', "is not what laticauda wrote"),
        ('{"prediction": 3}', "holds no basis of predictions"),
    ],
)
def test_other_folders_are_rejected(tmp_path, text, says):
    if text is not None:
        (tmp_path / "fit.json").write_text(text)
    with pytest.raises(TrialFileError, match=says):
        load_basis(tmp_path)


def test_a_basis_that_was_damaged_is_rejected(basis, tmp_path):
    file = tmp_path / "fit.json"
    file.write_text(json.dumps(with_checksum({"prediction": basis.to_table()}), indent=2))
    assert load_basis(tmp_path).to_table() == basis.to_table()
    file.write_text(file.read_text().replace("duration", "durations", 1))
    with pytest.raises(TrialFileError, match=r"fit\.json: it is damaged: its checksum is wrong"):
        load_basis(tmp_path)


def test_noise_that_nobody_stated_is_not_taken_off():
    measured = rows(off=0.06)
    assumed = [replace(row, assumed="It was assumed.") for row in measured]
    stated, unstated = (
        basis_of(fit(data, parameters=[FRICTION, PRIOR], n_starts=1))
        for data in (measured, assumed)
    )
    sizes = [one.left_out["forward_velocity"].by_measurement for one in (stated, unstated)]
    assert sizes[0].size is not None
    assert sizes[1].size is not None
    assert sizes[0].size < sizes[1].size
    assert sizes[0].explained == pytest.approx(0.03, rel=0.2)
    assert unstated.assumed == ("It was assumed.",)


def test_estimated_noise_counts_as_students_t():
    found = fit(rows(off=0.02), parameters=[FRICTION, PRIOR], n_starts=1, noise="estimated")
    basis = basis_of(found)
    degrees = found.degrees_of_freedom
    np.testing.assert_allclose(basis.covariance, found.covariance * degrees / (degrees - 2.0))


def test_another_kind_of_gait_is_off_like_a_group(found, basis):
    eel = lc.eel_like(amplitude=0.8, frequency=2.2, phase_shift=0.75)
    prediction = predict_scenario(basis, scenario_of(found, eel))
    assert any(note.startswith("No trial was of eel-like motion") for note in prediction.notes)
    assert any("amplitude of 45.84 deg is beyond" in note for note in prediction.notes)
    assert predict_scenario(basis, scenario_of(found)).notes == ()
    errors = basis.left_out["forward_velocity"]
    group = replace(errors.by_measurement, size=0.2)
    grouped = replace(basis, left_out={"forward_velocity": replace(errors, by_group=group)})
    shares = predict_scenario(grouped, scenario_of(found, eel)).figures["forward_velocity"].shares
    assert shares.left_out == 0.2
    own = predict_scenario(grouped, scenario_of(found)).figures["forward_velocity"].shares
    assert own.left_out == errors.by_measurement.size


def test_groups_that_were_left_out_count(found):
    half = [
        replace(row, group="a" if number < 4 else "b")
        for number, row in enumerate(found.problem.measurements)
    ]
    split = fit(half, parameters=[FRICTION, PRIOR], n_starts=1)
    errors = basis_of(split, leave_out(split, "group")).left_out["forward_velocity"]
    assert errors.by_group is not None
    assert errors.by_group.degrees == 1.0


def test_a_number_that_nothing_determines_is_refused(found, basis):
    open_basis = replace(basis, covariance=np.diag([math.inf, 1.0]))
    with pytest.raises(ValueError, match=f"it says nothing of `{FRICTION}`; give it a prior"):
        predict_scenario(open_basis, scenario_of(found))


def test_a_number_of_one_group_alone_is_refused():
    measured = [replace(row, group="mine") for row in rows()]
    found = fit(measured, parameters=[f"mine.{FRICTION}"], n_starts=1)
    with pytest.raises(ValueError, match="must hold for other trials"):
        basis_of(found)


@pytest.mark.usefixtures("limit_case")
def test_a_run_that_blows_up_is_no_prediction(found, basis):
    wild = replace(NEW, frequency=400.0)
    with pytest.raises(SimulationFailed):
        predict_scenario(basis, scenario_of(found, wild))


def test_paths_have_an_error_too():
    """The distance along the path is what counts; where the trial began is another unknown."""
    scenario = lc.build_scenario(BODY, GAITS[0], DURATION, environment=TEXTBOOK.water)
    measured = []
    for number, asked in enumerate(GAITS[:5]):
        own = replace(scenario, motion=asked)
        true = replace(own, environment=replace(TEXTBOOK.water, tangential_friction=0.05))
        trial = lc.swim(true)
        path = (trial.center_of_mass[::10], 0.003)
        measured.append(
            Measurement(
                name=f"{number}",
                scenario=own,
                time=trial.time[::10],
                series={"center_of_mass": path},
            )
        )
    found = fit(measured, parameters=[FRICTION], n_starts=1)
    basis = basis_of(found)
    assert [number.name for number in basis.fitted] == [FRICTION]
    error = basis.left_out["forward_velocity"].by_measurement
    assert error.degrees == pytest.approx(4.0)
    assert error.size is not None
    assert predict_scenario(basis, scenario_of(found)).figures["forward_velocity"].shares.left_out


def test_the_models_own_error_is_found_on_average():
    """Whatever the noise: the mean variance is that of the model, for enough numbers."""
    rng = np.random.default_rng(1)
    n = 40
    sizes = []
    for _ in range(300):
        off = rng.normal(0.0, math.hypot(0.03, 0.04), n)
        one = measure_model_error(off, np.zeros(n), np.full(n, 0.03))
        assert one.size is not None
        sizes.append(one.size**2)
    assert math.sqrt(np.mean(sizes)) == pytest.approx(0.04, rel=0.05)


def test_few_numbers_do_not_prove_a_model_right():
    exact = measure_model_error(np.zeros(6), np.zeros(6), np.full(6, 0.03))
    assert exact.size == pytest.approx(0.03 * math.sqrt(2.0 / 4.0))
    nearly = measure_model_error(np.full(6, 1e-4), np.zeros(6), np.full(6, 0.03))
    assert nearly.size == pytest.approx(exact.size, rel=1e-3)
    assert measure_model_error(np.zeros(2), np.zeros(2), np.zeros(2)).size is None
    without_noise = measure_model_error(np.full(6, 0.02), np.zeros(6), np.zeros(6))
    assert without_noise.size == pytest.approx(0.02 * math.sqrt(6.0 / 4.0))


def test_groups_need_to_be_two():
    off, noise = np.full(4, 0.05), np.full(4, 0.03)
    assert measure_error_of_groups(off, noise, 1) is None
    assert measure_error_of_groups(np.full(4, np.nan), noise, 2) is None
    two = measure_error_of_groups(off, noise, 2)
    assert two is not None
    assert two.size == pytest.approx(0.04)
    four = measure_error_of_groups(off, noise, 4)
    assert four is not None
    assert four.size is not None
    assert four.size > 0.04


twin = campaign_scripts.campaign("predict_twin")


def test_the_answer_of_the_campaign_is_what_its_table_says():
    stored = twin.stored(twin.FILE, twin.Row)
    answer = [line.rstrip() for line in twin.describe(stored).splitlines()]
    for line in answer:
        assert line in twin.__doc__, line
    for kind, least, most in (("right", 0.93, 1.0), ("error", 0.93, 0.97)):
        own = [row for row in stored if row.fault == kind]
        share = sum(row.holds("known") for row in own) / len(own)
        assert least <= share <= most, kind


def test_a_slice_of_the_campaign_is_as_stored():
    stored = {(row.fault, row.seed): row for row in twin.stored(twin.FILE, twin.Row)}
    for kind in ("right", "error"):
        again = twin.run(kind, 1)
        kept = stored[kind, 1]
        for name in ("speed", "known_low", "known_value", "known_high"):
            assert getattr(again, name) == pytest.approx(getattr(kept, name), rel=1e-4), name
