"""Score files: the results of a method in each episode of the scenarios, and what produced them.

Equal inputs give equal files, to the last bit, on one machine with the same versions; only
`seconds` differs, and the checksum leaves it out.
"""

import hashlib
import json
import platform
import re
import time
from collections.abc import Callable, Mapping, Sequence
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any, cast

import numpy as np

from laticauda.values import LaticaudaError, __version__, read_text, read_toml, to_json
from laticauda_gym import Episodes
from laticauda_swimbench.challenges import CHALLENGES, Challenge, challenge
from laticauda_swimbench.methods import Method, method
from laticauda_swimbench.task import Swim

FORMAT = 1
"""Version of the format of score files; increases when their keys change."""
SCHEMA = Path(__file__).with_name("scores.schema.json")
"""JSON Schema of score files."""
UNCHECKED = ("seconds", "sha256")
"""Keys that the checksum does not cover."""
Progress = Callable[[float], None]


class BadScores(LaticaudaError, ValueError):
    """A score file that cannot be used: the file and the reason."""


def swum(
    challenge: Challenge, task: Swim, seeds: Sequence[int], method: Method, run: int
) -> list[dict[str, Any]]:
    """Swim episodes side by side, and return the results of each.

    Args:
        challenge: The scenario.
        task: Task of the scenario, or one of its tasks.
        seeds: Seeds of the episodes.
        method: Method that steers.
        run: Index of the method's run.
    """
    episodes, n = Episodes(task, len(seeds)), len(seeds)
    try:
        episodes.begin(np.full(n, True), [np.random.default_rng(seed) for seed in seeds])
        act, observed, well = (
            method.pilot(challenge, run, episodes),
            episodes.seen,
            np.full(n, True),
        )
        worth, square, begun = np.zeros(n), np.zeros(n), episodes.motion
        for _ in range(task.n_steps):
            actions = np.asarray(act(observed), dtype=float)
            if actions.shape != (n, len(task.actions)) or not np.isfinite(actions).all():
                rule = f"{n} rows of {len(task.actions)} finite numbers"
                raise BadScores(
                    f"{method.name}: returned actions of shape {actions.shape}, expected {rule}"
                )
            done = episodes.step(actions)
            worth += np.where(well, done.reward, 0.0)
            square += episodes.motion.y**2
            well &= ~done.terminated
            observed = done.observation
        after = episodes.motion
    finally:
        episodes.school.close()
    objective = worth / task.scenario.duration
    found = {
        "objective": objective,
        "score": (objective - challenge.baseline) / (challenge.reference - challenge.baseline),
        "progress": after.x - begun.x,
        "energy": after.work - begun.work,
        "cross_track_rms": np.sqrt(square / task.n_steps),
    }
    return [
        {"run": run, "seed": seed}
        | {name: float(one[i]) for name, one in found.items()}
        | {"failed": not well[i]}
        for i, seed in enumerate(seeds)
    ]


def results(
    name: str, method: Method, seeds: tuple[int, ...] | None = None
) -> list[dict[str, Any]]:
    """Return the results of all runs and episodes in a scenario, by run and seed.

    Args:
        name: Name of the scenario.
        method: Method that steers.
        seeds: Seeds of other episodes than the scored ones.
    """
    one = challenge(name)
    found = [
        each
        for run in range(method.runs)
        for task, mine in one.shares(seeds)
        for each in swum(one, task, mine, method, run)
    ]
    return sorted(found, key=lambda each: (each["run"], each["seed"]))


def score(
    policy: str | Method, scenarios: Sequence[str] = CHALLENGES, progress: Progress = lambda _: None
) -> dict[str, Any]:
    """Score a method.

    Args:
        policy: A baseline's name, the path of an .onnx or .npz file, or `module:name` of a Python
            callable (see `method`); or the method itself.
        scenarios: Names of the scenarios.
        progress: Called now and then with the completed share.

    Returns:
        The content of a score file.

    Raises:
        ValueError: If there is no such policy or scenario, or the policy returns something other
            than an action.
        ImportError: If the policy needs a package that is not installed.
    """
    chosen = policy if isinstance(policy, Method) else method(policy, scenarios)
    begun, parts = time.perf_counter(), list[dict[str, Any]]()
    for i, name in enumerate(scenarios):
        one = challenge(name)
        parts.append(
            {
                "name": name,
                "version": one.version,
                "sha256": one.sha256,
                "baseline": one.baseline,
                "reference": one.reference,
                "results": results(name, chosen),
            }
        )
        progress((i + 1) / len(scenarios))
    content: dict[str, Any] = {
        "format": "swimbench-scores",
        "format_version": FORMAT,
        "method": {
            name: getattr(chosen, name) for name in ("name", "kind", "sha256", "runs", "note")
        },
        "versions": installed_versions(),
        "scenarios": parts,
    }
    return content | {"seconds": round(time.perf_counter() - begun, 1), "sha256": checksum(content)}


def checksum(content: Mapping[str, Any]) -> str:
    """Return the SHA-256 of a score file: of its content without `UNCHECKED`, as JSON with sorted keys and no spaces.

    Args:
        content: Content of the file.
    """
    counted = {name: one for name, one in content.items() if name not in UNCHECKED}
    return hashlib.sha256(
        json.dumps(counted, sort_keys=True, separators=(",", ":")).encode()
    ).hexdigest()


def read_scores(path: str | Path) -> dict[str, Any]:
    """Return the content of a score file if its checksums are right and its scenarios are the installed ones.

    Args:
        path: Path of the file.

    Raises:
        BadScores: If they are not.
    """
    try:
        content: Any = json.loads(read_text(path, BadScores))
        is_right = content["sha256"] == checksum(content)
        parts = cast("list[dict[str, Any]]", content["scenarios"])
        is_ours = content["format"] == "swimbench-scores" and content["format_version"] == FORMAT
        others = [one["name"] for one in parts if one["sha256"] != challenge(one["name"]).sha256]
    except (ValueError, KeyError, TypeError) as error:
        if isinstance(error, BadScores):
            raise
        raise BadScores(f"{path}: is not a score file: {error}") from None
    if not is_ours:
        raise BadScores(f"{path}: must be of the format swimbench-scores {FORMAT}")
    if not is_right:
        raise BadScores(f"{path}: its checksum is wrong; it was changed after it was written")
    if others:
        raise BadScores(
            f"{path}: was scored in another version of {', '.join(others)}; score it again"
        )
    return content


def text_of(content: Mapping[str, Any]) -> str:
    """Return the text of a score file, with one line per episode.

    Args:
        content: Content as returned by `score`.
    """
    lines: list[str] = []

    def mark(one: Mapping[str, Any]) -> str:
        lines.append(json.dumps(one))
        return f"<{len(lines) - 1}>"

    parts = [
        {**part, "results": [mark(one) for one in part["results"]]} for part in content["scenarios"]
    ]
    text = to_json({**content, "scenarios": parts})
    return re.sub(r'"<(\d+)>"', lambda found: lines[int(found[1])], text) + "\n"


def installed_versions() -> dict[str, str]:
    """Return the versions of what computes a score."""
    return {
        "laticauda": __version__,
        "laticauda-swimbench": _own_version(),
        "numpy": np.__version__,
        "python": platform.python_version(),
        "machine": platform.machine(),
    }


def _own_version() -> str:
    try:
        return version("laticauda-swimbench")
    except PackageNotFoundError:  # run from a clone
        project = read_toml(Path(__file__).parents[2] / "pyproject.toml")["project"]
        return str(project["version"])
