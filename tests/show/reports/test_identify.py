import json
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from identify.trials import FRICTION, speeds

from laticauda.identify import Unknown
from laticauda.identify.tasks import Task
from laticauda.identify.validation import validate
from laticauda.show.reports.identify import (
    build_identification_chapter,
    describe_identification,
    write_identification,
)
from laticauda.show.reports.identify_tables import list_identification_tables
from laticauda.show.reports.parameter_names import shorten_names

WITHOUT_EFFECT = "robot.joint.actuator.servo_gain"  # of prescribed joints


@pytest.fixture(scope="module")
def done():
    measured = speeds(6, duration=6.0, noise=0.002)
    measured = [replace(m, group="slow" if i < 3 else "fast") for i, m in enumerate(measured)]
    wanted = (Unknown(name=FRICTION, prior=(0.3, 0.2)), Unknown(name=WITHOUT_EFFECT))
    options = {"n_starts": 2, "noise": "estimated"}
    task = Task(
        name="tank",
        title="in the tank",
        measurements=tuple(measured),
        unknowns=wanted,
        options=options,
    )
    return validate(task, task.run(threads=1), profiles=False)


def test_the_page_says_what_was_found_from_what_and_how_well(done, tmp_path):
    files = write_identification(done, tmp_path, command="laticauda identify tank.toml")
    assert {path.name for path in tmp_path.iterdir()} == set(files)
    text = (tmp_path / "identify.html").read_text()
    for words in (
        "Identification: in the tank",
        "Command: laticauda identify tank.toml",
        done.fit.status,
        "What the measurements see",
        "group left out",
        "null model: constant per group",
        "starts came to the same sum of squares",
    ):
        assert words in text
    assert text.count("data:image/png;base64,") == 4
    assert "http" not in text.replace("http-equiv", "")
    assert "`" not in text.split("<style>")[0] + text.split("</style>")[1].split("base64")[0]


def test_the_sentences_say_what_was_done_and_not_its_opposite(done):
    text = build_identification_chapter(done).html({})
    assert "The data do not see robot.joint.actuator.servo_gain." in text
    assert (
        "predicted by the linearized model, without refits, each group by a refit to the other groups;"
        in text
    )
    assert (
        f"estimated from the residuals, {done.fit.noise_factor:.2g} times what the measurements state."
        in text
    )
    found = replace(
        done.fit, method=replace(done.fit.method, noise="known"), warnings=("Look at `this`.",)
    )
    other = build_identification_chapter(
        replace(done, fit=found, is_linearized=False, by_group=None)
    ).html({})
    assert "predicted by a refit to all others; beside it" in other
    assert "the noise is taken as stated." in other
    assert "<li>Look at this.</li>" in other
    assert "Command:" not in other
    table = pd.DataFrame(list_identification_tables(done)["directions"])
    assert [bool(seen) for seen in table["seen"]] == [
        one.is_seen for one in done.fit.identifiability.directions
    ]


def test_what_is_not_identified_is_no_number_in_table_and_json(done):
    table = pd.DataFrame(list_identification_tables(done)["parameters"])
    assert list(table["value"].isna()) == [
        not estimate.is_identified for estimate in done.fit.estimates
    ]
    assert any(table["value"].isna())
    assert table["prior"][0] == "0.3 ± 0.2"
    found = json.loads(json.dumps(describe_identification(done), allow_nan=False))
    assert [row["value"] is None for row in found["parameters"]] == list(table["value"].isna())
    assert all(row["best"] is not None for row in found["parameters"])


def test_what_is_left_out_stands_beside_the_null_models(done):
    rows = pd.DataFrame(list_identification_tables(done)["errors"]).set_index("model")
    mine = rows.loc["this fit"]
    assert mine["fitted [%]"] == pytest.approx(done.fit.percentage_error())
    assert mine["measurement left out [%]"] > mine["fitted [%]"]
    assert mine["group left out [%]"] == pytest.approx(done.by_group.percentage_error())
    assert "null model: constant stride per group" in rows.index


def test_groups_are_not_left_out_where_the_others_do_not_suffice(done):
    few = replace(
        done.task,
        measurements=done.task.measurements[:4],
        options={"n_starts": 1, "noise": "estimated"},
    )
    few = replace(
        few,
        measurements=tuple(
            replace(m, group="one" if i else "rest") for i, m in enumerate(few.measurements)
        ),
    )
    assert validate(few, few.run(threads=1)).by_group is None


def test_names_are_short_where_that_leaves_them_different():
    assert shorten_names(["water.normal_drag", "robot.caudal_fin.length"]) == [
        "normal drag",
        "caudal fin.length",
    ]
    both = ["water.normal_drag", "eel_like.water.normal_drag"]
    assert shorten_names(both) == ["normal drag", "eel like: normal drag"]
    assert shorten_names(["water.mass", "robot.mass"]) == ["water.mass", "robot.mass"]


def test_every_residual_stands_in_the_table_with_its_prediction_by_the_others(done):
    table = pd.DataFrame(list_identification_tables(done)["residuals"])
    assert len(table) == 6
    left_out, predicted = (
        (table[name] - table["measured"]).abs() for name in ("left out", "predicted")
    )
    assert np.all(left_out >= predicted - 1e-12)


def test_where_the_search_began_and_ended_has_units(done):
    first = list_identification_tables(done)["starts"][0]
    assert f"{FRICTION}, from [-]" in first and f"{FRICTION}, to [-]" in first
    assert f"{WITHOUT_EFFECT}, to [{done.fit.estimates[1].unit}]" in first
