import csv
import io

from laticauda.paper.claims import claims, misprints
from laticauda.paper.report.claims import claims_chapter
from laticauda.reports.page import Paragraph, page


def test_the_tables_hold_every_claim_and_every_misprint(study):
    found = claims(study)
    table, wrong = claims_chapter(found).tables
    assert (table.name, wrong.name) == ("claims", "misprints")
    rows = list(csv.DictReader(io.StringIO(table.csv)))
    assert [row["verdict"] for row in rows] == [claim.verdict for claim in found]
    assert rows[0]["the paper says"] == found[0].paper
    assert rows[0]["here"] == found[0].found
    assert [row["printed"] for row in csv.DictReader(io.StringIO(wrong.csv))] == [one.printed for one in misprints()]


def test_the_section_counts_the_verdicts(study):
    found = claims(study)
    section = claims_chapter(found).section({})
    first = next(part.text for part in section.parts if isinstance(part, Paragraph))
    assert first.startswith(f"{len(found)} statements")
    for verdict in {claim.verdict for claim in found}:
        assert f"{verdict} {sum(claim.verdict == verdict for claim in found)}" in first
    assert "holds 0" not in first


def test_long_texts_break_into_lines_on_the_page_and_verdicts_do_not(study):
    text = page("t", [], [claims_chapter(claims(study)).section({})])
    assert '<td class="w">At the same setting' in text
    assert "<td>holds in part</td>" in text
    assert "td.w { white-space: normal;" in text
