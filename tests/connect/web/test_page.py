"""The page without a server: its numbers are those of `lc.swim`, and what it says of them is so."""

import gzip
import importlib.util
import math
from dataclasses import replace

import pytest
from web_pages import NODE, by_python, by_shell, data_of, difference, nameless, some_links, trials

import laticauda as lc
from laticauda.connect.web import export_web
from laticauda.connect.web.robot_data import build_choice
from laticauda.values.errors import BadArgument, RobotFileError

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(
        importlib.util.find_spec("ziglang") is None, reason="ziglang is not installed"
    ),
]
needs_node = pytest.mark.skipif(NODE is None, reason="node is not installed")


def most_of(scenario: lc.Scenario) -> float:
    """How far page and Python may be apart: rounding, which servos at the end of their speed make larger."""
    return 1e-12 if scenario.model.joints == lc.Prescribed() else 1e-10


def test_a_page_has_the_outlines_of_places_but_not_the_bed(folder):
    corners = [[-0.5, 0.75], [0.5, 0.75], [0.5, 0.85], [-0.5, 0.85]]
    assert data_of(folder)["places"] == [{"name": "quay", "outlines": [corners]}]


@needs_node
def test_twenty_settings_by_chance_swim_as_in_python_and_are_said_rightly(folder, tmp_path):
    links = some_links(folder, 20, seed=7)
    for link, found in zip(links, trials(folder, links), strict=True):
        scenario = by_python(found["python"])
        assert nameless(by_shell(found["shell"], tmp_path)) == nameless(scenario)
        assert not found["refusal"]
        trial = lc.swim(scenario)
        assert difference(found["csv"], trial) < most_of(scenario), link
        assert found["figures"]["speed"] == pytest.approx(
            trial.forward_velocity, abs=most_of(scenario)
        )
        assert found["figures"]["power"] == pytest.approx(trial.mean_power, rel=most_of(scenario))
        if not scenario.environment.is_still:
            through_water = found["figures"]["through"]
            assert through_water == pytest.approx(trial.speed_through_water, abs=most_of(scenario))


@needs_node
def test_a_link_that_was_read_is_written_again_and_nonsense_in_it_is_passed_over(folder):
    links = some_links(folder, 5, seed=3)
    said = [found["link"] for found in trials(folder, links)]
    assert [found["link"] for found in trials(folder, said)] == said
    assert len(set(said)) == 5
    (plain,) = trials(
        folder, ["robot=whale&fin=7&amplitude-deg=much&waypoints=1+2+x&normal-drag=1e9&other=1"]
    )
    assert plain["link"] == "normal-drag=4"  # within the slider's limits


@needs_node
def test_what_python_refuses_the_page_refuses_too(folder):
    (found,) = trials(folder, ["amplitude-deg=60&offset-deg=20&waypoints=0+0+1+1"])
    assert "joint 0" in found["refusal"]
    scenario = by_python(found["python"])
    with pytest.raises(BadArgument, match="joint 0 goes beyond its limit"):
        lc.swim(scenario)


def test_what_is_declared_is_what_the_page_says(folder):
    sliders = {one["flag"]: one for one in data_of(folder)["sliders"]}
    drag, frequency = sliders["normal-drag"], sliders["frequency-deg-s"]
    assert drag["text"] == "C_D, drag across the body"
    assert (frequency["unit"], frequency["factor"]) == ("°/s", math.radians(1.0))
    water = lc.load_water("paper-lateral")
    for one in sliders.values():
        if one["group"] == "water":  # ends of a slider are numbers that a water may have
            for end in ("low", "high"):
                replace(water, **{one["field"]: one[end]})


def test_all_of_it_is_half_a_megabyte_at_most(folder):
    assert sum(len(gzip.compress(path.read_bytes())) for path in folder.iterdir()) < 250_000
    text = (folder / "index.html").read_text("utf-8")
    assert "http" not in text.replace("http://www.w3.org", "")  # nothing comes from elsewhere


def test_a_robot_that_is_not_there_is_refused_before_anything_is_written(tmp_path):
    with pytest.raises(RobotFileError, match="whale"):
        export_web(tmp_path / "page", ("mamba", "whale"))
    assert not (tmp_path / "page").exists()


def test_a_fin_with_a_silhouette_has_no_other_sizes_and_no_elastic_one_on_a_page():
    assert set(build_choice("tendon-fish").plants) == {"rigid"}
    assert set(build_choice("mamba-fin").plants) == {"rigid", "elastic", "small", "large"}
