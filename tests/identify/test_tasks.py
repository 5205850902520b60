from pathlib import Path

import numpy as np
import pytest
from identify.trials import speeds

import laticauda as lc
from laticauda.identify.model import predict, scaled_jacobian
from laticauda.identify.problem import make_problem
from laticauda.identify.tasks import Task, load_task
from laticauda.values.errors import RobotFileError

EXAMPLE = Path(__file__).parents[2] / "examples" / "mamba-identified.toml"
HEAD = 'kind = "identification"\nparameters = ["water.normal_drag"]\n'


def test_the_preset_is_where_its_file_leads():
    # One Gauss-Newton step from the preset's numbers: it should stay well within their uncertainty.
    task, preset = load_task(EXAMPLE), lc.load_parameters("mamba-identified")
    put = make_problem(task.measurements, task.unknowns, threads=1, joints=preset.joints)
    values = np.array([preset.every_gait.tangential_friction, preset.joints.speed_limit])
    found, rows = predict(put, values), scaled_jacobian(put, values)
    off = (put.observed - found.values) / put.sigma
    step = np.linalg.lstsq(rows, off)[0]
    noise = np.sqrt(np.sum(off**2) / (20 - 2))
    sigma = noise * np.sqrt(np.diag(np.linalg.inv(rows.T @ rows)))
    assert np.all(np.abs(step) < 0.05 * sigma)
    assert np.mean(np.abs(found.values / put.observed - 1.0)) < 0.0505


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "key `kind`: is missing; it must be"),
        (f"format = 9\n{HEAD}", "key `format`: must be 1 to"),
        (HEAD, "key `trials`: is missing"),
        (f"{HEAD}table1 = true\nbounds = 1\n", "key `bounds`: is not known"),
        (f"{HEAD}[table1]\nsigma = -1.0\n", "key `table1.sigma`: must be"),
        (f"{HEAD}[[trials]]\nfile = 1\n", r"key `trials\[0\].file`: must be a text"),
        (f"{HEAD}[[trials]]\nname = 'x'\n", r"key `trials\[0\].file`: is missing"),
        (
            f"{HEAD}[[trials]]\nfile = 'x.nc'\nseries = 3\n",
            r"key `trials\[0\].series`: must be a table",
        ),
        (f"{HEAD}[table1]\n[fixed.water]\nlift = 1.0\n", r"key `fixed.water.lift`: is not known"),
        (f"{HEAD}[table1]\n[fixed.fins]\ndrag = 1.0\n", r"key `fixed.fins`: is not known"),
        (
            'kind = "identification"\nparameters = []\ntable1 = true\n',
            "key `parameters`: must name at least one",
        ),
        (
            'kind = "identification"\nparameters = [{name = "water.normal_drag", prior = 1}]\ntable1 = true\n',
            r"key `parameters\[0\].prior`: must be two numbers, got 1",
        ),
        (
            'kind = "identification"\nparameters = [{name = "water.normal_drag", lower = 3, upper = 2}]\n[table1]\n',
            r"key `parameters\[0\].lower` of `water.normal_drag`: must be <",
        ),
        (f"{HEAD}starts = inf\n[table1]\n", r"key `starts`: must be a whole number >= 1, got inf"),
        (f'{HEAD}joints = "stiff"\n[table1]\n', r"key `joints`: must be one of `prescribed`"),
    ],
)
def test_what_is_wrong_with_a_file_is_said_with_its_key(text, message, tmp_path):
    path = tmp_path / "task.toml"
    path.write_text(text)
    with pytest.raises(RobotFileError, match=message):
        load_task(path)


def test_what_is_fixed_reaches_every_measurement_and_the_parameter_file(tmp_path):
    path = tmp_path / "task.toml"
    path.write_text(
        f'{HEAD}links = 5\n[table1]\nfigure = "mean_power"\n[fixed.water]\nadded_mass = 1.3\n'
        "[fixed.caudal_fin]\nnormal_drag = 1.4\n"
    )
    task = load_task(path)
    assert {m.scenario.environment.added_mass for m in task.measurements} == {1.3}
    assert {
        m.scenario.robot.caudal_fin.normal_drag
        for m in task.measurements
        if m.scenario.robot.caudal_fin
    } == {1.4}
    assert {m.scenario.robot.n_links for m in task.measurements} == {5}
    measured = tuple(speeds(3, duration=4.0))
    small = Task(
        name="a",
        title="b",
        measurements=measured,
        unknowns=task.unknowns,
        base=task.base,
        options={"n_starts": 1},
    )
    kept = small.parameters(small.run(threads=1))
    assert kept.changes == {"caudal_fin": {"normal_drag": 1.4}}


def test_a_key_that_names_no_number_is_told_with_the_file(tmp_path):
    path = tmp_path / "task.toml"
    path.write_text(
        'kind = "identification"\nparameters = ["water.normal_dragg"]\n[table1]\nsigma = 0.05\n'
    )
    with pytest.raises(
        RobotFileError,
        match=r"task\.toml: key `parameters`: must name numbers of .*'water.normal_dragg'",
    ):
        load_task(path).run(threads=1)
    unknown = '{name = "water.tangential_friction", start = 0.15, lower = -1, upper = 0.5}'
    path.write_text(f'kind = "identification"\nparameters = [{unknown}]\n[table1]\nsigma = 0.05\n')
    with pytest.raises(
        RobotFileError,
        match=r"task\.toml: key `lower` of `water.tangential_friction`: must be in its",
    ):
        load_task(path).run(threads=1)
    path.write_text(path.read_text().replace("-1", "0.03"))
    with pytest.raises(ValueError, match=r"^`threads` must be"):
        load_task(path).run(threads=0)
