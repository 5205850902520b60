"""`laticauda view`: a stored trial in 3D, in a window, as a film or as a picture."""

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any

import tyro

from laticauda.cli.flags import File, Number, Switch, default
from laticauda.cli.outputs import check_output

if TYPE_CHECKING:
    from laticauda.trial import Trial

FILM, STILL = (".mp4",), (".png",)


@dataclass(frozen=True, kw_only=True)
class View:
    """Show a stored trial in 3D: in MuJoCo's window, or as a film or a picture where there is no screen.

    A planar trial is shown as it was: the 3D robot takes its postures.

    For example: laticauda view run.nc --still run.png
    """

    file: Annotated[str, tyro.conf.Positional, tyro.conf.arg(metavar="FILE", help_behavior_hint="(required)")]
    """The trial, as `laticauda swim --save` wrote it."""
    video: File = None
    """Write a film (.mp4) instead of opening a window."""
    still: File = None
    """Write a picture (.png) instead of opening a window."""
    time: Annotated[Number, default("the end")] = None
    """Moment of the picture [s]."""
    speed: Annotated[Number, default("1")] = None
    """How many times as fast to show it [-]."""
    json: Switch = False
    """Print one JSON object."""

    def __call__(self) -> int:
        """Show or write, and return the exit status."""
        check_output("video", self.video, FILM)
        check_output("still", self.still, STILL)
        if self.time is not None and self.still is None:
            raise ValueError("`time` must be given with `still`: it is the moment of the picture.")
        from laticauda.logs import load_trial

        trial = load_trial(self.file)
        speed = 1.0 if self.speed is None else self.speed
        if self.still is not None:
            from laticauda.pictures.render import still

            still(trial, self.still, time=self.time)
        if self.video is not None:
            write_film(trial, self.video, speed=speed)
        if self.video is None and self.still is None:
            from laticauda.pictures.window import show

            show(trial, speed=speed)
        done = {"file": self.file, "video": self.video, "still": self.still}
        print(json.dumps(done) if self.json else f"{self.video or self.still or self.file}: {trial.duration:g} s shown")
        return 0


def check_film(path: str | None) -> None:
    """Refuse a film that cannot be made, before the run that it would show.

    Args:
        path: What the option `video` has; None is fine.
    """
    check_output("video", path, FILM)
    if path is not None:
        from laticauda.pictures.render import check_video

        check_video()


def write_film(trial: "Trial", path: str, **options: Any) -> None:
    """Write the film of a trial, and show how far it is; arguments as for `pictures.render.video`."""
    from laticauda.cli.progress import progress
    from laticauda.pictures.render import video

    video(trial, path, progress=progress(trial.duration, done="filmed"), **options)
