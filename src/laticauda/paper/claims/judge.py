"""All claims of the paper, judged by the available studies: one rule for all claims in the table `claims.toml`.

Also the paper's misprints, and places where it contradicts itself.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, reduce
from itertools import combinations
from pathlib import Path
from typing import Any, Literal

import numpy as np

from laticauda.paper import efficiency, measured, path_following, runs, side_trials
from laticauda.paper.claims import quantities
from laticauda.paper.report.chapter import paper_templates
from laticauda.show.reports.chapter import in_digits
from laticauda.values.files import read_toml

Verdict = Literal["holds", "holds in part", "does not hold", "not tested here"]
STUDIES: Mapping[str, tuple[type[runs.Study[Any]], str]] = {
    "efficiency": (efficiency.EfficiencyStudy, "the efficiency study"),
    "following": (path_following.PathFollowingStudy, "the path-following study"),
    "side": (side_trials.SideTrials, "the side trials"),
}
"""Studies that the table of claims needs, by their names there."""

RULES: Mapping[str, Callable[[Any, Any], Any]] = {
    "at_most": lambda values, limit: np.all(values <= limit),
    "at_least": lambda values, limit: np.all(values >= limit),
    "below": lambda values, limit: np.all(values < limit),
    "above": lambda values, limit: np.all(values > limit),
    "within": lambda values, ends: np.all((values >= ends[0]) & (values <= ends[1])),
    "any_above": lambda values, limit: np.any(values > limit),
    "most_below": lambda values, limit: 2 * np.sum(values < limit) > values.size,
    "median_at_least": lambda values, limit: np.median(values) >= limit,
    "spans": lambda values, ends: np.allclose(
        [values.min(), values.max()], ends, rtol=0.0, atol=measured.PRINTED_TO
    ),
}
"""Conditions on the numbers of a part of a rule; all numbers must meet them, unless the name says otherwise."""


@dataclass(frozen=True, kw_only=True)
class Claim:
    """One statement of the paper, and the verdict on it."""

    key: str
    """Short, unique key for references."""
    theme: str
    """Subject, in a word or two."""
    where: str
    """Section of the paper, and its table or figure."""
    paper: str
    """What the paper says, in our words and with its numbers."""
    found: str
    """Numbers relevant to it, from the paper's tables and from the simulation, with the joint law."""
    rule: str
    """Condition for it to hold; all parts must be met, and it holds in part if only some are."""
    verdict: Verdict
    """Verdict that follows from the rule and the numbers."""


def load_claims(*studies: runs.Study[Any]) -> tuple[Claim, ...]:
    """Return the claims of the paper's results, remarks and conclusions, judged by the studies.

    Args:
        studies: Results of `run_efficiency`, `run_path_following` and `run_side_trials` with the
            paper's settings: all its groups, cases and sweeps. Claims about missing studies are not
            tested; other studies are ignored.
    """
    given = {
        name: study
        for study in studies
        for name, (kind, _) in STUDIES.items()
        if isinstance(study, kind)
    }
    known: dict[str, Any] = {
        "tables": quantities.tables(),
        "robots": quantities.robots(),
        "models": quantities.MODELS,
    }
    known |= {name: getattr(quantities, name)(study) for name, study in given.items()}
    if isinstance(following := given.get("following"), path_following.PathFollowingStudy):
        known["ways"] = [
            {**known, "following": quantities.following(way)} for way in following.ways
        ]
    if {"side", "efficiency"} <= given.keys():
        known["side"]["optima"] = [known["efficiency"]["optimum"], known["side"]["optimum"]]
    return tuple(_judged(entry, known) for entry in read_claims_table()["claims"])


def verdict(*parts: bool) -> Verdict:
    """Return the verdict on a claim with these parts: all must be met; a claim without parts is not tested.

    Args:
        parts: Whether each part is met.
    """
    if not parts:
        return "not tested here"
    return "holds" if all(parts) else "holds in part" if any(parts) else "does not hold"


@cache
def read_claims_table() -> Mapping[str, Sequence[Mapping[str, Any]]]:
    """Return the content of `claims.toml`; white space in texts is reduced to single spaces."""

    def flat(value: Any) -> Any:
        return " ".join(value.split()) if isinstance(value, str) else value

    return {
        kind: [{name: flat(value) for name, value in entry.items()} for entry in entries]
        for kind, entries in read_toml(Path(__file__).with_name("claims.toml")).items()
    }


def _judged(entry: Mapping[str, Any], known: Mapping[str, Any]) -> Claim:
    missing = [STUDIES[name][1] for name in entry["needs"] if name not in known]
    if missing:
        found, parts = f"Not run: {', '.join(missing)}.", []
    else:
        found = _text(entry["found"], known)
        parts = _parts(entry, known)
        if entry.get("in_all_ways") and len(ways := known["ways"]) > 1:
            n_held = sum(all(_parts(entry, way)) for way in ways)
            found += f" The claim holds in {n_held} of {len(ways)} ways to run the trials (joint law and bandwidth)."
    texts = {name: entry[name] for name in ("key", "theme", "where", "paper", "rule")}
    return Claim(**texts, found=found, verdict=verdict(*parts))


def _parts(entry: Mapping[str, Any], known: Mapping[str, Any]) -> list[bool]:
    """Return whether the numbers meet each part of a rule."""
    return [met for part in entry.get("parts", ()) for met in _met(part, known)]


def _met(part: Mapping[str, Any], known: Mapping[str, Any]) -> list[bool]:
    """Return whether the numbers of a part meet it, all together or individually."""
    ((rule, limit),) = ((name, value) for name, value in part.items() if name in RULES)
    path: str = part.get("each") or part["of"]
    values = np.atleast_1d(
        np.array(reduce(lambda inside, name: inside[name], path.split("."), known), dtype=float)
    )
    rows = values[:, np.newaxis] if "each" in part else [values]
    return [bool(RULES[rule](row, limit)) for row in rows]


# ---- words ---------------------------------------------------------------------------------------


_OF_LIMITS: Mapping[str, Callable[[Any, Any], Any]] = {
    "exceeding": lambda values, limit: [value > limit for value in values],
    "reached": lambda value, unit: (
        f"{value:.2f} {unit}" if math.isfinite(value) else "(not reached in all cases)"
    ),
    "reaching": lambda values, limit: [value >= limit for value in values],
    "reaching_at_most": lambda values, limit: [value <= limit for value in values],
}
_OF_VALUES: Mapping[str, Callable[[Any], Any]] = {
    "falling": lambda values: [value < 0.0 for value in values],
    "median": np.median,
    "shares": lambda values: f"{sum(values)} of {len(values)}",
}


def _text(template: str, known: Mapping[str, Any]) -> str:
    return " ".join(_template(template).render(known).split())


@cache
def _template(text: str) -> Any:
    plain = paper_templates().overlay(autoescape=False)
    plain.filters = {
        **plain.filters,
        **_OF_LIMITS,
        **_OF_VALUES,
        "percent": percent,
        "spread": format_spread,
    }
    return plain.from_string(text)


def percent(value: float, form: str = "+.0f") -> str:
    """Format a change in percent.

    Args:
        value: Change [%].
        form: Format of the number, as Python's `format` takes it.
    """
    return f"{in_digits(value, form)} %"


def format_spread(values: Sequence[float], form: str = "+.0f", unit: str = "%") -> str:
    """Format the range from the smallest to the largest of several values.

    Args:
        values: At least one value.
        form: Format of the numbers, as Python's `format` takes it.
        unit: Unit of the values.
    """
    return f"{in_digits(min(values), form)} to {in_digits(max(values), form)} {unit}"


# ---- misprints -----------------------------------------------------------------------------------


@dataclass(frozen=True, kw_only=True)
class Misprint:
    """One misprint, or one statement that the paper contradicts elsewhere."""

    where: str
    """Section, table or figure."""
    printed: str
    """What is printed."""
    instead: str
    """What it should be, or what it contradicts, and how that is known."""


def misprints() -> tuple[Misprint, ...]:
    """Return misprints and contradictions of the paper; those in its numbers are recomputed from its tables."""
    known = {"tables": quantities.tables(), "robots": quantities.robots()}
    in_words = [
        {name: _text(text, known) for name, text in entry.items()}
        for entry in read_claims_table()["misprints"]
    ]
    return (*_changes(), *_same_speed(), *(Misprint(**texts) for texts in in_words))


def _changes() -> Iterator[Misprint]:
    """Yield printed changes due to the fin that do not follow from the rows of the tables."""
    for number, rows in ((1, measured.efficiency_trials()), (2, measured.path_following_trials())):
        for change in measured.printed_changes(rows):
            for what, (printed, found) in change.misprints.items():
                name, unit = {
                    "power": ("mean_power", "W"),
                    "velocity": ("forward_velocity", "m/s"),
                }[what]
                before, after = getattr(change.without, name), getattr(change.with_fin, name)
                own = (
                    f"from {before:g} to {after:g} {unit} in"
                    if number == 1
                    else "from the numbers of"
                )
                yield Misprint(
                    where=f"Table {number}, {change.with_fin.group}, case {change.with_fin.case}",
                    printed=f"Change of {what}: {percent(printed, '+.2f')}.",
                    instead=f"{percent(found, '+.2f')}, {own} the same table.",
                )


def _same_speed() -> Iterator[Misprint]:
    """Yield pairs of settings of one group with the same speed to four digits."""
    for one, other in combinations(measured.efficiency_trials(), 2):
        if one.group == other.group and one.forward_velocity is not None:
            if one.forward_velocity == other.forward_velocity:
                yield Misprint(
                    where=f"Table 1, {one.group}",
                    printed=f"{one.forward_velocity:.4f} m/s at two settings, of which each is a maximum of its sweep.",
                    instead="One may have been copied from the other; nothing tells which.",
                )
