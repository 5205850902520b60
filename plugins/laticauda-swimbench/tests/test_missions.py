"""The two missions: what fixes them, what who steers is told, what is scored and stored."""

import json
import sys
from dataclasses import replace
from pathlib import Path

import pytest

import laticauda_swimbench as swimbench
from laticauda.scenarios import save_scenario
from laticauda_swimbench import missions
from laticauda_swimbench.app import main
from laticauda_swimbench.scoring import BadScores

PAGE = Path(__file__).parents[3] / "docs" / "swimbench.md"

OUTSIDE = """
import laticauda as lc
from laticauda_swimbench import mission_challenge


class Peeks(lc.Controller):
    gait = mission_challenge("station").scenario.motion.gait
    interval = 0.2

    def init(self):
        return None

    def step(self, state, observation):
        return None, lc.Command(gait=self.gait, offset=observation.center_of_mass[0])


known = mission_challenge("station").scenario.motion
nothing = 3
"""


@pytest.fixture
def outside(tmp_path, monkeypatch):
    (tmp_path / "outside.py").write_text(OUTSIDE)
    monkeypatch.syspath_prepend(str(tmp_path))
    yield
    sys.modules.pop("outside", None)


def shorten(name):
    challenge = swimbench.mission_challenge(name)
    scenario = replace(challenge.scenario, duration=2.0)
    return replace(challenge, seeds=challenge.seeds[:2], scenario=scenario)


@pytest.fixture
def short(monkeypatch):
    """Both missions with two runs of two seconds."""
    challenges = {name: shorten(name) for name in swimbench.MISSIONS}
    monkeypatch.setattr(missions, "mission_challenge", challenges.__getitem__)


@pytest.mark.parametrize("name", swimbench.MISSIONS)
def test_a_mission_fixes_its_runs_and_its_scale(name):
    challenge = swimbench.mission_challenge(name)
    assert len(challenge.seeds) == len(set(challenge.seeds)) == 6
    assert challenge.score(challenge.baseline) == 0.0
    assert challenge.score(challenge.reference) == 1.0
    assert challenge.conditions.failing


def test_a_mission_file_and_a_controller_are_scored_as_the_reference_is(short, outside, tmp_path):
    file = tmp_path / "mine.toml"
    save_scenario(swimbench.mission_challenge("station").scenario, file)
    reference, by_file, by_name = (
        swimbench.score_missions(policy, ["station"])["scenarios"]
        for policy in ("reference", str(file), "outside:known")
    )
    assert reference == by_file == by_name
    assert len(reference[0]["results"]) == 2


def test_who_steers_is_not_told_where_the_robot_is(short, outside):
    with pytest.raises(AttributeError, match="no attribute 'center_of_mass'"):
        swimbench.score_missions("outside:Peeks", ["station"])


def test_an_inspection_counts_what_was_seen_and_half_of_it_without_the_dock(short):
    content = swimbench.score_missions("rest", ["inspection"])
    for run in content["scenarios"][0]["results"]:
        assert run["worth"] == 0.5 * run["share_seen"]
        assert run["objective"] == pytest.approx(run["worth"] - run["energy"] / 100e3)


def test_a_score_file_that_was_changed_is_refused(short, tmp_path):
    missions.write_mission_scores(swimbench.score_missions("rest"), tmp_path)
    file = tmp_path / "rest.json"
    assert missions.read_mission_scores(file)["method"] == {"name": "rest"}
    file.write_text(file.read_text().replace('"seed": 7000', '"seed": 7777'))
    with pytest.raises(BadScores, match=r"rest\.json: its checksum is wrong"):
        missions.read_mission_scores(file)


@pytest.mark.parametrize(
    ("policy", "message"),
    [
        ("nobody", r"`policy` must be `reference`, `dead-reckoning`, `rest`, a mission file"),
        ("outside:nothing", "`policy` must name a controller or its class, got outside:nothing"),
    ],
)
def test_what_is_no_policy_is_refused(policy, message, outside):
    with pytest.raises(ValueError, match=message):
        swimbench.score_missions(policy)


def test_the_command_scores_missions(short, tmp_path, capsys):
    assert main(["missions", "rest", "--missions", "station", "--output", str(tmp_path)]) == 0
    assert "| rest |  |  |  | " in capsys.readouterr().out
    assert json.loads((tmp_path / "rest.json").read_text())["format"] == "swimbench-mission-scores"


def test_the_page_has_the_table_of_the_stored_scores():
    stored = [
        missions.read_mission_scores(missions.RESULTS / f"{name}.json")
        for name in missions.BASELINES
    ]
    assert missions.mission_table(stored) in PAGE.read_text(encoding="utf-8")


def test_what_is_stored_is_what_is_scored_today():
    challenge = swimbench.mission_challenge("station")
    content = missions.read_mission_scores(missions.RESULTS / "reference.json")
    stored = content["scenarios"][1]["results"][0]
    (run,) = missions.mission_results(
        challenge, missions.BASELINES["reference"], challenge.seeds[:1]
    )
    assert run["seed"] == stored["seed"]
    assert run["score"] == pytest.approx(stored["score"], abs=0.02)
