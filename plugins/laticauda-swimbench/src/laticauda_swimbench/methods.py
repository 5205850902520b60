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

    usual_of_action = {
        action.name: getattr(controller.gait, action.name) for action in episodes.task.actions
    }

    def act(observed: np.ndarray) -> np.ndarray:
        decisions = steering.step(_seen_by_controllers(episodes))
        asked = np.empty((episodes.n, len(usual_of_action)))
        for column, (name, usual) in enumerate(usual_of_action.items()):
            if name == "offset":
                asked[:, column] = usual + decisions.get("offset", 0.0)
            else:
                asked[:, column] = decisions.get(name, usual)
        return (asked - episodes.middle) / episodes.half

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
    given = dict(numbers)
    shape = {
        name: given.pop(name) for name in ("amplitude", "frequency", "phase_shift") if name in given
    }
    guidance = "integral_line_of_sight" if "integral_gain" in given else "line_of_sight"
    following: Any = {"guidance": guidance, "interval": interval, **given}
    return lc.Following(**following).controller(replace(gait, **shape))


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
    model, low, high = AveragedModel(**numbers["model"]), *numbers["frequency_limits"]

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
    said = dict(NUMBERS[name])
    kind, title, note = (said.pop(one, "") for one in ("kind", "title", "note"))
    content = repr(sorted(said.items())).encode()
    if kind == "network":
        return replace(
            _each(str(HERE / "policies" / f"{name}-{SCENARIO}.npz"), scenarios),
            name=title,
            note=note,
        )
    made: dict[str, Pilot] = {"open loop": _open_loop, "searched law": reference_law}
    pilot = made.get(kind) or (law_pilot(said) if kind == "law" else _plan(said))
    return Method(name=title, kind=kind, note=note, sha256=_digest(content), pilot=pilot)


# ---- from outside --------------------------------------------------------------------------------


def _called(text: str) -> Method:
    """`module:name`: a function of an observation, a class of such callables, a controller, or its class."""
    place, _, name = text.partition(":")
    sys.path.insert(0, "")  # a module in the working directory
    try:
        module = import_module(place)
    except ImportError as error:
        raise BadArgument(
            "policy", f"must name a module that can be imported, got {text}: {error}"
        ) from error
    finally:
        sys.path.remove("")
    found: Any = getattr(module, name, None)
    is_class, is_controller = inspect.isclass(found), isinstance(found, lc.Controller)
    if not (callable(found) or is_controller):
        raise BadArgument("policy", f"must name a function, a class or a controller, got {text}")
    file = inspect.getsourcefile(module)
    content = Path(file).read_bytes() if file else text.encode()

    made: Any = found

    def pilot(challenge: Challenge, run: int, episodes: Episodes) -> Act:
        each: list[Any] = [made() if is_class else made for _ in range(episodes.n)]
        if isinstance(each[0], lc.Controller):
            return _piloted(cast("lc.Controller[Any]", each[0]), episodes)
        return lambda observed: np.array(
            [one(row) for one, row in zip(each, observed, strict=True)], dtype=float
        )

    return Method(name=text, kind="callable", sha256=_digest(content), pilot=pilot)


def _onnx(file: Path) -> Method:
    """A network in an ONNX file: it takes rows of observations in float32, and its first output is the actions."""
    runtime = needed("A policy in an ONNX file", "onnxruntime")
    how = runtime.SessionOptions()
    how.intra_op_num_threads = how.inter_op_num_threads = 1  # the same sums in the same order
    session = runtime.InferenceSession(str(file), how, providers=["CPUExecutionProvider"])
    given = session.get_inputs()[0].name

    def act(observed: np.ndarray) -> np.ndarray:
        rows = observed.astype(np.float32)
        return np.concatenate(
            [session.run(None, {given: row[np.newaxis]})[0] for row in rows]
        ).astype(float)

    return Method(
        name=file.stem,
        kind="ONNX",
        sha256=_digest(file.read_bytes()),
        pilot=lambda challenge, run, episodes: act,
    )


def _weights(file: Path) -> Method:
    found = networks.load(file)
    return Method(
        name=file.stem,
        kind="network",
        sha256=_digest(file.read_bytes()),
        pilot=lambda challenge, run, episodes: found[run],
        runs=len(found),
    )


def _each(text: str, scenarios: Sequence[str]) -> Method:
    """One policy per scenario: the scenario's name replaces `{scenario}`."""
    parts = {name: method(text.replace(SCENARIO, name)) for name in scenarios}
    first = parts[scenarios[0]]
    return Method(
        name=Path(text).stem,
        kind=first.kind,
        sha256=_digest("".join(one.sha256 for one in parts.values()).encode()),
        pilot=lambda challenge, run, episodes: parts[challenge.name].pilot(
            challenge, run, episodes
        ),
        runs=min(one.runs for one in parts.values()),
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
        return _each(text, scenarios)
    file = Path(text)
    if file.suffix in (".onnx", ".npz"):
        if not file.is_file():
            raise BadArgument("policy", f"must be an existing file, got {text}")
        return _onnx(file) if file.suffix == ".onnx" else _weights(file)
    if ":" in text:
        return _called(text)
    return _baseline(check_choice("policy", text, tuple(NUMBERS)), scenarios)
