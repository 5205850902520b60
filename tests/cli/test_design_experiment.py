import json
from pathlib import Path

FEW = "--amplitudes-deg 20 40 --frequencies-deg-s 90 150 --phase-shifts-deg 40 --duration 8 --threads 1"
WANTED = "water.tangential_friction water.normal_drag"


def test_the_next_trials_are_listed_with_their_reasons_and_drawn(run, folder: Path):
    done = run(f"design-experiment --parameters {WANTED} --trials 3 --output next.png {FEW}")
    assert (done.status, done.err) == (0, "")
    assert "The best 3 of 9 candidates, criterion D." in done.out
    assert "what is known now" in done.out
    assert "best tow: " in done.out
    assert "After the best 3 swimming trials, water.tangential_friction is " in done.out
    assert (folder / "next.png").stat().st_size > 0


def test_json_has_every_candidate_and_what_is_known_before(run):
    done = run(
        f"design-experiment --parameters water.normal_drag=2+-0.4 --sensors path --no-tow --trials 1 --json {FEW}"
    )
    found = json.loads(done.out)
    assert found["values"] == {"water.normal_drag": 2.0}
    assert abs(found["relative_sigma_before"]["water.normal_drag"] - 0.2) < 1e-9
    assert len(found["candidates"]) == 4
    assert found["trials"][0]["relative_sigma"]["water.normal_drag"] < 0.2


def test_after_an_identification_its_fit_is_what_is_known(run, folder: Path, monkeypatch):
    # nobody would read what other laws leave
    monkeypatch.setattr("laticauda.identify.fitting.doubt_after_rivals", None)
    (folder / "t.toml").write_text(
        'kind = "identification"\nstarts = 1\nnoise = "estimated"\njoints = "prescribed"\n'
        'parameters = ["water.tangential_friction"]\n[table1]\nselected_from = 1\n'
    )
    done = run(f"design-experiment --after t.toml --trials 1 --json --no-tow {FEW}")
    assert done.status == 0, done.err
    found = json.loads(done.out)
    assert found["relative_sigma_before"]["water.tangential_friction"] < 0.3
    assert {one["trial"].split(", ")[-1] for one in found["candidates"]} >= {"with fin"}


def test_after_an_identification_another_water_is_that_of_the_candidates(run, folder: Path):
    (folder / "t.toml").write_text(
        'kind = "identification"\nstarts = 1\nnoise = "estimated"\njoints = "prescribed"\n'
        'parameters = ["water.tangential_friction"]\n[table1]\nselected_from = 1\n'
    )
    after = f"design-experiment --after t.toml --trials 1 --json --no-tow {FEW}"
    of_fit = json.loads(run(after).out)
    done = run(f"{after} --water paper-vortex")
    assert done.status == 0, done.err
    of_water = json.loads(done.out)
    assert of_water["values"] == of_fit["values"]  # what was identified stays known
    assert of_water["trials"][0]["relative_sigma"] != of_fit["trials"][0]["relative_sigma"]
    refused = run(f"{after} --joints servo")
    assert refused.status == 2
    assert "--joints must not be given with --after, whose file defines them" in refused.err


def test_rivals_are_told_apart_by_an_oblique_tow(run):
    done = run(
        f"design-experiment --rivals textbook paper-vortex --parameters {WANTED} --no-swims --trials 1 --json"
    )
    assert (done.status, done.err) == (0, "")
    found = json.loads(done.out)
    assert [one["trial"] for one in found["trials"]] == ["oblique tow, 15 deg, at 0.4 m/s"]
    straight = next(one for one in found["candidates"] if one["trial"] == "straight tow at 0.4 m/s")
    assert (
        straight["distance"]["textbook / paper-vortex"]
        < 1e-6
        < found["trials"][0]["distance"]["textbook / paper-vortex"]
    )
    text = run(
        f"design-experiment --rivals textbook paper-vortex --parameters {WANTED} --no-swims --trials 1"
    ).out
    assert "Chance that the wrong one of two fits better:" in text


def test_a_tank_day_begins_with_a_list_of_runs_and_its_empty_tables_say_what_to_do(
    run, folder: Path
):
    done = run("design-experiment --tank-day day --robot amphibot")
    assert (done.status, done.err) == (0, "")
    assert done.out.startswith("day/RUNS.md: what to do.")
    assert (
        (folder / "day" / "swim.csv").read_text().startswith("time_s,x_m,y_m,yaw_deg,joint_1_deg,")
    )
    again = run("design-experiment --tank-day day")
    assert again.status == 2
    assert "No file was filled in" in again.err


def test_bad_input_is_named(run):
    cases = {
        "": "--parameters must hold at least one number to identify",
        "--parameters water.normal_drag=x": "--parameters must be NAME, NAME=VALUE or NAME=MEAN+-SD",
        "--parameters water.normal_drag --sensors sonar": "--sensors must be one of speed, power, path",
        "--parameters water.normal_drag --criterion E": "--criterion must be",
        "--parameters water.normal_drag --trials 0": "must be",
        "--parameters water.normal_drag --output a.txt": "--output must be a file that ends in .png or .pdf or .svg",
        "--after none.toml": "none.toml",
    }
    for words, text in cases.items():
        done = run(f"design-experiment {words} {FEW}")
        assert done.status == 2, words
        assert text.lower() in done.err.lower(), done.err
