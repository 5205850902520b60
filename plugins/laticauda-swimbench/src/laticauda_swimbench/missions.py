"""Two missions of SwimBench: whoever steers gets what the sensors tell, and nothing of the scene.

A file fixes everything: its `scenario_version` and `seeds`, the two ends of its scale, the
conditions from which every seed draws current, waves, start and a failing sensor, and the whole
laticauda scenario under `mission`, whose controller is the reference.

    inspection   J = c S (1 + D) / 2 - E / F   S share of the net seen, D 1 if docked else 0,
                                               c 0 if the body went through the net, else 1
    station      J = mean of 1 / (1 + (d / d_1)^2) - E / F    d distance from the point

E is the electrical energy that the robot took. The score is (J - J_0) / (J_1 - J_0): 0 for a robot
that rests, 1 for the reference.
"""

import inspect
import json
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from importlib import import_module
from pathlib import Path
from types import SimpleNamespace
from typing import Any, Literal, cast

import numpy as np

import laticauda as lc
from laticauda.missions import (
    Conditions,
    Mission,
    Phase,
    Rest,
    change_scenario,
    draw_conditions,
    find_net,
    load_mission,
    measure_clearance,
    measure_share_seen,
    swim_to_dock,
)
from laticauda.robot import Robot
from laticauda.scenarios import Command, Observation, Scenario, run_from_table
from laticauda.sensing import Sonar
from laticauda.trials import Trial
from laticauda.values import BadArgument, check_choice, codec, read_text, write
from laticauda_swimbench.challenge_files import read_challenge_file
from laticauda_swimbench.scoring import BadScores, checksum, installed_versions, text_of

HERE = Path(__file__).parent
FOLDER = HERE / "mission_files"
RESULTS = HERE / "mission_results"
"""Score files of the baselines."""
MISSIONS = ("inspection", "station")
"""Names of the missions, in the order of the table."""
FORMAT = 1
"""Version of the format of their score files."""
NO_BEACON = "none"
"""Name of a sensor that no robot has."""


@dataclass(frozen=True, kw_only=True)
class MissionChallenge:
    """A mission of the benchmark."""

    name: str
    """Name, as in `MISSIONS`."""
    version: int
    """Version of the file."""
    description: str
    """Description in one line."""
    sha256: str
    """SHA-256 of the file."""
    task: Literal["inspection", "station"]
    """What is scored."""
    seeds: tuple[int, ...]
    """Seeds, one per scored run."""
    scenario: Scenario
    """The mission, with the reference as its controller."""
    conditions: Conditions
    """What every seed draws from."""
    energy: float
    """F, energy that costs as much as the whole task is worth [J]."""
    tolerance: float
    """d_1, distance from the point at which staying counts half [m]."""
    baseline: float
    """J that gives a score of 0, of a robot that rests [-]."""
    reference: float
    """J that gives a score of 1 [-]."""

    def score(self, objective: float) -> float:
        """Return the score (J - J_0) / (J_1 - J_0) of an `objective` J."""
        return (objective - self.baseline) / (self.reference - self.baseline)


@cache
def mission_challenge(name: str) -> MissionChallenge:
    """Return a mission of the benchmark.

    Args:
        name: One of `MISSIONS`.

    Raises:
        ValueError: If there is no mission of that name.
    """
    file = FOLDER / f"{check_choice('mission', name, MISSIONS)}.toml"
    table, sha256 = read_challenge_file(file)
    scale = table["score"]
    return MissionChallenge(
        name=name,
        version=table["scenario_version"],
        description=table["description"],
        sha256=sha256,
        task=table["task"],
        seeds=tuple(table["seeds"]),
        scenario=cast(Scenario, run_from_table(table["mission"])),
        conditions=codec.decode(Conditions, table["conditions"]),
        energy=scale["energy"],
        tolerance=scale.get("tolerance", 1.0),
        baseline=scale["baseline"],
        reference=scale["reference"],
    )


class BySensors(lc.Controller[Any]):
    """Hands a controller time, joints and readings only: it cannot see where it is, nor the scene.

    Args:
        controller: The controller.
    """

    def __init__(self, controller: lc.Controller[Any]) -> None:
        self.controller = controller
        self.gait = controller.gait
        self.interval = controller.interval

    def init(self) -> Any:
        """Return the state of the controller before the first control instant."""
        return self.controller.init()

    def step(self, state: Any, observation: Observation) -> tuple[Any, Command]:
        """Return the next state, from `state` and what the sensors tell of `observation`, and the command."""
        sensed: Any = SimpleNamespace(
            time=observation.time,
            joint_angle=observation.joint_angle,
            joint_rate=observation.joint_rate,
            readings=observation.readings,
        )
        return self.controller.step(state, sensed)

    def check(self, robot: Robot) -> None:
        """Have the controller look at the `robot`."""
        self.controller.check(robot)


# ---- who steers ----------------------------------------------------------------------------------

Maker = Callable[[MissionChallenge], lc.Controller[Any]]
"""Makes the controller of a run in a mission."""


def _reference(challenge: MissionChallenge) -> Mission:
    """Return the mission in the file."""
    return cast(Mission, challenge.scenario.motion)


def _dead_reckoning(challenge: MissionChallenge) -> Mission:
    """Return the mission in the file, deaf to the beacon."""
    mission = _reference(challenge)
    return replace(mission, navigation=replace(mission.navigation, position=NO_BEACON))


def _resting(challenge: MissionChallenge) -> Mission:
    """Return a mission that moves no joint."""
    rest = Phase(name="rest", behaviour=Rest(), avoids=False)
    return replace(_reference(challenge), phases=(rest,), always=())


BASELINES: dict[str, Maker] = {
    "reference": _reference,
    "dead-reckoning": _dead_reckoning,
    "rest": _resting,
}
"""Baselines by name: the stored mission, the same without its beacon, and a robot that rests."""


def _maker_of(policy: str) -> Maker:
    """Return what makes the controllers of a policy: a baseline, a mission file, or `module:name`."""
    if policy in BASELINES:
        return BASELINES[policy]
    if policy.endswith(".toml"):
        motion = cast("lc.Controller[Any]", load_mission(policy).motion)
        return lambda challenge: motion
    module, _, name = policy.partition(":")
    if not name:
        listed = ", ".join(f"`{known}`" for known in BASELINES)
        rule = f"must be {listed}, a mission file *.toml, or module:name of a controller"
        raise BadArgument("policy", f"{rule}, got {policy}")
    named: Any = getattr(import_module(module), name, None)
    if inspect.isclass(named):
        make_controller: Any = named
        return lambda challenge: make_controller()
    if not isinstance(named, lc.Controller):
        raise BadArgument("policy", f"must name a controller or its class, got {policy}")
    controller = cast("lc.Controller[Any]", named)
    return lambda challenge: controller


# ---- scores --------------------------------------------------------------------------------------


def mission_results(
    challenge: MissionChallenge, maker: Maker, seeds: Sequence[int] | None = None
) -> list[dict[str, Any]]:
    """Return the result of every run, by seed.

    Args:
        challenge: The mission.
        maker: Makes the controllers.
        seeds: Seeds of other runs than the scored ones.
    """
    chosen = challenge.seeds if seeds is None else seeds
    scenarios: list[Scenario] = []
    for seed in chosen:
        draw = draw_conditions(challenge.conditions, seed)
        scenario = change_scenario(challenge.scenario, challenge.conditions, draw)
        scenarios.append(replace(scenario, motion=BySensors(maker(challenge))))
    results: list[dict[str, Any]] = []
    for seed, trial in zip(chosen, swim_to_dock(scenarios), strict=True):
        result = _judge(challenge, trial)
        objective = result["worth"] - result["energy"] / challenge.energy
        score = challenge.score(objective)
        results.append({"seed": seed, "objective": objective, "score": score, **result})
    return results


def _judge(challenge: MissionChallenge, trial: Trial) -> dict[str, Any]:
    """Return what came of a run, by what is true."""
    duration = float(trial.time[-1])
    assert trial.electrical_work is not None
    figures: dict[str, Any] = {"duration": duration, "energy": float(trial.electrical_work[-1])}
    if challenge.task == "station":
        distance = np.hypot(trial.center_of_mass[:, 0], trial.center_of_mass[:, 1])
        nearness = 1.0 / (1.0 + (distance / challenge.tolerance) ** 2)
        rms_distance = float(np.sqrt(np.mean(distance**2)))
        return {**figures, "worth": float(np.mean(nearness)), "rms_distance": rms_distance}
    model = challenge.scenario.model
    net = find_net(model.places)
    (sonar,) = [sensor for sensor in model.sensors if isinstance(sensor, Sonar)]
    assert net is not None
    share_seen = measure_share_seen(trial, net, sonar)
    clearance = measure_clearance(trial)
    is_docked = duration < challenge.scenario.duration - 1e-9
    worth = 0.0
    if clearance > 0.0:
        worth = 0.5 * share_seen * (1 + is_docked)
    return {
        **figures,
        "worth": worth,
        "share_seen": share_seen,
        "docked": is_docked,
        "clearance": clearance,
    }


def score_missions(policy: str, missions: Sequence[str] = MISSIONS) -> dict[str, Any]:
    """Score who steers in the missions.

    Args:
        policy: A baseline's name, the path of a mission file, or `module:name` of a laticauda
            controller or its class.
        missions: Names of the missions.

    Returns:
        The content of a score file.

    Raises:
        ValueError: If there is no such policy or mission.
    """
    maker = _maker_of(policy)
    began = time.perf_counter()
    parts: list[dict[str, Any]] = []
    for name in missions:
        challenge = mission_challenge(name)
        part = {key: getattr(challenge, key) for key in ("name", "version", "sha256")}
        part |= {"baseline": challenge.baseline, "reference": challenge.reference}
        parts.append({**part, "results": mission_results(challenge, maker)})
    content: dict[str, Any] = {
        "format": "swimbench-mission-scores",
        "format_version": FORMAT,
        "method": {"name": policy},
        "versions": installed_versions(),
        "scenarios": parts,
    }
    seconds = round(time.perf_counter() - began, 1)
    return {**content, "seconds": seconds, "sha256": checksum(content)}


def read_mission_scores(path: Path) -> dict[str, Any]:
    """Return the content of a score file if its checksums are right and its missions are the installed ones.

    Args:
        path: Path of the file.

    Raises:
        BadScores: If they are not.
    """
    content: dict[str, Any] = json.loads(read_text(path, BadScores))
    if content.get("sha256") != checksum(content):
        raise BadScores(f"{path}: its checksum is wrong; it was changed after it was written")
    for part in content["scenarios"]:
        if part["sha256"] != mission_challenge(part["name"]).sha256:
            raise BadScores(
                f"{path}: was scored in another version of {part['name']}; score it again"
            )
    return content


def write_mission_scores(content: Mapping[str, Any], folder: Path) -> None:
    """Write a score file.

    Args:
        content: Content as returned by `score_missions`.
        folder: Its folder, created if missing.
    """
    folder.mkdir(parents=True, exist_ok=True)
    stem = Path(content["method"]["name"]).name.removesuffix(".toml").replace(":", "-")
    write(folder / f"{stem}.json", text_of(content))


def mission_table(contents: Sequence[Mapping[str, Any]]) -> str:
    """Return one line per method, in Markdown: the mean score in each mission, and what came of its runs.

    Args:
        contents: Contents of score files.
    """
    lines = [
        "| method | inspection | docked | net seen | station | rms distance | kJ a run |",
        "|---|---|---|---|---|---|---|",
    ]
    for content in contents:
        results = {part["name"]: part["results"] for part in content["scenarios"]}
        cells = [content["method"]["name"]]
        cells += _cells_of_inspection(results.get("inspection", []))
        cells += _cells_of_station(results.get("station", []))
        energies = [run["energy"] for runs in results.values() for run in runs]
        cells.append(f"{np.mean(energies) / 1000.0:.1f}")
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def _cells_of_inspection(runs: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return score, docked and net seen; empty without runs."""
    if not runs:
        return ["", "", ""]
    n_docked = sum(run["docked"] for run in runs)
    share_seen = float(np.mean([run["share_seen"] for run in runs]))
    return [_mean_score(runs), f"{n_docked} of {len(runs)}", f"{100.0 * share_seen:.0f} %"]


def _cells_of_station(runs: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return score and distance; empty without runs."""
    if not runs:
        return ["", ""]
    mean_square = float(np.mean([run["rms_distance"] ** 2 for run in runs]))
    return [_mean_score(runs), f"{mean_square**0.5:.2f} m"]


def _mean_score(runs: Sequence[Mapping[str, Any]]) -> str:
    return f"{float(np.mean([run['score'] for run in runs])):z.2f}"
