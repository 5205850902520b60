from html.parser import HTMLParser

import pytest
from jinja2 import ChoiceLoader, DictLoader, UndefinedError

from laticauda.show.reports.cells import (
    find_form,
    format_cell,
    format_number,
    format_share,
    format_span,
)
from laticauda.show.reports.chapter import Chapter, load_templates, write_chapter

NASTY = '<script>alert("1 & 2")</script>'
VOID = {"meta", "img", "br", "wbr"}
PAGE = """
{% extends "page.html" %}
{% from "parts.html" import table, picture %}
{% set title = text %}
{% block introduction %}<p>{{ text }}</p>{% endblock %}
{% set one %}
<h3>{{ text }}</h3>
{% call table(alone) %}{{ text }}{% endcall %}
{% call table(grouped, grouped=true) %}What it shows{% endcall %}
{{ picture({"p": (text, "png".encode())}, "p") }}
{% endset %}
{% set chapters = [("a", text, one), ("b", "two", "")][:n] %}
"""


class Balance(HTMLParser):
    """Every element that is opened is closed, in the right order."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.tags: list[str] = []
        self.text = ""

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.text += data


def read(text: str) -> Balance:
    reader = Balance()
    reader.feed(text)
    assert reader.open == []
    return reader


def page(text: str, n: int = 1) -> str:
    frames = {"alone": [{text: text}], "grouped": [{"kind": "alike", "v": v} for v in (1, 2)]}
    return load_templates().from_string(PAGE).render(text=text, n=n, **frames)


def test_texts_are_escaped_everywhere():
    reader = read(page(NASTY))
    assert "script" not in reader.tags
    # The page's title (twice), its introduction, the chapter's title, and within it a heading, the
    # table's caption, head and cell, and the picture's caption; its description is an attribute.
    assert reader.text.count(NASTY) == 9


def test_a_grouped_table_shows_what_rows_have_in_common_once():
    reader = read(page("text"))
    assert reader.text.count("alike") == 1
    assert "kind" not in reader.text


def test_long_names_in_the_head_of_a_table_may_be_broken_and_stay_escaped():
    text = page("robot.servo_gain <b>")
    assert '<th scope="col">robot.<wbr>servo_<wbr>gain &lt;b&gt;</th>' in text


def test_several_chapters_get_a_list_of_contents():
    assert "nav" not in read(page("t")).tags
    two = page("t", 2)
    assert '<a href="#b">two</a>' in two
    assert '<section id="b">' in two


def test_pages_need_nothing_from_elsewhere():
    assert "http" not in page("t", 2)
    assert "script" not in read(page("t", 2)).tags


def test_csv_files_have_all_digits_and_pages_are_rounded_and_both_say_what_is_missing(tmp_path):
    rows = [
        {"a, b": "x", "v [m/s]": 0.123456, "end": True},
        {"a, b": '"', "v [m/s]": None, "end": False},
    ]
    parts = load_templates().loader
    text = """{% from "parts.html" import table %}{% call table(tables["t"], {"v [m/s]": ".2f"}) %}{% endcall %}"""
    mine = DictLoader({"t.html": text})
    made = load_templates().overlay(loader=ChoiceLoader([mine, parts]))
    chapter = Chapter(name="t", values={}, tables={"t": rows}, templates=lambda: made)
    files, html = write_chapter(chapter, tmp_path)
    assert files == ["t.csv"]
    assert (tmp_path / "t.csv").read_text() == '"a, b",v [m/s],end\nx,0.123456,yes\n"""",,no\n'
    assert '<tr><td>x</td><td class="n">0.12</td><td>yes</td></tr>' in html
    assert '<td class="n">NA</td><td>no</td></tr>' in html


def test_negative_numbers_have_a_minus_sign_and_what_is_rounded_to_zero_has_none():
    assert format_number(-1.5, ".1f") == "\N{MINUS SIGN}1.5"
    assert [
        format_number(-0.0004, ".2f"),
        format_number(0.0, "+.1f"),
        format_number(0.06, "+.1f"),
    ] == [
        "0.00",
        "0.0",
        "+0.1",
    ]
    assert [
        format_cell(True),
        format_cell(None),
        format_cell(float("nan")),
        format_cell("x", ".1f"),
    ] == [
        "yes",
        "NA",
        "NA",
        "x",
    ]


def test_words_for_shares_and_spans():
    assert [format_share(3, 3), format_share(0, 3), format_share(1, 3)] == [
        "all 3",
        "none of the 3",
        "1 of the 3",
    ]
    assert [format_span([2.0, -1.0], ".1f"), format_span([1.0, 1.01], ".1f")] == [
        "\N{MINUS SIGN}1.0 to 2.0",
        "1.0",
    ]


def test_the_longest_end_of_a_name_decides_how_its_numbers_are_shown():
    forms = {"[%]": ".1f", "measured: v [%]": "+.2f"}
    assert [find_form(name, forms) for name in ("measured: v [%]", "b: v [%]", "c")] == [
        "+.2f",
        ".1f",
        "",
    ]


def test_a_value_that_a_template_lacks_is_an_error():
    with pytest.raises(UndefinedError, match="how"):
        load_templates().from_string("{{ how.model }}").render()
