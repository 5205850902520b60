"""`laticauda view`: a stored trial in 3D, in a window, as a film or as a picture."""

import json
from typing import TYPE_CHECKING, Any

from laticauda.cli.flags import File, Input
from laticauda.cli.outputs import check_output
from laticauda.errors import BadArgument
from laticauda.quantities import option, quantity, value

if TYPE_CHECKING:
    from laticauda.trial import Trial

FILM, STILL = (".mp4",), (".png",)


@value
class View:
    """Show a stored trial in 3D: in MuJoCo's window, or as a film or a picture where there is no screen.

    A planar trial is shown as it was: the 3D robot takes its postures.

    For example: laticauda view run.nc --still run.png
    """

    file: Input = option("The trial, as `laticauda swim --save` wrote it")
    video: File = option("Write a film (.mp4) instead of opening a window", default=None)
    still: File = option("Write a picture (.png) instead of opening a window", default=None)
    time: float | None = quantity("s", "Moment of the picture; the end if left out", default=None)
    speed: float = quantity("", "How many times as fast to show it", gt=0.0, default=1.0)
    json: bool = option("Print one JSON object", default=False)

    def __call__(self) -> int:
        """Show or write, and return the exit status."""
        check_output("video", self.video, FILM)
        check_output("still", self.still, STILL)
        if self.time is not None and self.still is None:
            raise BadArgument("time", "must be given with --still: it is the moment of the picture")
        from laticauda.logs import load_trial

        trial = load_trial(self.file)
        if self.still is not None:
            from laticauda.pictures.render import still

            still(trial, self.still, time=self.time)
        if self.video is not None:
            write_film(trial, self.video, speed=self.speed)
        if self.video is None and self.still is None:
            from laticauda.pictures.window import show

            show(trial, speed=self.speed)
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
