"""The stored answers of campaigns/films_of_points.py hold what its table says."""

import campaign_scripts
import pytest

films = campaign_scripts.campaign("films_of_points")


@pytest.fixture(scope="module")
def rows():
    return films._rows.stored(films.STORED, films.Row)


def test_every_film_has_a_row(rows):
    assert sorted((row.fault, row.seed) for row in rows) == sorted(films.jobs())


@pytest.mark.parametrize(("water", "power_error"), [("same", 0.005), ("tables", 0.05)])
def test_speed_and_power_lie_in_their_intervals(rows, water, power_error):
    found = films.summary([row for row in rows if row.fault == water])
    assert 0.91 <= found["speed_held"] <= 0.98
    assert found["power_held"] >= 0.9
    assert found["power_error"] < power_error


def test_water_of_another_kind_is_noticed_in_every_film(rows):
    found = films.summary([row for row in rows if row.fault == "foreign"])
    assert found["zero_left"] == 0.0
    assert found["power_held"] == 0.0
    assert found["speed_held"] > 0.9  # the film alone shows it


def test_a_film_gives_its_row_again(rows):
    row = films.run_one("same", 100)
    stored = next(one for one in rows if (one.fault, one.seed) == ("same", 100))
    assert row.power_median == pytest.approx(stored.power_median, rel=0.01)
    assert row.speed == pytest.approx(stored.speed, rel=1e-6)
