"""`laticauda tags`, `laticauda lens`, `laticauda track`: from a film to a trial."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any, Literal

import laticauda as lc
from laticauda.cli import report
from laticauda.cli.command import Command, Outcome
from laticauda.cli.flags import (
    BadFlag,
    File,
    FileArgument,
    OutputFile,
    PictureOutput,
    RequiredFile,
    TomlOutput,
    TrialOutput,
    Words,
)
from laticauda.cli.output_files import check_output
from laticauda.cli.progress import PATIENCE, SHARE, show_progress
from laticauda.film import read_points
from laticauda.film.calibration import (
    Calibration,
    CameraCalibration,
    Checkerboard,
    Marks,
    RulerCalibration,
    Surface,
    calibrate_by_ruler,
    calibrate_camera,
    calibrate_lens,
    describe_certainty,
    load_calibration,
    load_lens,
    marks_of_board,
    pictures_of_film,
    save_calibration,
)
from laticauda.film.chain import places_at
from laticauda.film.tags import (
    describe_placing,
    find_tags,
    load_layout,
    marks_of_floor,
    propose_layout,
    save_layout,
    write_sheet,
)
from laticauda.film.tracking import (
    BodyTrack,
    build_trial,
    draw_over_frames,
    follow_points,
    follow_tags,
)
from laticauda.motion.gaits import lateral_undulation
from laticauda.scenarios import Choice
from laticauda.show.figures import save_figure
from laticauda.values import BadArgument, option, quantity, value_class

FILM_ENDINGS = (".mp4", ".avi", ".mov", ".m4v", ".mkv", ".mts", ".webm", ".wmv")
"""Endings of films; any other file holds points of a tracker."""
FEWEST_POINTS = 2
"""Points of a tracker that show where a body is, and its direction."""
STILL = lateral_undulation(amplitude=0.0, frequency=0.0, phase_shift=0.0)
"""Gait of a body that holds straight."""


@value_class
class Tags(Command):
    """Write a sheet of tags to print at true scale, and a file that says which is where.

    For example: laticauda tags --robot mamba --area 3 2 --output tags.pdf

    Beside tags.pdf, it writes tags.toml: measure where the tags on the floor are, and correct their
    places there. `laticauda track` reads it.
    """

    robot: str = option("Robot, a preset or a TOML file", default="mamba")
    output: Annotated[RequiredFile, OutputFile((".pdf",))] = option("PDF to write or replace")
    area: tuple[float, float] = quantity(
        "m", "Length and width of the area that the tags on the floor surround", default=(3.0, 2.0)
    )
    floor_tags: int = quantity("", "Number of tags on the floor", default=6, ge=4, le=20)
    floor_size: float = quantity("m", "Side of their black squares", default=0.13, gt=0.0)
    link_size: float | None = quantity(
        "m", "Side of those on the robot; as its links allow if omitted", default=None, gt=0.0
    )
    dictionary: Literal["aruco-4x4", "apriltag-36h11"] = option(
        "Set of tags; the second needs more pixels", default="aruco-4x4"
    )
    floor_only: bool = option("Only tags for the floor, for films of animals", default=False)
    paper: Literal["a4", "a3", "letter"] = option("Paper", default="a4")

    def run(self) -> Outcome:
        """Write both files."""
        layout = propose_layout(
            lc.load_robot(self.robot),
            area=self.area,
            n_floor_tags=self.floor_tags,
            floor_size=self.floor_size,
            link_size=self.link_size,
            dictionary=self.dictionary,
        )
        if self.floor_only:
            layout = replace(layout, links=())
        places = str(Path(self.output).with_suffix(".toml"))
        check_output("output", places, (".toml",))
        n_pages = write_sheet(layout, self.output, self.paper)
        save_layout(layout, places)
        steps = describe_placing(layout)
        numbered = [f"{i}. {step}" for i, step in enumerate(steps, start=1)]
        text = f"{self.output}: {n_pages} pages; {places}: places of the tags\n"
        facts = {"output": self.output, "tags": places, "n_pages": n_pages, "steps": steps}
        return Outcome(facts=facts, text=text + "\n".join(numbered))


@value_class
class CalibrateLens(Command):
    """Calibrate a camera's lens from a film of a checkerboard that is held at different angles.

    For example: laticauda lens board.mp4 --columns 9 --rows 6 --square 0.025 --output lens.toml
    """

    file: FileArgument = option("The film")
    columns: int = quantity("", "Inner corners of the checkerboard along a row", ge=3)
    rows: int = quantity("", "Inner corners along a column", ge=3)
    square: float = quantity("m", "Side of a square", gt=0.0)
    output: TomlOutput = option("TOML file to write, for `laticauda track --lens`", default=None)

    def run(self) -> Outcome:
        """Calibrate."""
        board = Checkerboard(columns=self.columns, rows=self.rows, square=self.square)
        show = show_progress(SHARE, what="read", patience=PATIENCE)
        pictures = pictures_of_film(self.file, on_progress=show)
        lens = calibrate_lens(pictures, board)
        if self.output is not None:
            save_calibration(lens, self.output)
        share = lens.focal_length_deviation
        text = (
            f"focal length {lens.focal_length:.1f} px, certain to {share:.2%}; "
            f"distortion k1 {lens.distortion[0]:.4f}, k2 {lens.distortion[1]:.4f}"
        )
        facts = {
            "focal_length": lens.focal_length,
            "distortion": lens.distortion,
            "output": self.output,
        }
        return Outcome(facts=facts, text=text)


@value_class
class OfCamera(Command):
    """A command that calibrates a camera by tags on the floor."""

    tags: File = option("Tags, as `laticauda tags` wrote the file", default=None)
    lens: File = option("The lens, as `laticauda lens` wrote it", default=None)
    height: float = quantity(
        "m",
        "Height of the plane of motion, such as tags on a robot, above the tags on the floor",
        default=0.0,
    )
    height_deviation: float = quantity(
        "m", "Standard deviation of this height", default=0.003, ge=0.0
    )
    water_surface: float | None = quantity(
        "m",
        "Height of the water's surface above the tags on the floor, if there is any above either",
        default=None,
    )
    surface_deviation: float = quantity(
        "m", "Standard deviation of the height of the surface", default=0.003, ge=0.0
    )

    def calibrate(self, marks: Marks, image_size: tuple[int, int]) -> CameraCalibration:
        """Calibrate the camera by marks of known places.

        Args:
            marks: The marks.
            image_size: Width and height of the picture [px].
        """
        surface = None
        if self.water_surface is not None:
            surface = Surface(height=self.water_surface, height_deviation=self.surface_deviation)
        lens = None
        if self.lens is not None:
            lens = load_lens(self.lens)
        try:
            return calibrate_camera(
                marks,
                image_size,
                lens=lens,
                surface=surface,
                plane_height=self.height,
                plane_height_deviation=self.height_deviation,
            )
        except BadArgument as error:
            if error.name != "plane_height":
                raise
            raise BadArgument("height", error.rule) from None


@value_class
class Camera(OfCamera):
    """Calibrate a camera for the points of a tracker: by tags on the floor, a checkerboard in the plane, or a ruler.

    For example: laticauda camera swim.mp4 --tags tags.toml --height 0.1 --output camera.toml

    A ruler is for a camera that looks straight down: laticauda camera film.mp4 --ruler-px 212 540
    1710 548 --ruler-length 1 --output camera.toml
    """

    file: FileArgument = option("A film by this camera, which does not move")
    output: Annotated[RequiredFile, OutputFile((".toml",))] = option(
        "TOML file to write, for `laticauda track --calibration`"
    )
    columns: int | None = quantity(
        "", "Inner corners of a checkerboard in the plane, along a row", default=None, ge=3
    )
    rows: int | None = quantity("", "Inner corners along a column", default=None, ge=3)
    square: float | None = quantity("m", "Side of its squares", default=None, gt=0.0)
    ruler_px: tuple[float, float, float, float] | None = quantity(
        "px", "x and y of both ends of a ruler in the plane of motion", default=None
    )
    ruler_length: float | None = quantity("m", "Distance of these ends", default=None, gt=0.0)

    def run(self) -> Outcome:
        """Calibrate."""
        ways = {"--tags": self.tags, "--columns": self.columns, "--ruler-px": self.ruler_px}
        chosen = [way for way, typed in ways.items() if typed is not None]
        if len(chosen) != 1:
            raise BadFlag(f"one of {', '.join(ways)} must be given, got {len(chosen)} of them")
        if self.ruler_px is not None:
            camera: Calibration = self._calibrate_by_ruler(self.ruler_px)
        elif self.tags is not None:
            layout = load_layout(self.tags)
            show = show_progress(SHARE, what="searched", patience=PATIENCE)
            film = find_tags(self.file, layout, frame_rate=1.0, on_progress=show)
            camera = self.calibrate(marks_of_floor(film, layout), film.image_size)
        else:
            camera = self._calibrate_by_board()
        save_calibration(camera, self.output)
        rows = [*describe_residual(camera)]
        if isinstance(camera, RulerCalibration):
            width, height = (camera.metres_per_pixel * side for side in camera.image_size)
            rows.append(("picture", f"{width:.3g} m wide and {height:.3g} m high in the plane"))
        rows += [("note", describe_certainty(camera)), ("camera", self.output)]
        facts = {
            "output": self.output,
            "scale_deviation": camera.scale_deviation,
            "position_deviation": camera.position_deviation,
        }
        return Outcome(facts=facts, text=format_rows(rows))

    def _calibrate_by_ruler(self, ends: tuple[float, float, float, float]) -> Calibration:
        if self.ruler_length is None:
            raise BadFlag("--ruler-length must be given with --ruler-px")
        picture = pictures_of_film(self.file, n_pictures=1)[0]
        size = (int(picture.shape[1]), int(picture.shape[0]))
        try:
            return calibrate_by_ruler(size, ends[:2], ends[2:], self.ruler_length)
        except BadArgument as error:
            rule = error.rule.replace("`begin`", "its other end")
            raise BadFlag(f"--ruler-px: the {error.name} {rule}") from None

    def _calibrate_by_board(self) -> Calibration:
        if self.columns is None or self.rows is None or self.square is None:
            raise BadFlag("--columns, --rows and --square must be given together")
        board = Checkerboard(columns=self.columns, rows=self.rows, square=self.square)
        picture = pictures_of_film(self.file, n_pictures=1)[0]
        size = (int(picture.shape[1]), int(picture.shape[0]))
        return self.calibrate(marks_of_board(picture, board), size)


def describe_residual(camera: Calibration | None) -> list[tuple[str, str]]:
    """Return a row that says how well marks fit; none for a ruler.

    Args:
        camera: The calibration.
    """
    if not isinstance(camera, CameraCalibration):
        return []
    return [("camera", f"marks fit to {camera.residual:.2f} px")]


def format_rows(rows: Sequence[tuple[str, str]]) -> str:
    """Return rows of a name and a text.

    Args:
        rows: The rows.
    """
    return "\n".join(f"{name:<9}{text}" for name, text in rows)


@value_class
class Track(OfCamera):
    """Make a trial from a film: path, heading and joint angles of a robot with tags, or of points that a tracker found.

    For example: laticauda track glide.mp4 --tags tags.toml --height 0.1 --straight --save glide.nc
    --picture glide.png

    The points of a tracker (DeepLabCut, SLEAP, TRex, idtracker.ai, or a table) need places on the
    body and a calibration: laticauda track eel.csv --robot eel.toml --along nose=0.39 tail=0.01
    --calibration camera.toml --frame-rate 60
    """

    file: FileArgument = option("The film, or the file of a tracker")
    robot: str = option("What swims, a preset or a TOML file", default="mamba")
    water: str | None = option("Water, a preset or a TOML file", default=None)
    calibration: File = option(
        "The camera, as --save-calibration wrote it; else from the tags", default=None
    )
    frame_rate: float | None = quantity(
        "1/s",
        "Frames per second at which the film was taken; if omitted, as it states",
        default=None,
        gt=0.0,
    )
    start: float | None = quantity("s", "Time in the film at which the trial begins", default=None)
    stop: float | None = quantity("s", "Time in the film at which it ends", default=None)
    straight: bool = option(
        "The body holds straight, as in a glide: one tag is enough", default=False
    )
    each_frame: bool = option(
        "Take every frame by itself, without fitting a chain to all of them", default=False
    )
    longest_gap: float = quantity(
        "s", "Gaps up to this long are filled by straight lines", default=0.2, ge=0.0
    )
    smoothing: float = quantity(
        "s", "Rates are slopes of cubic fits over this time", default=0.2, gt=0.0
    )
    along: Words = option(
        "NAME=METRES: distance of each of a tracker's points from the tail end", default=()
    )
    individual: str | None = option("Whose points, if a tracker found several", default=None)
    likelihood_floor: float | None = quantity(
        "",
        "Points less sure than this are lost; as is usual for the tracker if omitted",
        default=None,
        ge=0.0,
        le=1.0,
    )
    film: File = option("Film of a tracker's points, to draw the chain over", default=None)
    save: TrialOutput = option("Write the trial (.nc, .mcap, ...)", default=None)
    save_calibration: TomlOutput = option("Write the calibration of the camera", default=None)
    picture: PictureOutput = option("Draw the chain over frames of the film", default=None)

    def run(self) -> Outcome:
        """Track."""
        self._check_span()
        self._check_kind_of_file()
        choice = Choice(robot=self.robot, water=self.water)
        chosen = choice.resolved(STILL, lc.load_robot)
        if self._is_film:
            track = self._follow_tags(chosen.robot)
        else:
            track = self._follow_points(chosen.robot)
        if self.picture is not None:
            film = self.film
            if self._is_film:
                film = self.file
            save_figure(draw_over_frames(track, film), self.picture)
        trial = build_trial(
            track,
            chosen.robot,
            chosen.environment,
            start=self.start,
            stop=self.stop,
            longest_gap=self.longest_gap,
            smoothing=self.smoothing,
        )
        if self.save is not None:
            trial.save(self.save)
        return Outcome(facts=self._facts_of(trial, track), text=self._describe(trial, track))

    @property
    def _is_film(self) -> bool:
        """Whether the file is a film of tags, not the points of a tracker."""
        return Path(self.file).suffix.lower() in FILM_ENDINGS

    def _check_span(self) -> None:
        """Reject a trial that ends before it begins, before the film is searched."""
        if self.start is not None and self.stop is not None and self.stop <= self.start:
            raise BadFlag(f"--stop must be > --start = {self.start:g} s, got {self.stop:g}")

    def _check_kind_of_file(self) -> None:
        """Reject options that would do nothing: those of the points of a tracker for a film, and vice versa."""
        of_points = {
            "--along": self.along or None,
            "--individual": self.individual,
            "--likelihood-floor": self.likelihood_floor,
            "--film": self.film,
        }
        of_films = {
            "--tags": self.tags,
            "--lens": self.lens,
            "--water-surface": self.water_surface,
            "--straight": self.straight or None,
            "--each-frame": self.each_frame or None,
            "--save-calibration": self.save_calibration,
        }
        idle, kind = (of_points, "a film") if self._is_film else (of_films, "points of a tracker")
        for flag, value in idle.items():
            if value is not None:
                raise BadFlag(f"{flag} must be left out for {kind}: it would do nothing")

    def _follow_tags(self, robot: lc.Robot) -> BodyTrack:
        if self.tags is None:
            raise BadFlag(
                "--tags must be given for a film: the file that `laticauda tags` wrote. Points of a "
                "tracker are read from its own file, not from the film."
            )
        layout = load_layout(self.tags)
        show = show_progress(SHARE, what="searched", patience=PATIENCE)
        film = find_tags(self.file, layout, frame_rate=self.frame_rate, on_progress=show)
        camera = self._load_camera()
        if camera is None:
            by_tags = self.calibrate(marks_of_floor(film, layout), film.image_size)
            if self.save_calibration is not None:
                save_calibration(by_tags, self.save_calibration)
            camera = by_tags
        return follow_tags(
            film,
            layout,
            camera,
            robot,
            is_straight=self.straight,
            takes_frames_alone=self.each_frame,
        )

    def _load_camera(self) -> Calibration | None:
        if self.calibration is None:
            return None
        return load_calibration(self.calibration)

    def _follow_points(self, robot: lc.Robot) -> BodyTrack:
        points = read_points(
            self.file,
            frame_rate=self.frame_rate,
            individual=self.individual,
            likelihood_floor=self.likelihood_floor,
        )
        distance_of = _read_distances(self.along, points.names)
        chosen = points.only(tuple(distance_of))
        places = places_at(list(distance_of.values()))
        return follow_points(chosen, places, self._load_camera(), robot)

    def _facts_of(self, trial: lc.Trial, track: BodyTrack) -> Mapping[str, Any]:
        facts = dict(report.facts_of_trial(trial))
        facts["notes"] = list(track.notes)
        facts["save"] = self.save
        if isinstance(track.calibration, CameraCalibration):
            facts["residual"] = track.calibration.residual
        if track.calibration is not None:
            facts["scale_deviation"] = track.calibration.scale_deviation
            facts["position_deviation"] = track.calibration.position_deviation
        return facts

    def _describe(self, trial: lc.Trial, track: BodyTrack) -> str:
        rows = [("seen", f"{trial.time.size} frames, {trial.time[-1] - trial.time[0]:.2f} s")]
        rows += describe_residual(track.calibration)
        rows += [("note", note) for note in track.notes]
        if math.isfinite(track.center_deviation):
            noise = f"center of mass to {1e3 * track.center_deviation:.2g} mm"
            option_of_identify = f"--measured center_of_mass={track.center_deviation:.1g}"
            rows.append(("noise", f"{noise}: for identify, {option_of_identify}"))
        moved = float(((trial.center_of_mass[-1] - trial.center_of_mass[0]) ** 2).sum() ** 0.5)
        duration = float(trial.time[-1] - trial.time[0])
        rows.append(("path", f"{moved:.3f} m from begin to end, {moved / duration:.4f} m/s"))
        for name, path in (("trial", self.save), ("picture", self.picture)):
            if path is not None:
                rows.append((name, path))
        return format_rows(rows)


def _read_distances(words: tuple[str, ...], names: tuple[str, ...]) -> dict[str, float]:
    """Return the distances of points from the tail end [m], by name."""
    listed = ", ".join(names)
    if not words:
        raise BadFlag(
            "--along must say where the points sit on the body, NAME=METRES from the tail end; the "
            f"file has {listed}"
        )
    distances: dict[str, float] = {}
    for word in words:
        name, separator, number = word.rpartition("=")
        try:
            distance = float(number)
        except ValueError:
            separator = ""
            distance = 0.0
        if not separator:
            raise BadFlag(f"--along must be NAME=METRES, got {word!r}")
        if name not in names:
            raise BadFlag(f"--along must name points of the file, {listed}, got {name!r}")
        distances[name] = distance
    if len(distances) < FEWEST_POINTS:
        raise BadFlag(f"--along must place at least {FEWEST_POINTS} points: one has no direction")
    return distances
