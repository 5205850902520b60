"""`laticauda view`: a stored trial in 3D, in a window, as a film or as a picture."""

from typing import Annotated, Any

import laticauda as lc
from laticauda.cli.command import Command, Outcome
from laticauda.cli.flags import File, Film, Input, Written
from laticauda.cli.progress import run_bar
from laticauda.errors import BadArgument
from laticauda.quantities import option, quantity, value


@value
class View(Command):
    """Show a stored trial in 3D: in MuJoCo's window, or as a film or a picture where there is no screen.

    A planar trial is shown as it was: the 3D robot takes its postures.

    For example: laticauda view run.nc --still run.png
    """

    file: Input = option("The trial, as `laticauda swim --save` wrote it")
    video: Film = option("Write a film (.mp4) instead of opening a window", default=None)
    still: Annotated[File, Written((".png",))] = option(
        "Write a picture (.png) instead of opening a window", default=None
    )
    time: float | None = quantity("s", "Moment of the picture; the end if left out", default=None)
    speed: float = quantity("", "How many times as fast to show it", gt=0.0, default=1.0)

    def run(self) -> Outcome:
        """Show or write."""
        if self.time is not None and self.still is None:
            raise BadArgument("time", "must be given with --still: it is the moment of the picture")
        trial = lc.load_trial(self.file)
        if self.still is not None:
            from laticauda.pictures.render import still

            still(trial, self.still, time=self.time)
        if self.video is not None:
            write_film(trial, self.video, speed=self.speed)
        if self.video is None and self.still is None:
            from laticauda.pictures.replay import show

            show(trial, speed=self.speed)
        return Outcome(
            facts={"file": self.file, "video": self.video, "still": self.still},
            text=f"{self.video or self.still or self.file}: {trial.duration:g} s shown",
        )


def write_film(trial: lc.Trial, path: str, **options: Any) -> None:
    """Write the film of a trial, and show how far it is; arguments as for `pictures.render.video`."""
    from laticauda.pictures.render import video

    video(trial, path, progress=run_bar(trial.duration, "filmed"), **options)
