import pandas as pd
import pytest
from jinja2 import UndefinedError
from paper.reading import cells

from laticauda.paper.report.chapter import Chapter, environment, figure_numbers, form_of, in_digits, share, shown, span


def table(frame: pd.DataFrame, options: str = "") -> str:
    """A table as a page shows it."""
    text = (
        '{% from "parts.html" import table %}{% call table(frame'
        + options
        + ") %}What it <shows>{{ end }}{% endcall %}"
    )
    return environment().from_string(text).render(frame=frame, end=".")


def test_csv_files_have_all_digits_and_empty_cells_for_what_is_missing():
    frame = pd.DataFrame(
        [{"a, b": "x", "v [m/s]": 0.123456, "end": True}, {"a, b": '"', "v [m/s]": None, "end": False}]
    )
    assert cells(Chapter(name="t", values={}, tables={"t": frame}), "t") == [
        {"a, b": "x", "v [m/s]": "0.123456", "end": "yes"},
        {"a, b": '"', "v [m/s]": "", "end": "no"},
    ]


def test_pages_round_numbers_escape_texts_and_say_what_is_missing():
    frame = pd.DataFrame([{"a & b": "<x>", "v [m/s]": 0.126, "n": 3}, {"a & b": "y", "v [m/s]": None, "n": 4}])
    html = table(frame, ', {"[m/s]": ".2f"}')
    assert "<caption>What it <shows>.</caption>" in html  # the template's own words
    assert '<th scope="col">a &amp; b</th><th scope="col" class="n">v [m/s]</th>' in html
    assert '<tr><td>&lt;x&gt;</td><td class="n">0.13</td><td class="n">3</td></tr>' in html
    assert '<tr><td>y</td><td class="n">NA</td><td class="n">4</td></tr>' in html


def test_the_first_column_of_a_grouped_table_stands_above_its_rows():
    html = table(pd.DataFrame({"group": ["a", "a", "b"], "v": [1, 2, 3]}), ", grouped=true")
    assert html.count('scope="rowgroup"') == 2
    assert html.count("<td") == 3


def test_negative_numbers_have_a_minus_sign_and_what_is_rounded_to_zero_has_none():
    assert in_digits(-1.5, ".1f") == "\N{MINUS SIGN}1.5"
    assert [in_digits(-0.0004, ".2f"), in_digits(0.0, "+.1f"), in_digits(0.06, "+.1f")] == ["0.00", "0.0", "+0.1"]
    assert [shown(True), shown(None), shown(float("nan")), shown("x", ".1f")] == ["yes", "NA", "NA", "x"]


def test_words_for_shares_spans_and_figures():
    assert [share(3, 3), share(0, 3), share(1, 3)] == ["all 3", "none of the 3", "1 of the 3"]
    assert [span([2.0, -1.0], ".1f"), span([1.0, 1.01], ".1f")] == ["\N{MINUS SIGN}1.0 to 2.0", "1.0"]
    assert figure_numbers([12, 14, 15, 16, 18]) == "Figs. 12, 14 to 16 and 18"
    assert figure_numbers([17]) == "Fig. 17"


def test_the_longest_end_of_a_name_decides_how_its_numbers_are_shown():
    forms = {"[%]": ".1f", "measured: v [%]": "+.2f"}
    assert [form_of(name, forms) for name in ("measured: v [%]", "b: v [%]", "c")] == ["+.2f", ".1f", ""]


def test_a_value_that_a_template_lacks_is_an_error():
    with pytest.raises(UndefinedError, match="how"):
        environment().from_string("{{ how.model }}").render()
