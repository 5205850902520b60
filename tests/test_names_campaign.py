"""What campaigns/names.csv says of every name of a body and its gait, and that it is about what there is."""

import pytest
from campaign_scripts import campaign

from laticauda.models.simulate import change_parameters

names = campaign("names")
ROWS = names.stored(names.TABLE, names.Row)
TOGETHER = {figure.what: figure.value for figure in names.stored(names.TOGETHER, names.Figure)}
COMMANDED = ("gait.frequency", "gait.phase_shift", "gait.offset")
BY_ROBOT = [row for row in ROWS if row.name not in COMMANDED]


def test_the_table_is_of_sixty_names_that_there_are():
    assert len(ROWS) == 60
    assert [row.name for row in ROWS] == list(names.NAMES)
    assert [row.unit for row in ROWS] == [names.PARAMETERS[name].unit for name in names.NAMES]


def test_every_name_is_swept_in_python_and_by_flags_as_swum_alone():
    for row in ROWS:
        assert abs(row.speed_change) > 1e-6, row.name
        assert row.sweep_error < 1e-12, row.name
        assert row.sweep_flag_error < 1e-12, row.name


@pytest.mark.parametrize("name", ["robot.module[3].mass", "gait.phase[2]"])
def test_the_table_is_of_the_present_program(name: str, recwarn: pytest.WarningsRecorder):
    (row,) = (row for row in ROWS if row.name == name)
    before = names.swum_speed(names.SCENARIO)
    after = names.swum_speed(change_parameters(names.SCENARIO, {name: row.changed}))
    assert after / before - 1.0 == pytest.approx(row.speed_change, rel=1e-9)


def test_every_slope_is_that_of_differences():
    for row in ROWS:
        assert row.speed_slope_error < 1e-6, row.name
        assert row.power_slope_error < 1e-6, row.name


def test_all_are_optimized_together_within_their_bounds():
    for row in ROWS:
        low, high = names.BOUNDS[row.name]
        assert low <= row.optimized <= high, row.name
        assert row.optimize_flag == "yes", row.name
    start = TOGETHER["cost of transport at the start"]
    assert TOGETHER["cost of transport of the best"] < 0.5 * start
    assert TOGETHER["its error against swim"] < 1e-12


def test_every_name_but_the_commanded_wave_is_identified():
    for row in BY_ROBOT:
        assert 0.0 <= row.recovered_error < 1e-6, row.name
        assert row.identify_flag == "yes", row.name
    refused = [row.name for row in ROWS if row.identify_flag == "commanded"]
    assert refused == list(COMMANDED)
    assert TOGETHER["largest error of eight identified together"] < 1e-6


def test_what_a_path_does_not_depend_on_is_said():
    for row in BY_ROBOT:
        is_of_skin = row.name.startswith(
            "robot.joint["
        )  # joints that are prescribed do not feel it
        assert row.unseen == ("yes" if is_of_skin else "no"), row.name


def test_every_name_is_filed_and_exported():
    for row in ROWS:
        assert row.filed == "yes", row.name
        assert row.exported != "no", row.name
        assert 0.0 <= row.export_error < 1e-12, row.name
