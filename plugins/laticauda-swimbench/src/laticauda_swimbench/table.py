"""The table of all methods, in Markdown."""

from collections.abc import Mapping, Sequence
from typing import Any

from laticauda_swimbench.challenges import CHALLENGES
from laticauda_swimbench.statistics import Estimate, Numbers, estimate, matrix, mean, over_runs


def row(content: Mapping[str, Any]) -> dict[str, Estimate]:
    """Return the mean score in each scored scenario, and the interquartile mean if these are all scenarios.

    Args:
        content: Content of a score file.
    """
    scores: dict[str, Numbers] = {part["name"]: matrix(part) for part in content["scenarios"]}
    found = {name: estimate([scores[name]], mean) for name in CHALLENGES if name in scores}
    if len(found) == len(CHALLENGES):
        found["all"] = estimate([scores[name] for name in CHALLENGES], over_runs)
    return found


def energy(content: Mapping[str, Any]) -> float:
    """Energy of all episodes divided by their progress in all [J/m]; nan if that is not positive.

    Args:
        content: Content of a score file.
    """
    found = [one for part in content["scenarios"] for one in part["results"]]
    progress = sum(one["progress"] for one in found)
    return sum(one["energy"] for one in found) / progress if progress > 0.0 else float("nan")


def table(contents: Sequence[Mapping[str, Any]]) -> str:
    """Return one line per method, the best first: the 95 % interval for all scenarios, half its width for each.

    Args:
        contents: Contents of score files.
    """
    rows = [(content["method"], row(content), energy(content)) for content in contents]
    rows.sort(key=lambda each: -each[1]["all"].value if "all" in each[1] else float("inf"))
    lines = [
        f"| method | all (IQM) | {' | '.join(CHALLENGES)} | J/m |",
        f"|---|---|{'---|' * len(CHALLENGES)}---|",
    ]
    for method, found, joules in rows:
        runs = f", {method['runs']} runs" if method["runs"] > 1 else ""
        cells = [_short(found[name]) if name in found else "" for name in CHALLENGES]
        whole = _long(found["all"]) if "all" in found else ""
        lines.append(f"| {method['name']}{runs} | {whole} | {' | '.join(cells)} | {joules:.0f} |")
    return "\n".join(lines)


def _long(one: Estimate) -> str:
    return f"{one.value:z.2f} ({one.low:z.2f} to {one.high:z.2f})"


def _short(one: Estimate) -> str:
    return f"{one.value:z.2f} ±{0.5 * (one.high - one.low):.2f}"
