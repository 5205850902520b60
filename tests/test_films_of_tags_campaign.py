"""The stored answer of campaigns/films_of_tags.py: what the docs say of it."""

from pathlib import Path

import pytest
from campaign_scripts import campaign

films_of_tags = campaign("films_of_tags")
PAGE = Path(__file__).parent.parent / "docs/how-to/film.md"


def test_the_table_of_the_page_is_that_of_the_stored_answer():
    assert films_of_tags.table(films_of_tags.stored()) in PAGE.read_text(encoding="utf-8")


@pytest.mark.parametrize("answer", films_of_tags.stored(), ids=lambda answer: answer.case)
def test_a_glide_gives_the_friction_to_5_percent_and_loses_at_most_2_percent_of_the_tags(answer):
    assert answer.friction == pytest.approx(films_of_tags.FRICTION, rel=0.05)
    assert answer.lost <= 0.02


def test_every_film_was_analyzed():
    names = [case.name for case in films_of_tags.CASES]
    assert [answer.case for answer in films_of_tags.stored()] == names
