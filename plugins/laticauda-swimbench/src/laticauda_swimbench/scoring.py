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

FORMAT_NAME = "swimbench-scores"
"""Name of the format of score files."""
FIELDS_OF_METHOD = ("name", "kind", "sha256", "runs", "note")
"""What a score file says of the method."""
FORMAT = 1
"""Version of the format of score files; increases when their keys change."""
SCHEMA = Path(__file__).with_name("scores.schema.json")
"""JSON Schema of score files."""
UNCHECKED = ("seconds", "sha256")
"""Keys that the checksum does not cover."""
Progress = Callable[[float], None]


class BadScores(LaticaudaError, ValueError):
    """A score file that cannot be used: the file and the reason."""


def swim_episodes(
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
    n = len(seeds)
    episodes = Episodes(task, n)
    is_well = np.full(n, True)
    total_reward = np.zeros(n)
    sum_of_squared_y = np.zeros(n)
    try:
        episodes.begin(np.full(n, True), [np.random.default_rng(seed) for seed in seeds])
        act = method.pilot(challenge, run, episodes)
        observation = episodes.seen
        start = episodes.motion
        for _ in range(task.n_steps):
            actions = _check_actions(act(observation), n, task, method)
            outcome = episodes.step(actions)
            total_reward += np.where(is_well, outcome.reward, 0.0)
            sum_of_squared_y += episodes.motion.y**2
            is_well &= ~outcome.terminated
            observation = outcome.observation
        end = episodes.motion
    finally:
        episodes.school.close()
    objective = total_reward / task.scenario.duration
    figures = {
        "objective": objective,
        "score": (objective - challenge.baseline) / (challenge.reference - challenge.baseline),
        "progress": end.x - start.x,
        "energy": end.work - start.work,
        "cross_track_rms": np.sqrt(sum_of_squared_y / task.n_steps),
    }
    results_of_seeds: list[dict[str, Any]] = []
    for i, seed in enumerate(seeds):
        result: dict[str, Any] = {"run": run, "seed": seed}
        for name, values in figures.items():
            result[name] = float(values[i])
        result["failed"] = not is_well[i]
        results_of_seeds.append(result)
    return results_of_seeds


def _check_actions(answer: Any, n: int, task: Swim, method: Method) -> np.ndarray:
    """Return what a policy answers, if it is an action for each of n robots."""
    actions = np.asarray(answer, dtype=float)
    if actions.shape != (n, len(task.actions)) or not np.isfinite(actions).all():
        rule = f"{n} rows of {len(task.actions)} finite numbers"
        raise BadScores(
            f"{method.name}: returned actions of shape {actions.shape}, expected {rule}"
        )
    return actions


def results(
    name: str, method: Method, seeds: tuple[int, ...] | None = None
) -> list[dict[str, Any]]:
    """Return the results of all runs and episodes in a scenario, by run and seed.

    Args:
        name: Name of the scenario.
        method: Method that steers.
        seeds: Seeds of other episodes than the scored ones.
    """
    scenario = challenge(name)
    all_results: list[dict[str, Any]] = []
    for run in range(method.runs):
        for share in scenario.shares(seeds):
            all_results += swim_episodes(scenario, share.task, share.seeds, method, run)
    return sorted(all_results, key=lambda result: (result["run"], result["seed"]))


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
    scored = policy
    if not isinstance(scored, Method):
        scored = method(scored, scenarios)
    began = time.perf_counter()
    parts: list[dict[str, Any]] = []
    for i, name in enumerate(scenarios):
        parts.append(_score_in(challenge(name), scored))
        progress((i + 1) / len(scenarios))
    content: dict[str, Any] = {
        "format": FORMAT_NAME,
        "format_version": FORMAT,
        "method": {field: getattr(scored, field) for field in FIELDS_OF_METHOD},
        "versions": installed_versions(),
        "scenarios": parts,
    }
    seconds = round(time.perf_counter() - began, 1)
    return {**content, "seconds": seconds, "sha256": checksum(content)}


def _score_in(challenge: Challenge, scored: Method) -> dict[str, Any]:
    """Return a score file's entry for a scenario."""
    return {
        "name": challenge.name,
        "version": challenge.version,
        "sha256": challenge.sha256,
        "baseline": challenge.baseline,
        "reference": challenge.reference,
        "results": results(challenge.name, scored),
    }


def checksum(content: Mapping[str, Any]) -> str:
    """Return the SHA-256 of a score file: of its content without `UNCHECKED`, as JSON with sorted keys and no spaces.

    Args:
        content: Content of the file.
    """
    checked = {key: value for key, value in content.items() if key not in UNCHECKED}
    text = json.dumps(checked, sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(text.encode()).hexdigest()


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
        is_of_format = (content["format"], content["format_version"]) == (FORMAT_NAME, FORMAT)
        others = [
            part["name"] for part in parts if part["sha256"] != challenge(part["name"]).sha256
        ]
    except BadScores:
        raise
    except (ValueError, KeyError, TypeError) as error:
        raise BadScores(f"{path}: is not a score file: {error}") from None
    if not is_of_format:
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
    parts: list[dict[str, Any]] = []
    for part in content["scenarios"]:
        placeholders: list[str] = []
        for result in part["results"]:
            placeholders.append(f"<{len(lines)}>")
            lines.append(json.dumps(result))
        parts.append({**part, "results": placeholders})
    text = to_json({**content, "scenarios": parts})
    return re.sub(r'"<(\d+)>"', lambda placeholder: lines[int(placeholder[1])], text) + "\n"


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
