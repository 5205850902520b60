"""`laticauda view`: a stored trial in 3D, in a window, as a film or as a picture."""

from collections.abc import Sequence
from typing import Annotated

import laticauda as lc
from laticauda.cli import command, flags, progress
from laticauda.errors import BadArgument
from laticauda.pictures.camera import Film
from laticauda.quantities import option, quantity, value


@value
class Filming(command.Command):
    """A command that has a trial, of which it may make a film."""

    video: flags.Mp4 = option("Show the run in 3D in this film (.mp4)", default=None)
    film: Film = option("What the film shows, and how large", default=Film())

    def write_film(self, trial: lc.Trial, speed: float = 1.0, beside: Sequence[lc.Trial] = ()) -> None:
        """Write the film of a trial, if that is asked for.

        Args:
            trial: Any.
            speed: How many times as fast to show it [-].
            beside: Of other robots in the same scene.
        """
        if self.video is not None:
            from laticauda.pictures.render import video

            begin, end = self.film.span(trial)
            video(trial, self.video, self.film, speed=speed, beside=beside, progress=progress.film_bar(end - begin))


@value
class View(Filming):
    """Show a stored trial in 3D: in MuJoCo's window, or as a film or a picture where there is no screen.

    A planar trial is shown as it was: the 3D robot takes its postures.

    For example: laticauda view run.nc --still run.png
    """

    file: flags.Input = option("The trial, as `laticauda swim --save` wrote it")
    still: Annotated[flags.File, flags.Written((".png",))] = option("Write a picture (.png)", default=None)
    time: float | None = quantity("s", "Moment of the picture; the end if left out", default=None)
    speed: float = quantity("", "How many times as fast to show it", gt=0.0, default=1.0)
    beside: flags.Files = option("Trials of other robots in the same scene, in the film or picture too", default=())

    def run(self) -> command.Outcome:
        """Show or write."""
        if self.time is not None and self.still is None:
            raise BadArgument("time", "must be given with --still: it is the moment of the picture")
        trial, *beside = [lc.load_trial(name) for name in (self.file, *self.beside)]
        if self.still is not None:
            from laticauda.pictures.render import still

            still(trial, self.still, self.film, time=self.time, beside=beside)
        self.write_film(trial, self.speed, beside)
        if self.video is None and self.still is None:
            from laticauda.pictures.replay import show

            show(trial, speed=self.speed)
        return command.Outcome(
            facts={"file": self.file, "video": self.video, "still": self.still},
            text=f"{self.video or self.still or self.file}: {trial.duration:g} s shown",
        )
