from paper.reading import cells, said

from laticauda.paper.claims import claims, misprints
from laticauda.paper.report.reproduce import claims_chapter


def test_the_tables_hold_every_claim_and_every_misprint(study):
    found = claims(study)
    chapter = claims_chapter(found)
    rows = cells(chapter, "claims")
    assert [row["verdict"] for row in rows] == [claim.verdict for claim in found]
    assert rows[0]["the paper says"] == found[0].paper
    assert rows[0]["here"] == found[0].found
    assert [row["printed"] for row in cells(chapter, "misprints")] == [one.printed for one in misprints()]


def test_the_chapter_counts_the_verdicts(study):
    found = claims(study)
    text = said(claims_chapter(found))
    assert text.startswith(f"{len(found)} statements")
    for verdict in {claim.verdict for claim in found}:
        assert f"{verdict} {sum(claim.verdict == verdict for claim in found)}" in text
    assert "holds 0" not in text


def test_long_texts_break_into_lines_on_the_page_and_verdicts_do_not(study):
    html = claims_chapter(claims(study)).html({})
    assert '<td class="w">At the same setting' in html
    assert "<td>holds in part</td>" in html
