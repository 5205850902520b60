"""The paper's claims for readers: what became of them, and what is misprinted."""

from collections import Counter
from collections.abc import Sequence

from laticauda.paper.claims import Claim, Misprint, misprints
from laticauda.paper.report.chapter import PaperChapter
from laticauda.reports.chapter import Chapter

VERDICTS = ("holds", "holds in part", "does not hold", "not tested here")
"""The best first."""


def claims_chapter(found: Sequence[Claim], wrong: Sequence[Misprint] | None = None) -> Chapter:
    """What the claims put into the folder and the report.

    Args:
        found: What `laticauda.paper.claims.claims` returned.
        wrong: Misprints and contradictions; None takes all that are known.
    """
    from pandas import DataFrame

    claims = [
        {
            "about": claim.theme,
            "where": claim.where,
            "the paper says": claim.paper,
            "here": claim.found,
            "rule: it holds if": claim.rule,
            "verdict": claim.verdict,
        }
        for claim in found
    ]
    misprinted = [
        {"where": entry.where, "printed": entry.printed, "instead, or against it": entry.instead}
        for entry in (misprints() if wrong is None else wrong)
    ]
    counts = Counter(claim.verdict for claim in found)
    return PaperChapter(
        name="claims",
        values={"n_claims": len(found), "counts": {name: counts[name] for name in VERDICTS if counts[name]}},
        tables={"claims": DataFrame(claims), "misprints": DataFrame(misprinted)},
    )
