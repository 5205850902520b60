"""All claims of the paper, judged by the available studies.

One procedure serves all claims in `claims.toml`: collect the numbers of the studies, tell those
that the claim is about in a sentence, and check the parts of its rule.
"""

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from laticauda.paper.claims import rules, sentences
from laticauda.paper.claims.efficiency_numbers import collect_efficiency_numbers
from laticauda.paper.claims.following_numbers import collect_following_numbers
from laticauda.paper.claims.printed_numbers import (
    MODELS,
    Numbers,
    collect_robot_numbers,
    collect_table_numbers,
)
from laticauda.paper.claims.side_numbers import collect_side_numbers
from laticauda.paper.claims.table import Entry, read_claims_table
from laticauda.paper.efficiency import EfficiencyStudy
from laticauda.paper.path_following import PathFollowingStudy
from laticauda.paper.runs import Study
from laticauda.paper.side_trials import SideTrials

Verdict = Literal["holds", "holds in part", "does not hold", "not tested here"]


VERB_FORMS: Mapping[Verdict, tuple[str, str]] = {
    "holds": ("holds", "hold"),
    "holds in part": ("holds in part", "hold in part"),
    "does not hold": ("does not hold", "do not hold"),
    "not tested here": ("is not tested here", "are not tested here"),
}
"""All verdicts, the best first, as they follow one claim and several."""


@dataclass(frozen=True, kw_only=True)
class Claim:
    """One statement of the paper, and the verdict on it."""

    key: str
    """Short, unique key for references."""
    theme: str
    """Subject, in a word or two."""
    section: str
    """Section of the paper, and its table or figure."""
    paper: str
    """What the paper says, in our words and with its numbers."""
    evidence: str
    """Numbers relevant to it, from the paper's tables and the simulation, with the joint law."""
    rule: str
    """Condition for it to hold; all parts must be met, and it holds in part if only some are."""
    verdict: Verdict
    """Verdict that follows from the rule and the numbers."""


@dataclass(frozen=True, kw_only=True)
class KnownStudy:
    """A study whose numbers claims may need."""

    study_class: type[Study[Any]]
    """Class of its results."""
    title: str
    """Name of the study in sentences."""
    collect_numbers: Callable[[Any], Numbers]
    """Function that returns its numbers."""


STUDIES: Mapping[str, KnownStudy] = {
    "efficiency": KnownStudy(
        study_class=EfficiencyStudy,
        title="the efficiency study",
        collect_numbers=collect_efficiency_numbers,
    ),
    "following": KnownStudy(
        study_class=PathFollowingStudy,
        title="the path-following study",
        collect_numbers=collect_following_numbers,
    ),
    "side": KnownStudy(
        study_class=SideTrials,
        title="the side trials",
        collect_numbers=collect_side_numbers,
    ),
}
"""Studies that the table of claims needs, by their names there."""


def load_claims(*studies: Study[Any]) -> tuple[Claim, ...]:
    """Return the claims of the paper's results, remarks and conclusions, judged by the studies.

    Args:
        studies: Results of `run_efficiency`, `run_path_following` and `run_side_trials` with the
            paper's settings: all its groups, cases and sweeps. Claims about missing studies are not
            tested; other studies are ignored.
    """
    numbers = _collect_numbers(*studies)
    numbers_of_ways = _collect_numbers_of_ways(numbers, *studies)
    entries = read_claims_table()["claims"]
    return tuple(_judge_claim(entry, numbers, numbers_of_ways) for entry in entries)


def count_verdicts(claims: Sequence[Claim]) -> dict[Verdict, int]:
    """Return the number of claims with each verdict that occurs, the best verdict first.

    Args:
        claims: Any claims.
    """
    counts = Counter(claim.verdict for claim in claims)
    return {verdict: counts[verdict] for verdict in VERB_FORMS if counts[verdict]}


def summarize_verdicts(claims: Sequence[Claim]) -> str:
    """Return the counts in words: "7 of 32 claims hold, 17 hold in part, 8 do not hold".

    Args:
        claims: At least one claim.
    """
    parts: list[str] = []
    for verdict, count in count_verdicts(claims).items():
        singular, plural = VERB_FORMS[verdict]
        verb = plural
        if count == 1:
            verb = singular
        number = f"{count}"
        if not parts:
            number = f"{count} of {len(claims)} claims"
        parts.append(f"{number} {verb}")
    return ", ".join(parts)


def judge_parts(*parts_met: bool) -> Verdict:
    """Return the verdict on a claim: all parts must be met; without parts it is not tested.

    Args:
        parts_met: Whether each part is met.
    """
    if not parts_met:
        return "not tested here"
    if all(parts_met):
        return "holds"
    if any(parts_met):
        return "holds in part"
    return "does not hold"


def _judge_claim(entry: Entry, numbers: Numbers, numbers_of_ways: list[Numbers]) -> Claim:
    evidence, verdict = _examine(entry, numbers, numbers_of_ways)
    return Claim(
        key=entry["key"],
        theme=entry["theme"],
        section=entry["section"],
        paper=entry["paper"],
        evidence=evidence,
        rule=entry["rule"],
        verdict=verdict,
    )


def _examine(entry: Entry, numbers: Numbers, numbers_of_ways: list[Numbers]) -> tuple[str, Verdict]:
    """Return the sentence on a claim, and the verdict."""
    missing_studies = [STUDIES[name].title for name in entry["needs"] if name not in numbers]
    if missing_studies:
        return f"Not run: {', '.join(missing_studies)}.", "not tested here"
    evidence = sentences.fill_in(entry["evidence"], numbers)
    if entry.get("in_all_ways") and len(numbers_of_ways) > 1:
        n_ways = len(numbers_of_ways)
        n_held = sum(all(rules.check_parts(entry, way)) for way in numbers_of_ways)
        evidence += (
            f" The claim holds in {n_held} of {n_ways} ways to run the trials"
            " (joint law and bandwidth)."
        )
    return evidence, judge_parts(*rules.check_parts(entry, numbers))


# ---- numbers -------------------------------------------------------------------------------------


def _collect_numbers(*studies: Study[Any]) -> Numbers:
    """Return all numbers that claims may refer to, by the names in `claims.toml`."""
    numbers: Numbers = {
        "tables": collect_table_numbers(),
        "robots": collect_robot_numbers(),
        "models": MODELS,
    }
    for study in studies:
        for name, known_study in STUDIES.items():
            if isinstance(study, known_study.study_class):
                numbers[name] = known_study.collect_numbers(study)
    if "side" in numbers and "efficiency" in numbers:
        optima = [numbers["efficiency"]["optimum"], numbers["side"]["optimum"]]
        numbers["side"]["optima"] = optima
    return numbers


def _collect_numbers_of_ways(numbers: Numbers, *studies: Study[Any]) -> list[Numbers]:
    """Return the numbers for each way of the path-following study, as if that were chosen."""
    numbers_of_ways: list[Numbers] = []
    for study in studies:
        if isinstance(study, PathFollowingStudy):
            numbers_of_ways = [
                {**numbers, "following": collect_following_numbers(way)} for way in study.ways
            ]
    return numbers_of_ways
