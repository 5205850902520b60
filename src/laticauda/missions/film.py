"""Film of a mission from above, in time lapse: its way, what the sonar hears, where the robot believes to be."""

# matplotlib's own annotations are partial; this package passes on typed figures and axes.
# pyright: reportUnknownMemberType=false

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.collections import LineCollection

from laticauda.missions.drawing import BELIEVED, color_of_phase
from laticauda.missions.film_frame import (
    FAILURE_COLOR,
    add_legend,
    add_map,
    add_times,
    new_frame,
)
from laticauda.missions.film_water import WaterArrows, describe_water
from laticauda.missions.running import MissionResult, mission_of
from laticauda.missions.sensed import find_pings, list_failures
from laticauda.show.figures import Film, draw_posture, outline, style
from laticauda.values import check_positive

FILM_DURATION = 20.0
"""About how long a film lasts, unless its speed is given [s]."""
LAST_PICTURE = 2.0
"""How long the last picture stays [s]."""
BEAM_TIME = 1.5
"""How long the beams of a ping are shown [s]."""
LEFT = 0.02
"""Left end of texts, in shares of the picture."""
RIGHT = 0.98
"""Right end of texts."""
TITLE_HEIGHT = 0.945
"""Height of the name of the phase, in shares of the picture."""
NOTE_HEIGHT = 0.875
"""Height of the notes below it."""
TITLE: Any = {"fontsize": 15, "va": "center"}
"""Look of the name of the phase."""
NOTE: Any = {"fontsize": style.TICK, "color": style.GRAY}
"""Look of the notes."""
ECHO: Any = style.marker_style("o", 1.2, style.INK, alpha=0.25, markeredgewidth=0.0, zorder=2.0)
"""Look of what the sonar has heard so far."""
BEAM: Any = {"color": style.INK, "linewidth": 0.5, "alpha": 0.35, "zorder": 1.9}
"""Look of the beams that hear something."""
BELIEVED_WAY: Any = BELIEVED | {"label": "way as believed", "zorder": 2.6}
"""Look of the way so far as the robot believes it."""
BELIEVED_POSITION: Any = style.marker_style("o", 8.0, style.INK, markerfacecolor="none", zorder=4.5)
"""Look of where the robot believes its middle to be."""


def film_mission(
    result: MissionResult, *, speed: float | None = None, frames_per_second: float = 30.0
) -> Film:
    """Show a mission from above as a film, in time lapse.

    Places, the way so far in the colors of the phases, beams of the sonar where they hear something
    and all that they have heard, the believed position as a circle, the motion of the water as
    arrows. Below are the phases over time, and when which sensor failed.

    Args:
        result: The mission.
        speed: Playback speed as a multiple of real time, rounded so that pictures fall on samples;
            None: so that the film lasts about 20 s [-].
        frames_per_second: Frame rate of the film [1/s].
    """
    frame_rate = check_positive("frames_per_second", frames_per_second, "1/s")
    n_samples = result.trial.time.size
    sample_interval = result.duration / (n_samples - 1)
    if speed is None:
        speed = result.duration / FILM_DURATION
    wanted_step = check_positive("speed", speed) / (frame_rate * sample_interval)
    step = max(1, round(wanted_step))
    picture = _Picture(result, speed=step * sample_interval * frame_rate)
    samples = list(range(0, n_samples - 1, step))
    samples += round(LAST_PICTURE * frame_rate) * [n_samples - 1]
    return Film(picture.figure, picture.draw, samples, frame_rate)


class _Picture:
    """A picture of a mission at one sample, whose moving parts are drawn again for every other one.

    Args:
        result: The mission.
        speed: Playback speed that is stated [-].
    """

    def __init__(self, result: MissionResult, speed: float) -> None:
        trial = result.trial
        self._result = result
        self._trial = trial
        self._phase_names = mission_of(trial.scenario).phase_names
        self._phases = trial.signals["mission_phase"].astype(int)
        self._pings = find_pings(result)
        self._failures = list_failures(result)
        self.figure = new_frame()
        """The figure."""
        self._map: Any = add_map(self.figure, result)
        self._arrows = WaterArrows(self._map, trial.environment, result.duration)
        self._add_lines()
        self._add_texts(speed)
        legend = add_legend(self._map)
        self._in_front: list[Artist] = [*self._map.texts, legend]
        """What does not move, but is in front of what does."""
        self._n_fixed = len(self._map.collections)
        times = add_times(self.figure, result)
        self._cursor: Any = times.axvline(0.0, color=style.INK, linewidth=1.5)

    def _add_lines(self) -> None:
        """Add the lines and marks on the map."""
        add_line = self._map.plot
        self._ways: list[Any] = []
        for phase in range(len(self._phase_names)):
            (way,) = add_line([], [], color=color_of_phase(phase), linewidth=1.3, zorder=2.5)
            self._ways.append(way)
        (self._believed_way,) = add_line([], [], **BELIEVED_WAY)
        (self._believed_position,) = add_line(
            [], [], label="believes to be here", **BELIEVED_POSITION
        )
        (self._echoes,) = add_line([], [], label="echoes of the sonar", **ECHO)

    def _add_texts(self, speed: float) -> None:
        """Add the texts above the map; the note on speed and water does not change."""
        figure: Any = self.figure
        self._phase_text = figure.text(LEFT, TITLE_HEIGHT, "", weight="bold", **TITLE)
        self._note = figure.text(LEFT, NOTE_HEIGHT, "", **NOTE)
        self._time_text = figure.text(RIGHT, TITLE_HEIGHT, "", ha="right", **TITLE)
        self._failure_text = figure.text(
            0.5, TITLE_HEIGHT, "", ha="center", color=FAILURE_COLOR, **TITLE
        )
        water = describe_water(self._trial.environment)
        note = f"{speed:.0f} times real time, {water}"
        figure.text(RIGHT, NOTE_HEIGHT, note, ha="right", **NOTE)

    def draw(self, sample: int) -> Sequence[Artist]:
        """Draw one sample; return the moving parts.

        Args:
            sample: Its index.
        """
        for artist in self._passing_artists():
            artist.remove()
        time = float(self._trial.time[sample])
        self._draw_way(sample)
        self._draw_echoes(time)
        self._arrows.turn(time)
        robot = self._trial.chain
        body = outline(robot, self._trial, sample)
        draw_posture(self._map, robot, body, 0.0)
        self._cursor.set_xdata([time, time])
        self._write_texts(sample)
        return [
            *self._arrows.artists,
            *self._ways,
            self._believed_way,
            self._believed_position,
            self._echoes,
            *self._passing_artists(),
            *self._in_front,
            self._cursor,
            self._phase_text,
            self._note,
            self._time_text,
            self._failure_text,
        ]

    def _passing_artists(self) -> list[Artist]:
        """Return what is drawn anew for every picture: body and beams."""
        return list(self._map.collections[self._n_fixed :])

    def _draw_way(self, sample: int) -> None:
        """Draw the way so far, and the way as believed."""
        n_passed = sample + 1
        x, y = self._trial.center_of_mass[:n_passed, :2].T
        for phase, line in enumerate(self._ways):
            is_in_phase = self._phases[:n_passed] == phase
            shown_x = np.where(is_in_phase, x, np.nan)
            shown_y = np.where(is_in_phase, y, np.nan)
            line.set_data(shown_x, shown_y)
        believed_x = self._trial.signals["believed_x"][:n_passed]
        believed_y = self._trial.signals["believed_y"][:n_passed]
        self._believed_way.set_data(believed_x, believed_y)
        self._believed_position.set_data(believed_x[-1:], believed_y[-1:])

    def _draw_echoes(self, time: float) -> None:
        """Draw the beams of the last ping, and all echoes so far."""
        pings = [ping for ping in self._pings if ping.time <= time]
        if not pings:
            self._echoes.set_data([], [])
            return
        all_echoes = np.concatenate([ping.echoes for ping in pings])
        self._echoes.set_data(all_echoes[:, 0], all_echoes[:, 1])
        last = pings[-1]
        if time - last.time <= BEAM_TIME:
            beams = [np.stack((last.head, echo)) for echo in last.echoes]
            self._map.add_collection(LineCollection(beams, **BEAM))

    def _write_texts(self, sample: int) -> None:
        """Write the phase with the reason why it began, the time, and which sensors fail."""
        time = float(self._trial.time[sample])
        phase = int(self._phases[sample])
        self._phase_text.set_text(self._phase_names[phase])
        self._phase_text.set_color(color_of_phase(phase))
        self._note.set_text(self._describe_reason(time))
        self._time_text.set_text(f"{time:.0f} s")
        failures = [failure for failure in self._failures if failure.lasts_at(time)]
        self._failure_text.set_text(", ".join(failure.description for failure in failures))
        if sample == self._trial.time.size - 1:
            self._phase_text.set_text(_describe_end(self._result))
            self._note.set_text(_describe_figures(self._result))

    def _describe_reason(self, time: float) -> str:
        """Return why the phase began, in words."""
        changes = [change for change in self._result.changes if change.time <= time]
        if not changes:
            return ""
        return f"after {changes[-1].before}: {changes[-1].reason}"


def _describe_end(result: MissionResult) -> str:
    """Return how a mission ended, in words."""
    if result.is_docked:
        return "docked"
    return f"ended in {result.last_phase}"


def _describe_figures(result: MissionResult) -> str:
    """Return what came of a mission, in a few words."""
    clearance = f"clearance {result.clearance:.2f} m"
    if result.share_seen is None:
        return clearance
    return f"{clearance}, {100.0 * result.share_seen:.0f} % of the net seen"
