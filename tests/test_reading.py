"""No package becomes harder to read than its row in reading.csv, and rows only improve."""

from dataclasses import replace
from pathlib import Path

import pytest
import reading

EASY = reading.Figures(tokens=8.0, expressions=5.0, conditional=3.0, nested=0.0, vague=0.1)


@pytest.fixture(scope="module")
def packages():
    return reading.measure_packages()


def test_no_package_is_harder_to_read_than_its_row(packages):
    limits = reading.read_limits()
    harder: dict[str, str] = {}
    for package, figures in packages.items():
        allowed = limits.get(package, reading.LIMITS_OF_A_NEW_PACKAGE)
        for name in reading.names_above(figures, allowed):
            figure, limit = getattr(figures, name), getattr(allowed, name)
            harder[f"{package}, {name}"] = f"{figure:.2f} where {limit:.1f} is allowed"
    assert not harder


def test_the_row_of_a_package_that_became_clearly_easier_is_lowered(packages):
    limits = reading.read_limits()
    easier: dict[str, list[str]] = {}
    for package, figures in packages.items():
        names = reading.names_far_below(figures, limits.get(package, figures))
        if names:
            easier[package] = names
    assert not easier, "run `python tests/reading.py --update` and commit reading.csv"


def test_what_is_counted_is_code_and_not_its_description(tmp_path: Path):
    package = tmp_path / "laticauda"
    (package / "robot").mkdir(parents=True)
    (package / "top.py").write_text('"""Two words."""\n\nx = 1  # reason\n')
    (package / "robot" / "body.py").write_text(
        "found = [a for row in rows for a in row]\n"
        "size = 1 if found else 2\n"
        "def reach(given):\n"
        '    """Say it."""\n'
        "    return given\n"
    )
    measured = reading.measure_packages(package)
    assert measured["laticauda"] == reading.Figures(3.0, 1.5, 0.0, 0.0, 0.0)
    body = measured["robot"]
    assert body.conditional == body.nested == pytest.approx(250.0)
    assert body.vague == pytest.approx(100.0 * 2 / 5)  # found, given; not a, row, size


def test_a_table_of_constants_is_a_single_expression():
    table, formula = reading.Count(), reading.Count()
    table.add_module('TABLE = {"a": {"b": ["c", 1]}, "d": {}}\n')
    formula.add_module('TABLE = {"a": {"b": ["c", 1]}, "d": {}, **more}\n')
    assert table.expressions == 2  # the name and the table
    assert formula.expressions == 7


def test_a_limit_is_lowered_and_never_raised():
    limits = {"robot": replace(EASY, tokens=9.0, conditional=2.0)}
    assert reading.update_limits({"robot": EASY}, limits) == {
        "robot": replace(EASY, tokens=8.0, conditional=2.0, vague=0.1)
    }


def test_a_renamed_package_gets_a_row_if_it_can_be_read_and_its_old_row_goes():
    updated = reading.update_limits({"body": EASY}, {"robot": EASY})
    assert updated == {"body": reading.round_up(EASY)}


def test_a_new_package_that_is_hard_to_read_has_to_be_listed_by_hand():
    hard = replace(EASY, vague=5.0)
    with pytest.raises(reading.TooHard, match=r"(?s)body is new.*\(vague\).*body,8\.0,5\.0,3\.0,"):
        reading.update_limits({"body": hard}, {})
    assert reading.update_limits({"body": hard}, {"body": hard}) == {"body": hard}


def test_a_figure_that_rises_is_named_and_one_that_falls_a_little_is_not():
    assert reading.names_above(replace(EASY, nested=1.0), EASY) == ["nested"]
    assert reading.names_above(EASY, EASY) == []
    assert reading.names_far_below(replace(EASY, tokens=7.9), EASY) == []
    assert reading.names_far_below(replace(EASY, tokens=7.0), EASY) == ["tokens"]


def test_limits_are_read_as_they_were_written(tmp_path: Path):
    limits = {"robot": reading.round_up(EASY), "body": EASY}
    table = tmp_path / "reading.csv"
    reading.write_limits(limits, table)
    assert reading.read_limits(table) == limits


def test_a_figure_is_rounded_up_but_not_beyond_the_next_step():
    figures = reading.Figures(tokens=9.21, expressions=6.0, conditional=3.1, nested=0.5, vague=0.3)
    assert reading.round_up(figures) == reading.Figures(9.3, 6.0, 4.0, 0.5, 0.4)
