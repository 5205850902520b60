from html.parser import HTMLParser

from laticauda.reports.page import Heading, Paragraph, Picture, Points, Section, page
from laticauda.reports.tables import Column, Table

NASTY = '<script>alert("1 & 2")</script>'
VOID = {"meta", "img", "br"}


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


def everything(text: str) -> Section:
    table = Table(name="t", caption=text, columns=(Column(name=text),), rows=((text,),))
    grouped = Table(
        name="g",
        caption="",
        columns=(Column(name="kind"), Column(name="v")),
        rows=(("alike", 1), ("alike", 2)),
        grouped=True,
    )
    parts = (Heading(text=text), Paragraph(text=text), Points(texts=(text,)), table, grouped)
    picture = Picture(png=b"png", caption=text, description=text)
    return Section(name="a", title=text, parts=(*parts, picture))


def test_texts_are_escaped_everywhere():
    reader = read(page(NASTY, [Paragraph(text=NASTY)], [everything(NASTY)]))
    assert "script" not in reader.tags
    # The page's title (twice), its introduction, the section's title, and all texts of `everything` but one, which is
    # an attribute.
    assert reader.text.count(NASTY) == 11


def test_a_grouped_table_shows_what_rows_have_in_common_once():
    reader = read(page("t", [], [everything("text")]))
    assert reader.text.count("alike") == 1
    assert "kind" not in reader.text


def test_several_sections_get_a_list_of_contents():
    one = everything("one")
    assert "nav" not in read(page("t", [], [one])).tags
    two = page("t", [], [one, Section(name="b", title="two", parts=())])
    assert '<a href="#b">two</a>' in two
    assert '<section id="b">' in two
