"""Runs as values: a scenario is everything that determines a run; an experiment is what is known of any other run."""

import math
from collections.abc import Mapping, Sequence
from typing import Any, Literal, TypeAlias, cast

import numpy as np

from laticauda.motion.gaits import Gait
from laticauda.motion.joints import JointLaw, Prescribed, usual_law
from laticauda.robot import Environment, Robot, Scene
from laticauda.scenarios.interfaces import (
    Command,
    Controller,
    OpenLoop,
    Resumed,
    Start,
    check_interval,
)
from laticauda.sensing import Place, Sensor
from laticauda.values import (
    BadArgument,
    Unknown,
    check_instance,
    name_of,
    option,
    quantity,
    value_class,
)

MOST_NAMED = 100
"""Sensors, and places, at most."""
NO_FILTER = 1e6
"""Bandwidth of a reference generator whose filters pass everything at once [rad/s]."""


def check_names(argument: str, named: Sequence[Sensor] | Sequence[Place]) -> None:
    """Reject sensors or places of the same name.

    Args:
        argument: Name of the argument.
        named: They.

    Raises:
        ValueError: If two of them have the same name, or there are very many.
    """
    if len(named) > MOST_NAMED:
        raise BadArgument(argument, f"must be at most {MOST_NAMED}, got {len(named)} of them")
    # A stand-in for a kind that is not defined here has no name.
    names = [part.name for part in named if not isinstance(part, Unknown)]
    for name in names:
        if names.count(name) > 1:
            raise BadArgument(argument, f"must have different names, got `{name}` twice")


def _check_names_in_log(sensors: Sequence[Sensor]) -> None:
    """Reject names of sensors with which those of their columns in the log could not begin."""
    for index, sensor in enumerate(sensors):
        if not isinstance(sensor, Unknown) and not sensor.name.isidentifier():
            rule = "must consist of letters, digits and underscores, and begin with no digit"
            raise BadArgument(f"sensors[{index}].name", f"{rule}, got {sensor.name!r}")


@value_class
class _Model:
    """Common fields of both models."""

    joints: JointLaw = option(
        "How the joints follow their references", default=usual_law(Prescribed)
    )
    dt: float | None = quantity(
        "s", "Largest time step; a converged one if omitted", default=None, ge=1e-7, le=1e3
    )
    offset_bandwidth: float = quantity(
        "1/s", "Bandwidth of the gait's filters; 1e6: none", default=10.0, gt=0.0, le=NO_FILTER
    )
    loop_delay: float = quantity(
        "s",
        "Delay from a controller's observation to its command at the joints",
        default=0.0,
        ge=0.0,
    )
    ramp: float | None = quantity(
        "s", "Smooth start; if omitted, 1 s if prescribed, else 0", default=None, ge=0.0
    )
    sensors: tuple[Sensor, ...] = option(
        "What the robot measures, for controllers and logs", default=()
    )
    places: tuple[Place, ...] = option(
        "What is in the water: nets, pipelines, walls, docks, buoys", default=()
    )

    @property
    def names_of_readings(self) -> tuple[str, ...]:
        """Names of all values that the sensors measure, as logs have them."""
        names: list[str] = []
        for sensor in self.sensors:
            names += [f"{sensor.name}_{column}" for column in sensor.columns]
        return tuple(names)

    def __post_init__(self) -> None:
        """Reject references that jump unless the joints can follow jumps, and things of the same name."""
        check_names("sensors", self.sensors)
        _check_names_in_log(self.sensors)
        check_names("places", self.places)
        may_take_jumps = self.joints.takes_jumps or isinstance(self.joints, Unknown)
        if self.offset_bandwidth == NO_FILTER and not may_take_jumps:
            condition = "unless the joint law takes references that jump, as `servo` does"
            rule = f"must be < {NO_FILTER:g} 1/s, {condition}"
            raise BadArgument("offset_bandwidth", f"{rule}, got {self.offset_bandwidth:g}")


@value_class
class Planar(_Model):
    """The closed-form model in the plane; a robot's pitch joints are held straight.

    Raises:
        ValueError: If a field is out of its range.
    """


def _check_scene(_: str, scene: Any) -> Any:
    """Return the scene that a name, a path or a function stands for."""
    return Scene.of(scene)


@value_class
class Spatial(_Model):
    """MuJoCo in space, with laticauda's hydrodynamic loads; it needs the extra `spatial`.

    A planar root has fixed height and tilt. Without some ballast, nothing keeps a robot with a free
    root upright; Mamba's ballast is not known, and the default is an assumption. A scene may be a
    `Scene`, its name, an MJCF file, or a function that edits a `mujoco.MjSpec`.

    Raises:
        ValueError: If a field is out of its range.
    """

    root: Literal["free", "planar"] | None = option(
        "Tail module's joint; None: planar if all joints yaw", default=None
    )
    gravity: bool = option(
        "Whether there is weight and buoyancy; they do nothing to a planar root", default=True
    )
    ballast_depth: float = quantity(
        "m",
        "How far the modules' centers of mass lie below their axes, which keeps a free robot upright; an assumption",
        default=0.005,
    )
    scene: Scene | None = option(
        "What is around the robot: a scene, its name, an MJCF file, or a function that edits a `mujoco.MjSpec`; open "
        "water or flat ground if omitted",
        default=None,
        check=_check_scene,
    )

    rays: tuple[float, ...] = quantity(
        "rad", "Directions of the head's range sensors, positive left", default=()
    )

    @property
    def surroundings(self) -> Scene | None:
        """The scene; open water if there are only places; None if there is nothing that the robot can touch."""
        if self.scene is None and self.places:
            return Scene()
        return self.scene


Model: TypeAlias = Planar | Spatial
MODELS: dict[str, type[Planar] | type[Spatial]] = {"planar": Planar, "spatial": Spatial}
"""The models by their names in texts."""


def loop_in_words(settings: Mapping[str, Any]) -> str:
    """Describe what lies between a controller and the joints: bandwidth and delay.

    Args:
        settings: Settings with `offset_bandwidth`, and `loop_delay` unless they come from an older
            version.
    """
    bandwidth = settings["offset_bandwidth"]
    delay = f"delay {settings.get('loop_delay', 0.0):g} s"
    if bandwidth >= NO_FILTER:
        return f"no filter, {delay}"
    return f"bandwidth {bandwidth:g} rad/s, {delay}"


def settings_of(model: Model) -> dict[str, str | float | bool | None]:
    """Return the settings of a model as texts and numbers, for people.

    Args:
        model: The model.
    """
    settings: dict[str, Any] = {"model": name_of(type(model))}
    for name, value in vars(model).items():
        if name in ("sensors", "places"):
            if value:
                settings[name] = ", ".join(part.name for part in value)
            continue
        settings[name] = value
        if isinstance(value, JointLaw | Scene):
            settings[name] = name_of(type(value))
    return settings


LONGEST_SUMMARY = 180
"""Characters of a summary at most, so that it fits on two lines."""


def _describe_gait(gait: Gait) -> str:
    """Return a gait in a few words: its kind, amplitude, frequency and phase shift."""
    amplitude = math.degrees(gait.amplitude)
    frequency = math.degrees(gait.frequency)
    phase_shift = math.degrees(gait.phase_shift)
    return f"{gait.words} {amplitude:.4g} deg, {frequency:.4g} deg/s, {phase_shift:.4g} deg"


@value_class
class Scenario:
    """Everything that determines a run: the same scenario always gives the same trial (`laticauda.swim`).

    Use `dataclasses.replace` to make a modified copy; unchanged parts remain the same objects. The
    sample interval is adjusted so that it divides the time between two control instants, and the
    duration.

    Raises:
        ValueError: If a field is out of its range.
    """

    robot: Robot = option("What swims")
    motion: Gait | Controller[Any] = option(
        "Motion of the joints: a gait, or a controller that steers one"
    )
    environment: Environment = option("The water it swims in or the ground it crawls on")
    model: Model = option("The model that computes the run", default=Planar())
    start: Start | Resumed = option(
        "Start of the run: straight, or where another run ended", default=Start()
    )
    duration: float = quantity("s", "Duration of the run", default=30.0, gt=0.0, le=1e6)
    sample_interval: float = quantity(
        "s",
        "Time between two samples of the log; adjusted so that it divides the control interval and the duration",
        default=0.05,
        gt=0.0,
    )

    def __post_init__(self) -> None:
        """Check what the types do not express."""
        check_instance("motion", self.motion, Gait, Controller)
        if isinstance(self.motion, Controller) and not isinstance(self.motion, Unknown):
            check_interval(self.motion)
        if isinstance(self.model, Spatial) and self.model.scene is not None:
            self.model.scene.check(self.environment)

    @property
    def words(self) -> str:
        """One-line summary: what swims, how, where, and by which model."""
        motion = _describe_gait(self.gait)
        if not isinstance(self.motion, Gait):
            motion = f"{name_of(self.motion.__class__)} of {motion}"
        model_class = type(self.model)
        law_class = type(self.model.joints)
        model_name = name_of(model_class)
        law_name = name_of(law_class)
        model = f"{model_name} model, {law_name} joints"
        summary = (
            f"{self.robot.name}: {motion}, {self.duration:g} s in {self.environment.name}, {model}"
        )
        if len(summary) <= LONGEST_SUMMARY:
            return summary
        return f"{summary[: LONGEST_SUMMARY - 3]}..."

    def __repr__(self) -> str:
        """Return `words` instead of the many fields."""
        return f"<Scenario of {self.words}>"

    @property
    def gait(self) -> Gait:
        """The gait, or the initial gait of the controller."""
        if isinstance(self.motion, Gait):
            return self.motion
        return self.motion.gait

    @property
    def controller(self) -> Controller[Any]:
        """The controller; for a gait, a controller that holds it."""
        if isinstance(self.motion, Gait):
            return OpenLoop(command=Command(gait=self.motion))
        return self.motion

    @property
    def settings(self) -> Mapping[str, str | float | bool | None]:
        """Settings of the controller and the model as texts and numbers, for people."""
        settings: dict[str, Any] = {}
        if not isinstance(self.motion, Gait):
            settings = _settings_of_controller(self.motion)
        settings |= settings_of(self.model)
        recorded = self.gait.recorded
        if recorded is not None and recorded.reading:
            settings["reading"] = recorded.reading
        return settings


def _settings_of_controller(controller: Controller[Any]) -> dict[str, Any]:
    """Return a controller's name and fields, all but its gait, as texts and numbers."""
    settings: dict[str, Any] = {"controller": name_of(controller.__class__)}
    for name in getattr(controller, "__dataclass_fields__", ()):
        if name == "gait":
            continue
        value: Any = getattr(controller, name)
        if not isinstance(value, str | float | int):
            value = repr(value)
        settings[name] = value
    return settings


@value_class
class Experiment:
    """A run that cannot be repeated: of a real robot, of the tank, or of a page on which something was changed.

    Raises:
        ValueError: If a note is neither text nor number.
    """

    robot: Robot = option("What swam")
    gait: Gait | None = option("Commanded gait; None if there was none", default=None)
    environment: Environment = option("The water it swam in or the ground it crawled on")
    model: Model | None = option("Model by which it was simulated; None: it was not", default=None)
    notes: Mapping[str, Any] = option(
        "What else is known about it: texts and numbers", default_factory=dict[str, Any]
    )

    def __post_init__(self) -> None:
        """Check what the types do not express."""
        check_instance("notes", self.notes, Mapping)
        notes = {name: _plain(name, note) for name, note in self.notes.items() if note is not None}
        object.__setattr__(self, "notes", notes)

    @property
    def settings(self) -> Mapping[str, str | float | bool | None]:
        """The model and the notes as texts and numbers, for people."""
        if self.model is None:
            return self.notes
        return {**settings_of(self.model), **self.notes}

    @property
    def lacks(self) -> str:
        """What a scenario has and this experiment lacks, in words."""
        if self.model is None:
            return "what decided its commands, where it began and a model"
        return "what decided its commands and where it began"


def _plain(name: str, note: Any) -> str | float:
    """Return a note as plain data that a file can hold."""
    plain = cast(object, note.item() if isinstance(note, np.generic) else note)
    if isinstance(plain, float) and math.isnan(plain):
        raise BadArgument(f"notes[{name!r}]", "must not be nan")
    if not isinstance(plain, str | float | int):
        raise BadArgument(
            f"notes[{name!r}]", f"must be a text, number or truth value, got {type(plain).__name__}"
        )
    return plain
