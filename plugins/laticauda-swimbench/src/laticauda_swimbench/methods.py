"""What can be scored: the baselines, and policies from outside.

A method has one or several runs; for each run and scenario, its `Pilot` makes a function from the
observations of all robots, in rows, to their actions. Laws are laticauda controllers, which are
called as `laticauda.run` calls them.
"""

import hashlib
import inspect
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from importlib import import_module
from pathlib import Path
from typing import Any, cast

import numpy as np

import laticauda as lc
from laticauda.control import AveragedModel, ModelPredictive
from laticauda.scenarios import Observations, VectorController, vectorize
from laticauda.values import BadArgument, check_choice, read_toml
from laticauda_gym import Episodes, Pilots
from laticauda_gym.packages import needed
from laticauda_swimbench import networks
from laticauda_swimbench.challenges import CHALLENGES, Challenge
from laticauda_swimbench.task import Swim

HERE = Path(__file__).parent
GAIT_NUMBERS = ("amplitude", "frequency", "phase_shift")
"""Numbers of a law that are its gait's."""
SCENARIO = "{scenario}"
"""Placeholder for the scenario's name in a policy that has one part per scenario."""
Act = Callable[[np.ndarray], np.ndarray]
"""Actions for observations, one row per robot."""
Pilot = Callable[[Challenge, int, Episodes], Act]
"""What steers robots in a scenario, from the start of their episodes, in one of the method's runs."""


@dataclass(frozen=True, kw_only=True)
class Method:
    """Something that can be scored."""

    name: str
    """Name in the table."""
    kind: str
    """What it is: open loop, law, searched law, plan, network, ONNX or callable."""
    sha256: str
    """SHA-256 of its content: its numbers, its weights, or the text of its module."""
    pilot: Pilot
    """Pilot that steers."""
    runs: int = 1
    """Number of runs: for a learner, one per training seed."""
    note: str = ""
    """What users should know about it."""


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


# ---- baselines -----------------------------------------------------------------------------------


def _open_loop(challenge: Challenge, run: int, episodes: Episodes) -> Act:
    """Swim straight ahead with the gait of the scenario: the middle of all actions."""
    return lambda observed: np.zeros((len(observed), len(episodes.middle)))


def _piloted(controller: lc.Controller[Any], episodes: Episodes) -> Act:
    """Steer every robot by the controller, by arrays if its class is written so; all episodes begin together."""
    steering = vectorize([controller] * episodes.n)
    if not isinstance(steering, VectorController):
        pilots = Pilots(controller, episodes)
        return lambda observed: pilots.actions()

    values_of_gait = {
        action.name: getattr(controller.gait, action.name) for action in episodes.task.actions
    }

    def act(observed: np.ndarray) -> np.ndarray:
        decisions = steering.step(_seen_by_controllers(episodes))
        commands = np.empty((episodes.n, len(values_of_gait)))
        for column, (name, value_of_gait) in enumerate(values_of_gait.items()):
            if name == "offset":
                commands[:, column] = value_of_gait + decisions.get("offset", 0.0)
            else:
                commands[:, column] = decisions.get(name, value_of_gait)
        return (commands - episodes.middle) / episodes.half

    return act


def _seen_by_controllers(episodes: Episodes) -> Observations:
    """Return what controllers see of all robots."""
    motion = episodes.motion
    return Observations(
        time=motion.time,
        center_of_mass=np.stack((motion.x, motion.y), axis=1),
        center_of_mass_velocity=np.stack((motion.velocity_x, motion.velocity_y), axis=1),
        heading=motion.heading,
        heading_rate=motion.heading_rate,
        is_well=episodes.school.is_well,
        observe=episodes.school.observe,
    )


def law(gait: lc.Gait, interval: float, numbers: dict[str, float]) -> lc.PathFollowing:
    """Return a guidance law along the x axis.

    Args:
        gait: Gait of the robot; its amplitude, frequency and phase shift may be among the numbers.
        interval: Time between two control instants [s].
        numbers: look_ahead_distance, gain, max_offset, and integral_gain for the integral law.
    """
    changes_of_gait = {name: numbers[name] for name in GAIT_NUMBERS if name in numbers}
    settings: dict[str, Any] = {
        name: number for name, number in numbers.items() if name not in GAIT_NUMBERS
    }
    settings["guidance"] = "line_of_sight"
    if "integral_gain" in numbers:
        settings["guidance"] = "integral_line_of_sight"
    following = lc.Following(interval=interval, **settings)
    return following.controller(replace(gait, **changes_of_gait))


def law_pilot(numbers: dict[str, float]) -> Pilot:
    """Return a pilot that steers every robot with a law.

    Args:
        numbers: As for `law`.
    """

    def pilot(challenge: Challenge, run: int, episodes: Episodes) -> Act:
        return _piloted(law(episodes.task.gait, episodes.task.interval, numbers), episodes)

    return pilot


def reference_law(challenge: Challenge, run: int, episodes: Episodes) -> Act:
    """Steer with the numbers that were found by the search in the scenario.

    Args:
        challenge: Scenario, whose file has these numbers.
        run: Number of the run; a law has only one.
        episodes: Episodes that are scored.
    """
    return law_pilot({**challenge.laws})(challenge, run, episodes)


def _plan(numbers: dict[str, Any]) -> Pilot:
    """Plan with the averaged model of the healthy robot in still water; the scenario's price sets the cost of power."""
    needed("The plan", "casadi")  # before anything is scored
    model = AveragedModel(**numbers["model"])
    low, high = numbers["frequency_limits"]

    def pilot(challenge: Challenge, run: int, episodes: Episodes) -> Act:
        task = cast(Swim, episodes.task)
        controller = ModelPredictive(
            gait=task.gait,
            path=lc.StraightLine(),
            model=model,
            interval=task.interval,
            max_offset=task.max_offset,
            frequency_limits=(low, high),
            power_tolerance=numbers["power_tolerance_per_price"] * task.price,
            speed=numbers["speed"],
            speed_tolerance=numbers["speed_tolerance"],
        )
        return _piloted(controller, episodes)

    return pilot


NUMBERS = read_toml(HERE / "baselines.toml")
"""Numbers of the baselines, by name."""


def _baseline(name: str, scenarios: Sequence[str]) -> Method:
    numbers = dict(NUMBERS[name])
    kind = numbers.pop("kind", "")
    title = numbers.pop("title", "")
    note = numbers.pop("note", "")
    if kind == "network":
        file = HERE / "policies" / f"{name}-{SCENARIO}.npz"
        return replace(_one_per_scenario(str(file), scenarios), name=title, note=note)
    content = repr(sorted(numbers.items())).encode()
    pilot = _pilot_of_kind(kind, numbers)
    return Method(name=title, kind=kind, note=note, sha256=_digest(content), pilot=pilot)


def _pilot_of_kind(kind: str, numbers: dict[str, Any]) -> Pilot:
    if kind == "open loop":
        return _open_loop
    if kind == "searched law":
        return reference_law
    if kind == "law":
        return law_pilot(numbers)
    return _plan(numbers)


# ---- from outside --------------------------------------------------------------------------------


def _import_policy(text: str) -> Method:
    """`module:name`: a function of an observation, a class of such callables, a controller, or its class."""
    module_name, _, name = text.partition(":")
    sys.path.insert(0, "")  # a module in the working directory
    try:
        module = import_module(module_name)
    except ImportError as error:
        raise BadArgument(
            "policy", f"must name a module that can be imported, got {text}: {error}"
        ) from error
    finally:
        sys.path.remove("")
    policy: Any = getattr(module, name, None)
    if not (callable(policy) or isinstance(policy, lc.Controller)):
        raise BadArgument("policy", f"must name a function, a class or a controller, got {text}")
    content = text.encode()
    file = inspect.getsourcefile(module)
    if file:
        content = Path(file).read_bytes()
    return Method(
        name=text, kind="callable", sha256=_digest(content), pilot=_pilot_of_policy(policy)
    )


def _pilot_of_policy(policy: Any) -> Pilot:
    """Return a pilot for a function, a class or a controller; every robot has an object of its own of a class."""

    def pilot(challenge: Challenge, run: int, episodes: Episodes) -> Act:
        policies: list[Any] = [policy] * episodes.n
        if inspect.isclass(policy):
            policies = [policy() for _ in range(episodes.n)]
        if isinstance(policies[0], lc.Controller):
            return _piloted(cast("lc.Controller[Any]", policies[0]), episodes)

        def act(observed: np.ndarray) -> np.ndarray:
            actions = [own(row) for own, row in zip(policies, observed, strict=True)]
            return np.array(actions, dtype=float)

        return act

    return pilot


def _onnx(file: Path) -> Method:
    """A network in an ONNX file: it takes rows of observations in float32, and its first output is the actions."""
    runtime = needed("A policy in an ONNX file", "onnxruntime")
    options = runtime.SessionOptions()
    # The same sums in the same order.
    options.intra_op_num_threads = 1
    options.inter_op_num_threads = 1
    session = runtime.InferenceSession(str(file), options, providers=["CPUExecutionProvider"])
    input_name = session.get_inputs()[0].name

    def act(observed: np.ndarray) -> np.ndarray:
        actions: list[np.ndarray] = []
        for row in observed.astype(np.float32):
            outputs = session.run(None, {input_name: row[np.newaxis]})
            actions.append(outputs[0])
        return np.concatenate(actions).astype(float)

    return Method(
        name=file.stem,
        kind="ONNX",
        sha256=_digest(file.read_bytes()),
        pilot=lambda challenge, run, episodes: act,
    )


def _weights(file: Path) -> Method:
    network_of_run = networks.load(file)
    return Method(
        name=file.stem,
        kind="network",
        sha256=_digest(file.read_bytes()),
        pilot=lambda challenge, run, episodes: network_of_run[run],
        runs=len(network_of_run),
    )


def _one_per_scenario(text: str, scenarios: Sequence[str]) -> Method:
    """One policy per scenario: the scenario's name replaces `{scenario}`."""
    methods = {name: method(text.replace(SCENARIO, name)) for name in scenarios}
    digests = "".join(method_of_scenario.sha256 for method_of_scenario in methods.values())

    def pilot(challenge: Challenge, run: int, episodes: Episodes) -> Act:
        return methods[challenge.name].pilot(challenge, run, episodes)

    return Method(
        name=Path(text).stem,
        kind=methods[scenarios[0]].kind,
        sha256=_digest(digests.encode()),
        pilot=pilot,
        runs=min(method_of_scenario.runs for method_of_scenario in methods.values()),
    )


def method(text: str, scenarios: Sequence[str] = CHALLENGES) -> Method:
    """Return the method to be scored.

    Args:
        text: A baseline's name, the path of an .onnx or .npz file, or `module:name` of a Python
            callable. If it contains `{scenario}`, there is one policy per scenario.
        scenarios: Scenarios in which it is to be scored.

    Raises:
        ValueError: If there is no such policy.
        ImportError: If it needs a package that is not installed, as `NotInstalled`.
    """
    if SCENARIO in text:
        return _one_per_scenario(text, scenarios)
    file = Path(text)
    if file.suffix in (".onnx", ".npz"):
        if not file.is_file():
            raise BadArgument("policy", f"must be an existing file, got {text}")
    if file.suffix == ".onnx":
        return _onnx(file)
    if file.suffix == ".npz":
        return _weights(file)
    if ":" in text:
        return _import_policy(text)
    return _baseline(check_choice("policy", text, tuple(NUMBERS)), scenarios)
