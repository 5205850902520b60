"""Content of a recording: entries, kept bit for bit as messages (except events), and the header of the operation.

Only classes that come with the package, or that this process knows, are ever constructed from a
file.
"""

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass, field, is_dataclass, replace
from typing import Any, TypeAlias, cast, get_args

import numpy as np
from jaxtyping import Float

from laticauda import robot
from laticauda.control import estimation
from laticauda.control.estimation import Estimate, JointSample, Learned, PoseSample, ReferenceSample
from laticauda.control.estimation.samples import Status
from laticauda.models.dynamics.plant import Plant
from laticauda.scenarios import Experiment, interfaces, run_from_toml, run_to_toml
from laticauda.trials.logs import ros2
from laticauda.values import codec, packaging
from laticauda.values.checks import check_instance
from laticauda.values.errors import BadArgument
from laticauda.values.quantities import hints_of, option, quantity, value_class
from laticauda.water.fluid.laws import FunctionDrag


@value_class
class PowerReading:
    """Reading of the power meter in the supply cable."""

    time: float = quantity("s", "When it was read")
    current: float = quantity("A", "Present current")
    average: float | None = quantity(
        "A", "Since the meter was reset; None if it was not queried", default=None
    )
    minimum: float | None = quantity("A", "Since the meter was reset", default=None)
    maximum: float | None = quantity("A", "Since the meter was reset", default=None)
    since: float | None = quantity(
        "s", "When the meter was reset; None if that is not known", default=None
    )


@dataclass(frozen=True, kw_only=True)
class Event:
    """Something that happened, or a state that was entered."""

    time: float
    """Time of the event [s]."""
    kind: str
    """Kind of event: `state`, `fault`, `rejected`, `operator` and so on."""
    message: str
    """Description in one sentence."""
    data: Mapping[str, Any] = field(default_factory=dict[str, Any])
    """Further data: texts and numbers by name."""


@dataclass(frozen=True, kw_only=True)
class Decision:
    """What a controller decided at one control instant."""

    time: float
    """Time of the estimate on which the decision is based [s]."""
    command: interfaces.Command
    """Command that it decided on."""
    signals: Mapping[str, float]
    """Signals of the controller, by name."""


Measurement: TypeAlias = PoseSample | JointSample | ReferenceSample | PowerReading
"""What was received from the devices, and the references that were sent."""


Times: TypeAlias = Float[np.ndarray, " n_ticks"]
SPREAD = {"median": 50.0, "p99": 99.0, "p99_9": 99.9, "largest": 100.0}


@dataclass(frozen=True)
class Tick:
    """One tick of the loop."""

    due: float
    """Time at which it was due [s]."""
    began: float
    """Time at which it began [s]."""
    sent: float
    """Time at which its last frame had been handed to the bus [s]."""

    @property
    def time(self) -> float:
        """Time at which it began [s]."""
        return self.began


Entry: TypeAlias = Measurement | Estimate | Decision | Event | Tick | Learned
"""What is recorded of an operation, besides the raw frames of the bus."""


@dataclass(frozen=True, kw_only=True)
class Timing:
    """Punctuality of the ticks of one operation."""

    times: Float[np.ndarray, "n_ticks 3"]
    """For each tick, when it was due, when it began, and when its last frame had been handed to the bus [s]."""
    interval: float
    """Nominal time between two ticks [s]."""

    @property
    def period(self) -> Times:
        """Time from the beginning of a tick to that of the next [s]."""
        return np.diff(self.times[:, 1])

    @property
    def lateness(self) -> Times:
        """Time from when a tick was due until it began [s]."""
        return self.times[:, 1] - self.times[:, 0]

    @property
    def latency(self) -> Times:
        """Time from when a tick was due until its last frame was sent [s]."""
        return self.times[:, 2] - self.times[:, 0]

    @property
    def missed(self) -> int:
        """Number of ticks that were not finished when the next was due [-]."""
        return int(np.count_nonzero(self.latency > self.interval))

    def summary(self) -> dict[str, float | int]:
        """Return median, percentiles and maximum of period, lateness and latency, the ticks and missed deadlines."""
        found: dict[str, float | int] = {
            "ticks": len(self.times),
            "interval": self.interval,
            "missed": self.missed,
        }
        for name in ("period", "lateness", "latency"):
            values: Times = getattr(self, name)
            if values.size:
                found |= {
                    f"{name}_{of}": float(np.percentile(values, share))
                    for of, share in SPREAD.items()
                }
        return found


def punctuality(timing: Mapping[str, float | int]) -> str:
    """Return the summary of a `Timing` as a sentence.

    Args:
        timing: `Timing.summary`, or the `timing` of a result in JSON.
    """
    ms = {name: f"{1e3 * value:.2f}" for name, value in timing.items()}
    text = f"{timing['ticks']} ticks of {ms['interval']} ms, {timing['missed']} missed"
    if "lateness_median" not in ms:
        return text
    late, sent = (
        [ms[f"{name}_{of}"] for of in ("median", "p99_9", "largest")]
        for name in ("lateness", "latency")
    )
    spread = "{} ms (median), {} (99.9 %), {} at most"
    return f"{text}; late by {spread.format(*late)}; all sent after {spread.format(*sent)}"


TOPICS: Mapping[str, type[Any]] = {
    "/sample/pose": PoseSample,
    "/sample/joints": JointSample,
    "/sample/references": ReferenceSample,
    "/sample/power": PowerReading,
    "/estimate": Estimate,
    "/command": Decision,
    "/loop/tick": Tick,
    "/learned": Learned,
}
"""Topics of the entries that are messages of their own type, with the fields of their class."""
TOPIC_OF = {kind: topic for topic, kind in TOPICS.items()}
_JSON = dict.fromkeys((interfaces.Command, Mapping[str, float], tuple[str, ...]), "string")
_PLAIN = {float: "float64", float | None: "float64", Status: "string", **_JSON}
"""ROS types of fields by their Python types; all others are arrays."""


def ros_type_of(kind: type[Any]) -> str:
    """Return the ROS type of the entries of a class."""
    return f"laticauda_msgs/{kind.__name__}"


def _definition(kind: type[Any]) -> str:
    return "".join(
        f"{_PLAIN.get(hint, 'float64[]')} {name}\n" for name, hint in hints_of(kind).items()
    )


ros2.DEFINITIONS.update({ros_type_of(kind): _definition(kind) for kind in TOPIC_OF})


def content_of(entry: Any) -> list[Any]:
    """Return the content of an entry's message, bit for bit; None becomes nan for a number, and empty for an array."""
    content, kind = list[Any](), cast("type[Any]", type(entry))
    for name, hint in hints_of(kind).items():
        value = getattr(entry, name)
        if value is None:
            content.append(math.nan if hint in _PLAIN else ())
        elif hint in _JSON:
            content.append(json.dumps(codec.encode(value)))
        else:
            content.append(value if hint in _PLAIN else value.ravel())
    return content


def entry_of(topic: str, content: Mapping[str, Any]) -> Any:
    """Return the entry in a message.

    Args:
        topic: Topic of the message.
        content: Content of the message, by field.

    Raises:
        KeyError: If a field is missing.
        BadKey: If a text in it is invalid.
        ValueError: If it is not a valid entry.
    """
    values: dict[str, Any] = {}
    for name, hint in hints_of(TOPICS[topic]).items():
        value = content[name]
        if hint in _JSON:
            value = codec.decode(hint, json.loads(value), name)
        elif hint not in _PLAIN:
            value = np.array(value, dtype=np.float64).reshape(
                (3, 3) if name == "rotation" and len(value) else -1
            )
        is_nothing = value.size == 0 if isinstance(value, np.ndarray) else value != value
        values[name] = None if is_nothing and type(None) in get_args(hint) else value
    return TOPICS[topic](**values)


# ---- the whole operation -------------------------------------------------------------------------


HEADER = "operation"
FORMAT = "4"
"""Format that is read and written."""
Estimators: TypeAlias = estimation.Estimator | estimation.KinematicEstimator


@value_class
class Header:
    """Header of a recording, about the whole operation."""

    run: Experiment = option(
        "robot, water and gait, if known; density and current are used for figures"
    )
    controller: interfaces.Controller[Any] | None = option(
        "the controller, for a replay", default=None
    )
    estimator: Estimators | None = option(
        "state estimator, for a replay; its plant is kept as `twin`", default=None
    )
    twin: Experiment | None = option(
        "how the estimator's digital twin was built; None: without one", default=None
    )
    supply_voltage: float | None = quantity(
        "V", "V of (4); None without a power meter", gt=0.0, default=None
    )
    learning: estimation.Learning | None = option(
        "what a digital twin learned; None: nothing", default=None
    )
    operation: str = option("the trial file as it was read", default="")

    def __post_init__(self) -> None:
        """Reject what cannot be written, and replace a plant with how it was made."""
        check_instance("controller", self.controller, interfaces.Controller, type(None))
        if not (self.controller is None or is_dataclass(self.controller)):
            raise BadArgument(
                "controller", f"must be a dataclass, got {type(self.controller).__name__}"
            )
        if isinstance(self.estimator, estimation.Estimator) and self.estimator.plant is not None:
            object.__setattr__(self, "twin", _record_of(self.estimator.plant))
            object.__setattr__(self, "estimator", replace(self.estimator, plant=None))

    def texts(self) -> dict[str, str]:
        """Return the header as texts by name: runs as TOML, texts unchanged, everything else as JSON."""
        own = {name: _text(getattr(self, name), hint) for name, hint in hints_of(Header).items()}
        return {"format": FORMAT, "version": packaging.__version__, **own}


def header_from_texts(texts: Mapping[str, str]) -> Header:
    """Return the header that `Header.texts` converted, equal to the original. Older texts have no `learning`.

    Args:
        texts: Texts in the format `FORMAT`.

    Raises:
        KeyError: If a text is missing.
        BadKey: If a text is invalid.
        ValueError: If a text is invalid.
    """
    texts = {"learning": "null", **texts}
    return Header(
        **{name: _value(name, texts[name], hint) for name, hint in hints_of(Header).items()}
    )


def _text(value: Any, hint: Any) -> str:
    if isinstance(value, Experiment):
        return run_to_toml(value)
    return value if isinstance(value, str) else json.dumps(codec.encode(value, hint))


def _value(name: str, text: str, hint: Any) -> Any:
    if hint is str:
        return text
    is_run = Experiment in (hint, *get_args(hint)) and text != "null"
    return run_from_toml(text) if is_run else codec.decode(hint, json.loads(text), name)


def _record_of(plant: Plant[Any]) -> Experiment:
    """Return how a plant was made, in the form that a recording keeps."""
    if (
        isinstance(robot.law_of(plant.environment), FunctionDrag)
        or getattr(plant.settings, "scene", None) is not None
    ):
        raise BadArgument(
            "plant", "must have a fluid law that is a class, and no scene, to be recorded"
        )
    return Experiment(robot=plant.robot, environment=plant.environment, model=plant.settings)
