from dataclasses import replace

import numpy as np
import pytest

import laticauda as lc
from laticauda.errors import SimulationFailed
from laticauda.paper import efficiency_settings, run_efficiency
from laticauda.paper import runs as module


def test_every_row_of_table_1_is_what_swim_gives_at_its_setting(study):
    assert len(study.cases) == 22
    for case in study.cases:
        robot = lc.load_robot(case.group.robot)
        trial = lc.swim(robot, case.measured.gait, 30.0)  # the paper's coefficients by default
        assert case.forward_velocity[0] == trial.forward_velocity
        assert case.mechanical_power[0] == trial.mechanical_power
        vortex = lc.swim(robot, case.measured.gait, 30.0, environment=lc.load_water("paper-vortex"))
        assert case.forward_velocity[1] == vortex.forward_velocity


def test_a_curve_and_the_table_agree_where_they_meet(study):
    met = 0
    for sweep in study.sweeps:
        for case in study.cases:
            at = np.abs(sweep.values - getattr(case.measured.gait, sweep.settings.parameter)) < 1e-9
            if sweep.settings.contains(case.measured.gait) and np.any(at):
                curves = sweep.forward_velocity[:, study.settings.groups.index(case.group)]
                assert curves[:, at][:, 0] == pytest.approx(case.forward_velocity, rel=1e-9)
                met += 1
    assert met >= 12


def test_rows_that_were_not_measured_are_kept_as_predictions(study):
    rows = [case.measured for case in study.cases]
    missing = [(row.group, row.case) for row in rows if row.forward_velocity is None]
    assert missing == [("lateral undulation, without fin", 4), ("eel-like motion, without fin", 5)]
    assert len(study.measured) == 20
    assert all(np.all(np.isfinite(case.forward_velocity)) for case in study.cases)


def test_progress_counts_up_to_all_runs():
    settings = replace(efficiency_settings(), sweeps=efficiency_settings().sweeps[:1], duration=15.0)
    settings = replace(settings, sweeps=(replace(settings.sweeps[0], step=1.0),), models=settings.models[:1])
    told: list[tuple[int, int]] = []
    run_efficiency(settings, progress=lambda done, total: told.append((done, total)))
    assert [done for done, _ in told] == list(range(1, settings.n_runs + 1))
    assert {total for _, total in told} == {settings.n_runs}


def test_a_trial_that_blows_up_is_named(monkeypatch):
    def fail(*args, **settings):
        raise SimulationFailed("The run blew up at 3 s.")

    monkeypatch.setattr(module, "run", fail)
    message = r"mamba, lateral_undulation, amplitude 30, frequency 130, phase shift 40 \[deg, deg/s\], paper-lateral: "
    with pytest.raises(SimulationFailed, match=message + "The run blew up at 3 s."):
        run_efficiency(replace(efficiency_settings(), models=efficiency_settings().models[:1]))


def test_a_joint_law_that_does_not_exist_is_refused():
    with pytest.raises(ValueError, match="`joints` must be one of"):
        run_efficiency(joints="magic")


def test_a_model_that_does_not_exist_is_refused():
    with pytest.raises(ValueError, match="`model` must be one of"):
        run_efficiency(model="magic")


def test_a_set_of_coefficients_may_bring_its_own_waters(study):
    settings = efficiency_settings()
    own = replace(
        settings.models[0], waters={kind: settings.models[0].water(kind) for kind in settings.models[0].waters}
    )
    short = replace(settings, sweeps=(replace(settings.sweeps[0], step=1.0),), models=(own,))
    assert [case.forward_velocity for case in run_efficiency(short).cases] == [
        case.forward_velocity[:1] for case in study.cases
    ]
