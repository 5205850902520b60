"""The table of all methods, in Markdown."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from laticauda_swimbench.challenges import CHALLENGES
from laticauda_swimbench.statistics import Estimate, Numbers, estimate, matrix, mean, over_runs


def row(content: Mapping[str, Any]) -> dict[str, Estimate]:
    """Return the mean score in each scored scenario, and the interquartile mean if these are all scenarios.

    Args:
        content: Content of a score file.
    """
    scores: dict[str, Numbers] = {part["name"]: matrix(part) for part in content["scenarios"]}
    estimates = {name: estimate([scores[name]], mean) for name in CHALLENGES if name in scores}
    if len(estimates) == len(CHALLENGES):
        estimates["all"] = estimate([scores[name] for name in CHALLENGES], over_runs)
    return estimates


def energy(content: Mapping[str, Any]) -> float:
    """Energy of all episodes divided by their progress in all [J/m]; nan if that is not positive.

    Args:
        content: Content of a score file.
    """
    results: list[Mapping[str, Any]] = []
    for part in content["scenarios"]:
        results += part["results"]
    progress = sum(result["progress"] for result in results)
    if progress <= 0.0:
        return math.nan
    return sum(result["energy"] for result in results) / progress


def table(contents: Sequence[Mapping[str, Any]]) -> str:
    """Return one line per method, the best first: the 95 % interval for all scenarios, half its width for each.

    Args:
        contents: Contents of score files.
    """
    rows = [
        Row(method=content["method"], estimates=row(content), energy=energy(content))
        for content in contents
    ]
    rows.sort(key=lambda row: row.rank)
    lines = [
        f"| method | all (IQM) | {' | '.join(CHALLENGES)} | J/m |",
        f"|---|---|{'---|' * len(CHALLENGES)}---|",
    ]
    lines += [f"| {' | '.join(row.cells)} |" for row in rows]
    return "\n".join(lines)


@dataclass(frozen=True, kw_only=True)
class Row:
    """A line of the table."""

    method: Mapping[str, Any]
    """The method, as a score file describes it."""
    estimates: Mapping[str, Estimate]
    """Scores by scenario."""
    energy: float
    """Energy per progress [J/m]."""

    @property
    def rank(self) -> float:
        """Number by which rows are sorted, the least first: methods without all scenarios come last."""
        if "all" not in self.estimates:
            return math.inf
        return -self.estimates["all"].value

    @property
    def cells(self) -> list[str]:
        """Cells from left to right."""
        name = self.method["name"]
        if self.method["runs"] > 1:
            name += f", {self.method['runs']} runs"
        scores = [_write_short(self.estimates.get(name)) for name in CHALLENGES]
        return [name, _write_long(self.estimates.get("all")), *scores, f"{self.energy:.0f}"]


def _write_long(estimate: Estimate | None) -> str:
    if estimate is None:
        return ""
    return f"{estimate.value:z.2f} ({estimate.low:z.2f} to {estimate.high:z.2f})"


def _write_short(estimate: Estimate | None) -> str:
    if estimate is None:
        return ""
    return f"{estimate.value:z.2f} ±{0.5 * (estimate.high - estimate.low):.2f}"
