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

from laticauda.show.figures import style
from laticauda.show.figures.places import draw_places, outlines_of, places_of
from laticauda.show.figures.posture import draw_posture, outline
from laticauda.show.figures.swim import title_of
from laticauda.show.figures.water import draw_water
from laticauda.show.pictures import write_video
from laticauda.trials import Trial, following
from laticauda.values import check_positive, write

PLAN_HEIGHTS = (1.2, 4.5)
"""Smallest and largest height of the plan view [in]."""
LABELS_HEIGHT = 1.1
"""Height of title and labels [in]."""
GIF_COLORS = 64
"""Colors of a GIF."""
Draw = Callable[[int], Sequence[Artist]]
"""Draws one sample, and returns the moving artists."""
FORMATS = {".gif": "GIF", ".webp": "WEBP"}
"""Formats that are written by Pillow, by the ending of the file."""


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
        self._shown_figure = figure
        self._draw_sample = draw
        self._moments = moments
        self._frame_interval = 1e3 / frames_per_second
        """Time between two frames [ms]."""
        super().__init__(
            figure, draw, moments, blit=True, interval=self._frame_interval, cache_frame_data=False
        )  # pyright: ignore
        self._draw_was_started = True  # an animation that is never shown is not a mistake

    def pictures(self) -> Iterator[np.ndarray]:
        """Yield all frames in order."""
        figure = self._shown_figure
        canvas: Any = figure.canvas
        for artist in self._draw_sample(self._moments[0]):
            artist.set_animated(True)
        canvas.draw()
        background = canvas.copy_from_bbox(figure.bbox)
        for moment in self._moments:
            canvas.restore_region(background)
            for artist in sorted(self._draw_sample(moment), key=Artist.get_zorder):
                figure.draw_artist(artist)
            pixels = np.asarray(canvas.buffer_rgba())
            # Films want even numbers of pixels.
            height = pixels.shape[0] // 2 * 2
            width = pixels.shape[1] // 2 * 2
            yield pixels[:height, :width, :3].copy()

    def save(self, filename: str | Path, *arguments: Any, **keywords: Any) -> None:
        """Write the film: .gif or .webp, or .mp4 with the program ffmpeg; matplotlib writes all other files.

        Args:
            filename: The file; an existing one is replaced.
            arguments: Arguments of matplotlib's `Animation.save`, which then writes the file.
            keywords: Keyword arguments of `Animation.save`, which then writes the file.
        """
        ending = Path(filename).suffix.lower()
        if arguments or keywords or ending not in (*FORMATS, ".mp4"):
            super().save(str(filename), *arguments, **keywords)
        elif ending in FORMATS:
            write(filename, partial(self._write_images, image_format=FORMATS[ending]))
        else:
            pictures = [*self.pictures()]
            height, width, _ = pictures[0].shape
            write_video(
                pictures,
                filename,
                size=(width, height),
                frames_per_second=1e3 / self._frame_interval,
            )

    def _write_images(self, file: Any, image_format: str) -> None:
        images = [Image.fromarray(picture) for picture in self.pictures()]
        if image_format == "GIF":  # a separate palette for each frame would take ten times as long
            images = [
                image.quantize(
                    GIF_COLORS, method=Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE
                )
                for image in images
            ]
        images[0].save(
            file,
            image_format,
            save_all=True,
            append_images=images[1:],
            duration=self._frame_interval,
            loop=0,
            method=1,
        )

    def _repr_html_(self) -> str:
        content = io.BytesIO()
        self._write_images(content, "WEBP")
        encoded = base64.b64encode(content.getvalue()).decode()
        return f'<img src="data:image/webp;base64,{encoded}">'


def swim_film(trial: Trial, *, speed: float = 1.0, frames_per_second: float = 15.0) -> Film:
    """Show a run from above as a film.

    Args:
        trial: Any trial, including a failed one; a trial in space is shown in plan view.
        speed: Playback speed as a multiple of real time [-].
        frames_per_second: Frame rate of the film [1/s].
    """
    frame_rate = check_positive("frames_per_second", frames_per_second, "1/s")
    step = check_positive("speed", speed) / frame_rate
    moments = np.arange(trial.time[0], trial.time[-1] + 0.5 * step, step)
    following_samples = np.searchsorted(trial.time, moments - 1e-9)
    samples = np.clip(following_samples, 0, trial.time.size - 1).tolist()
    bodies = {sample: outline(trial.chain, trial, sample) for sample in samples}
    corners = np.vstack([*bodies.values(), *outlines_of(places_of(trial))])
    width, height = np.ptp(corners, axis=0)
    plan_height = np.clip(style.DOUBLE_COLUMN * height / width, *PLAN_HEIGHTS)
    figure = style.new_figure(style.DOUBLE_COLUMN, plan_height + LABELS_HEIGHT)
    ax = style.style_axes(figure.add_subplot(), xlabel="x [m]", ylabel="y [m]")
    ax.update_datalim(corners)
    ax.autoscale_view()
    title = title_of(trial)
    title_text = style.add_title(figure, title, "0 s")
    if "cross_track_error" in trial.signals:
        ax.plot(*following.nearest_points(trial).T, zorder=0.5, **style.AIM)
    draw_places(ax, places_of(trial))
    has_field = draw_water(trial, ax)
    ax.set_aspect("equal", adjustable="box" if has_field else "datalim")
    style.freeze_layout(figure)
    ax.set_adjustable("box")
    ax.autoscale(False)
    (path_line,) = ax.plot([], [], color=style.INK, linewidth=0.8, zorder=4)
    n_fixed = len(ax.collections)

    def draw(sample: int) -> Sequence[Artist]:
        for artist in ax.collections[n_fixed:]:
            artist.remove()
        draw_posture(ax, trial.chain, bodies[sample], 0.0)
        path_line.set_data(*trial.center_of_mass[: sample + 1, :2].T)
        title_text.set_text(f"{title}\n{trial.time[sample]:.1f} s")
        return [*ax.collections[n_fixed:], path_line, title_text]

    return Film(figure, draw, samples, frames_per_second)
