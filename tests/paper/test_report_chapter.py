from types import SimpleNamespace

from laticauda.paper.report.chapter import format_figure_numbers, load_paper_templates
from laticauda.paper.report.columns import build_row


def test_numbers_of_figures_in_a_row_are_said_from_to():
    assert format_figure_numbers([12, 14, 15, 16, 18]) == "Figs. 12, 14 to 16 and 18"
    assert format_figure_numbers([17]) == "Fig. 17"


def test_a_length_that_is_not_known_is_called_unknown():
    centimeters = load_paper_templates().filters["cm"]
    assert centimeters(0.1234) == "12 cm"
    assert centimeters(None) == "unknown"


def test_a_column_of_what_is_missing_is_empty():
    run = SimpleNamespace(
        forward_velocity=0.1, steady_velocity=None, offset_swing=None, last_third_largest=None
    )
    row = build_row("loop", {"run": run, "change": None})
    assert row["v [m/s]"] == 0.1
    assert row["swing of the offset [deg]"] is None
    assert build_row("loop", {"run": None, "change": None})["v [m/s]"] is None
