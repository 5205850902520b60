"""The paper's claims for readers: what became of them, and what is misprinted."""

from collections.abc import Sequence

from laticauda.paper.claims.claim import Claim
from laticauda.paper.claims.misprints import Misprint, misprints
from laticauda.reports.chapter import Chapter
from laticauda.reports.page import Heading, Paragraph, Section
from laticauda.reports.tables import Column, Table

TITLE = "The paper's claims"
NOTE = (
    "A verdict follows from the rule beside it and from the numbers. A rule of several parts (set apart by semicolons, "
    "or one for each gait or group) holds when all of them are met, and in part when some are. The verdicts speak of "
    "what can be repeated here: simulations with the joints and coefficients that are named, and the measurements of "
    "Tables 1 and 2; the paper's own simulated curves are in its figures only. The paper's words are given in ours."
)


def claims_chapter(found: Sequence[Claim], wrong: Sequence[Misprint] | None = None) -> Chapter:
    """What the claims put into the folder and the report.

    Args:
        found: What `laticauda.paper.claims` returned.
        wrong: Misprints and contradictions; None takes all that are known.
    """
    tables = claims_table(found), misprint_table(misprints() if wrong is None else wrong)
    return Chapter(section=lambda pictures: claims_section(found, *tables), tables=tables)


def claims_section(found: Sequence[Claim], claims: Table, misprints: Table) -> Section:
    """The claims' part of the report.

    Args:
        found: What was found.
        claims: As a table.
        misprints: As a table.
    """
    counts = [(verdict, sum(claim.verdict == verdict for claim in found)) for verdict in _verdicts(found)]
    words = ", ".join(f"{verdict} {count}" for verdict, count in counts)
    return Section(
        name="claims",
        title=TITLE,
        parts=(
            Paragraph(text=f"{len(found)} statements of the paper's results, remarks and conclusions: {words}."),
            Paragraph(text=NOTE),
            claims,
            Heading(text="Misprints and contradictions"),
            misprints,
        ),
    )


def claims_table(found: Sequence[Claim]) -> Table:
    """Every claim, what it is judged by, and the verdict.

    Args:
        found: What was found.
    """
    return Table(
        name="claims",
        grouped=True,
        caption="What the paper claims and what the numbers say.",
        columns=(
            Column(name="about"),
            Column(name="where", wraps=True),
            Column(name="the paper says", wraps=True),
            Column(name="here", wraps=True),
            Column(name="rule: it holds if", wraps=True),
            Column(name="verdict"),
        ),
        rows=tuple((claim.theme, claim.where, claim.paper, claim.found, claim.rule, claim.verdict) for claim in found),
    )


def misprint_table(wrong: Sequence[Misprint]) -> Table:
    """Every misprint and contradiction.

    Args:
        wrong: What was found.
    """
    return Table(
        name="misprints",
        caption="Misprints of the paper, and places where it contradicts itself. Changes in percent are recomputed "
        "from the printed speeds and powers.",
        columns=(
            Column(name="where", wraps=True),
            Column(name="printed", wraps=True),
            Column(name="instead, or against it", wraps=True),
        ),
        rows=tuple((entry.where, entry.printed, entry.instead) for entry in wrong),
    )


def _verdicts(found: Sequence[Claim]) -> list[str]:
    """The verdicts that occur, the best first."""
    order = ("holds", "holds in part", "does not hold", "not tested here")
    return [verdict for verdict in order if any(claim.verdict == verdict for claim in found)]
