"""`laticauda inverse`: from points tracked in a film to forces, power and efficiency with intervals."""

import math
from pathlib import Path
from typing import Any

import numpy as np

import laticauda as lc
from laticauda.cli import flags
from laticauda.cli.command import Command, Outcome
from laticauda.cli.film import FILM_ENDINGS
from laticauda.cli.progress import PATIENCE, SHARE, show_progress
from laticauda.cli.shared_options import threads_option
from laticauda.cli.tables import align_columns, format_digits
from laticauda.film import TrackedPoints, read_points
from laticauda.film.calibration import load_calibration, points_on_plane
from laticauda.film.chain import build_eel, build_fish
from laticauda.film.forces import (
    Estimate,
    FilmForces,
    draw_forces,
    invert_points,
    list_doubts,
    list_remarks,
    points_of_trial,
    scale_points,
    summarize,
    write_page,
)
from laticauda.robot import robot_names
from laticauda.scenarios import environment_of
from laticauda.show.figures import save_figure
from laticauda.trials import Format
from laticauda.values import BadArgument, option, quantity, suggest_nearest, to_plain, value_class

ANIMALS = {"eel": build_eel, "fish": build_fish}
"""Bodies that need only a length."""
EQUAL_LENGTHS = 0.01
"""Relative difference of two lengths that count as equal [-]."""
DIGITS = 3
"""Significant digits of the figures."""


@value_class
class Inverse(Command):
    """Find speed, forces, power and efficiency of a filmed swim, each with a 95 % interval.

    A chain of links is fitted to all frames at once; the smoothness is found from the film. Then many draws
    of motion, body and water are evaluated.

    For example: laticauda inverse eelDLC.csv --robot eel --length 0.4 --frame-rate 60 --pixels-per-meter 950
    """

    file: flags.FileArgument = option(
        "Points that a tracker found, or a trial with measured joint angles and path"
    )
    robot: str = option("What swims: a preset, a file, or eel or fish, which need --length")
    length: float | None = quantity("m", "Length of an eel or fish", gt=0.0, default=None)
    mass: float | None = quantity("kg", "Its mass; if omitted, it floats", gt=0.0, default=None)
    along: tuple[float, ...] | None = quantity(
        "m",
        "Distance of every point from the tail end; if omitted, points go from nose to tail tip",
        default=None,
    )
    frame_rate: float | None = quantity(
        "1/s", "Frames per second, unless the file states it", gt=0.0, default=None
    )
    individual: str | None = option("Whose points, if the file has several", default=None)
    pixels_per_meter: float | None = quantity(
        "1/m", "Scale of a film from straight above", gt=0.0, default=None
    )
    calibration: str | None = option("File of the camera's calibration", default=None)
    scale_deviation: float = quantity(
        "", "Relative standard deviation of the scale", ge=0.0, le=1.0, default=0.0
    )
    water: str | None = option(
        "Water that is known, a preset or a file; if omitted, from tables, with their intervals",
        default=None,
    )
    body_deviation: float = quantity(
        "",
        "Relative standard deviation of the body's height and width",
        ge=0.0,
        le=1.0,
        default=0.0,
    )
    span: tuple[float, float] | None = quantity(
        "s", "Begin and end of the part that counts; if omitted, all whole cycles", default=None
    )
    draws: int = quantity("", "Draws of motion, body and water", ge=40, default=200)
    seed: int = quantity("", "Seed of the draws", ge=0, default=0)
    threads: int | None = threads_option()
    plot: flags.PictureOutput = option("Draw forces along the body over a cycle", default=None)
    output: flags.OptionalFolder = option(
        "Write a page with tables and figure to this folder", default=None
    )

    def run(self) -> Outcome:
        """Read, fit, evaluate, and report."""
        robot = self._load_robot()
        points = self._load_points()
        water = None
        if self.water is not None:
            water = environment_of(self.water, robot)
        forces = invert_points(
            points,
            robot,
            self._choose_places(),
            water=water,
            span=self.span,
            body_deviation=self.body_deviation,
            scale_deviation=self._choose_scale_deviation(),
            n_draws=self.draws,
            seed=self.seed,
            threads=self.threads,
            on_progress=show_progress(SHARE, what="evaluated", patience=PATIENCE),
        )
        files: list[str] = []
        if self.plot is not None:
            save_figure(draw_forces(forces), self.plot)
            files.append(self.plot)
        if self.output is not None:
            files += [f"{self.output}/{name}" for name in write_page(forces, self.output)]
        return Outcome(facts=self._list_facts(forces, files), text=_describe(forces, files))

    def _load_robot(self) -> lc.Robot:
        build = ANIMALS.get(self.robot)
        if build is None:
            robot = self._load_named()
            if self.length is not None or self.mass is not None:
                rule = "must be left out unless `robot` is eel or fish"
                raise BadArgument("length", f"{rule}: `{self.robot}` has its own")
            return robot
        if self.length is None:
            raise BadArgument("length", f"must be given for a body of the kind {self.robot}")
        return build(self.length, mass=self.mass)

    def _load_named(self) -> lc.Robot:
        """Return a preset or the robot of a file; a message about a wrong name lists the bodies, too."""
        names = (*ANIMALS, *robot_names())
        if self.robot not in names and not self.robot.endswith(".toml"):
            listed = ", ".join(f"`{name}`" for name in names)
            hint = suggest_nearest(self.robot, names)
            rule = f"must be one of {listed}, or a file *.toml, got {self.robot!r}{hint}"
            raise BadArgument("robot", rule)
        return lc.load_robot(self.robot)

    def _load_points(self) -> TrackedPoints:
        if self._is_trial:
            trial = lc.load_trial(self.file)
            self._check_body(trial)
            return points_of_trial(trial)
        if Path(self.file).suffix.lower() in FILM_ENDINGS:
            raise BadArgument(
                "file",
                "must be points of a tracker, or a trial, not the film itself: "
                "`laticauda track` finds tags in a film, and makes a trial with --save",
            )
        points = read_points(self.file, frame_rate=self.frame_rate, individual=self.individual)
        if self.calibration is not None:
            return points_on_plane(points, load_calibration(self.calibration))
        if self.pixels_per_meter is not None:
            return scale_points(points, self.pixels_per_meter)
        if points.unit == "px":
            rule = "must be given for points in px, or a --calibration"
            raise BadArgument("pixels_per_meter", rule)
        return points

    def _check_body(self, trial: lc.Trial) -> None:
        """Reject a body that is not that of the trial: its joints would sit elsewhere."""
        chain = self._load_robot().planar()
        measured = trial.chain
        is_same_length = math.isclose(chain.length, measured.length, rel_tol=EQUAL_LENGTHS)
        if chain.n_links == measured.n_links and is_same_length:
            return
        rule = f"must be as long as what swam in the trial, `{measured.name}`"
        theirs = f"{measured.n_links} links, {measured.length:.4g} m"
        ours = f"{chain.n_links} links, {chain.length:.4g} m"
        raise BadArgument("robot", f"{rule}: {theirs}, got {ours}")

    @property
    def _is_trial(self) -> bool:
        """Whether the file is a trial: of a format that keeps all of one."""
        endings = tuple(ending for ending in Format.endings() if ending != ".csv")
        return self.file.endswith(endings)

    def _choose_places(self) -> np.ndarray | None:
        if self.along is not None:
            return np.array(self.along)
        if self._is_trial:
            lengths = [module.length for module in self._load_robot().planar().modules]
            return np.append(0.0, np.cumsum(lengths))
        return None

    def _choose_scale_deviation(self) -> float:
        if self.calibration is None or self.scale_deviation > 0.0:
            return self.scale_deviation
        return load_calibration(self.calibration).scale_deviation

    def _list_facts(self, forces: FilmForces, files: list[str]) -> dict[str, Any]:
        fit = forces.fit
        return {
            "file": self.file,
            "robot": fit.robot.name,
            "frequency": fit.frequency,
            "cycles": forces.window.n_cycles,
            "span": [forces.window.begin, forces.window.end],
            "figures": {name: _facts_of(figure) for name, figure in forces.figures.items()},
            "links": [_facts_of(figure) for figure in forces.link_figures],
            "explains": forces.explains,
            "noise": to_plain(fit.noise.tolist()),
            "outliers": fit.n_outliers,
            "effective_freedoms": fit.freedoms,
            "log_evidence": fit.log_evidence,
            "doubts": list_doubts(forces),
            "remarks": [*forces.fit.points.notes, *list_remarks(forces)],
            "files": files,
        }


def _facts_of(figure: Estimate) -> dict[str, Any]:
    return {
        "median": figure.median,
        "interval": [figure.low, figure.high],
        "unit": figure.unit,
        "shares": dict(figure.shares),
    }


def _describe(forces: FilmForces, files: list[str]) -> str:
    rows = [["", "median", "95 % interval", "", "film", "water", "body"]]
    rows += [_row_of(figure) for figure in forces.figures.values()]
    links = [_row_of(figure) for figure in forces.link_figures]
    links[0][0] += ", the tail"
    parts = [summarize(forces)]
    doubts = list_doubts(forces)
    if doubts:
        parts.append("\n".join(f"Doubt: {doubt}" for doubt in doubts))
    parts.append(align_columns([*rows, *links], right=(1, 4, 5, 6)))
    parts.append("\n".join([*forces.fit.points.notes, *list_remarks(forces)]))
    if files:
        parts.append(f"Written: {', '.join(files)}")
    return "\n\n".join(parts)


def _row_of(figure: Estimate) -> list[str]:
    interval = f"{format_digits(figure.low, DIGITS)} to {format_digits(figure.high, DIGITS)}"
    shares = [f"{100.0 * share:.0f} %" for share in figure.shares.values()]
    return [figure.title, format_digits(figure.median, DIGITS), interval, figure.unit, *shares]
