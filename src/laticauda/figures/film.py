"""Film of a run in the plane, seen from above: the body, and the path of its center of mass so far."""

# matplotlib's own annotations are partial; this package passes on typed figures and axes.
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownParameterType=false

import base64
import io
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.animation import FuncAnimation
from matplotlib.artist import Artist
from matplotlib.figure import Figure
from PIL import Image

from laticauda.errors import check_positive
from laticauda.figures import style
from laticauda.figures.path import draw_posture, draw_water, outline
from laticauda.figures.swim import title_of
from laticauda.files import write
from laticauda.pictures.render import write_video
from laticauda.trial import Trial, following

HEIGHT, LABELS = (1.2, 4.5), 1.1  # of the plan view, and of title and labels [in]
Draw = Callable[[int], Sequence[Artist]]
FORMATS = {".gif": "GIF", ".webp": "WEBP"}


class Film(FuncAnimation):
    """A matplotlib animation that notebooks show, and that is written in seconds: only moving parts are redrawn.

    Args:
        figure: Figure to draw on.
        draw: Draws one instant, and returns the moving artists.
        moments: Instants, one per frame.
        frames_per_second: Frame rate [1/s].
    """

    def __init__(
        self, figure: Figure, draw: Draw, moments: list[int], frames_per_second: float
    ) -> None:
        self._how = figure, draw, moments, 1e3 / frames_per_second
        super().__init__(
            figure, draw, moments, blit=True, interval=self._how[-1], cache_frame_data=False
        )  # pyright: ignore
        self._draw_was_started = True  # an animation that is never shown is not a mistake

    def pictures(self) -> Iterator[np.ndarray]:
        """Yield all frames in order."""
        figure, draw, moments, _ = self._how
        canvas: Any = figure.canvas
        for artist in draw(moments[0]):
            artist.set_animated(True)
        canvas.draw()
        still = canvas.copy_from_bbox(figure.bbox)
        for moment in moments:
            canvas.restore_region(still)
            for artist in sorted(draw(moment), key=Artist.get_zorder):
                figure.draw_artist(artist)
            pixels = np.asarray(canvas.buffer_rgba())
            yield pixels[: pixels.shape[0] // 2 * 2, : pixels.shape[1] // 2 * 2, :3].copy()

    def save(self, filename: str | Path, *how: Any, **more: Any) -> None:
        """Write the film: .gif or .webp, or .mp4 with the program ffmpeg; matplotlib writes all other files.

        Args:
            filename: The file; an existing one is replaced.
            how: Arguments of matplotlib's `Animation.save`, which then writes the file.
            more: Keyword arguments of `Animation.save`, which then writes the file.
        """
        ending = Path(filename).suffix.lower()
        if how or more or ending not in (*FORMATS, ".mp4"):
            super().save(str(filename), *how, **more)
        elif ending in FORMATS:
            write(filename, partial(self._written, form=FORMATS[ending]))
        else:
            pictures = [*self.pictures()]
            height, width, _ = pictures[0].shape
            write_video(
                pictures, filename, size=(width, height), frames_per_second=1e3 / self._how[-1]
            )

    def _written(self, file: Any, form: str) -> None:
        pictures = [Image.fromarray(one) for one in self.pictures()]
        if form == "GIF":  # a separate palette for each frame would take ten times as long
            how: Any = {"method": Image.Quantize.FASTOCTREE, "dither": Image.Dither.NONE}
            pictures = [one.quantize(64, **how) for one in pictures]
        how = {"duration": self._how[-1], "loop": 0, "method": 1}
        pictures[0].save(file, form, save_all=True, append_images=pictures[1:], **how)

    def _repr_html_(self) -> str:
        content = io.BytesIO()
        self._written(content, "WEBP")
        return f'<img src="data:image/webp;base64,{base64.b64encode(content.getvalue()).decode()}">'


def swim_film(trial: Trial, *, speed: float = 1.0, frames_per_second: float = 15.0) -> Film:
    """Show a run from above as a film.

    Args:
        trial: Any trial, including a failed one; a trial in space is shown in plan view.
        speed: Playback speed as a multiple of real time [-].
        frames_per_second: Frame rate of the film [1/s].
    """
    step = check_positive("speed", speed) / check_positive(
        "frames_per_second", frames_per_second, "1/s"
    )
    moments = np.arange(trial.time[0], trial.time[-1] + 0.5 * step, step)
    shown = np.clip(np.searchsorted(trial.time, moments - 1e-9), 0, trial.time.size - 1).tolist()
    bodies = {sample: outline(trial.chain, trial, sample) for sample in shown}
    corners = np.vstack([*bodies.values()])
    width, height = np.ptp(corners, axis=0)
    figure = style.new_figure(
        style.DOUBLE_COLUMN, np.clip(style.DOUBLE_COLUMN * height / width, *HEIGHT) + LABELS
    )
    ax = style.style_axes(figure.add_subplot(), xlabel="x [m]", ylabel="y [m]")
    ax.update_datalim(corners)
    ax.autoscale_view()
    title = title_of(trial)
    words = style.add_title(figure, title, "0 s")
    if "cross_track_error" in trial.signals:
        ax.plot(*following.nearest_points(trial).T, zorder=0.5, **style.AIM)
    ax.set_aspect("equal", adjustable="box" if draw_water(trial, ax) else "datalim")
    style.freeze_layout(figure)
    ax.set_adjustable("box")
    ax.autoscale(False)
    (way,) = ax.plot([], [], color=style.INK, linewidth=0.8, zorder=4)
    fixed = len(ax.collections)

    def draw(sample: int) -> Sequence[Artist]:
        for artist in ax.collections[fixed:]:
            artist.remove()
        draw_posture(ax, trial.chain, bodies[sample], 0.0)
        way.set_data(*trial.center_of_mass[: sample + 1, :2].T)
        words.set_text(f"{title}\n{trial.time[sample]:.1f} s")
        return [*ax.collections[fixed:], way, words]

    return Film(figure, draw, shown, frames_per_second)
