"""`laticauda reproduce`: the paper's experiments in simulation, as one folder with a report."""

import os
import sys
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Literal

from laticauda.cli.flags import File, Folder, Maybe, MaybeName
from laticauda.cli.scene import COMPILING
from laticauda.paper.printed import as_json, as_text
from laticauda.quantities import option, quantity, value

if TYPE_CHECKING:
    from laticauda.robot import Parameters

FORMAT = "{desc} {n_fmt} of {total_fmt} |{bar}| {remaining} left"


@value
class Reproduce:
    """Repeat the paper's experiments in simulation, and put them beside what was measured on the robot.

    Locomotion efficiency (Table 1, Figs. 4 to 11), path following (Table 2, Figs. 12 to 23), what the paper did not
    try, and a verdict on each of its claims. Figures (PNG and PDF), tables (CSV), data (netCDF) and report.html, which
    needs no network, go into one folder. For example: laticauda reproduce --joints prescribed --output reproduction
    """

    only: Literal["efficiency", "path-following"] | None = option("Run this half of the paper only", default=None)
    model: Literal["planar", "spatial"] = option(
        "The model of the body; the one in MuJoCo takes minutes, and is compared with the planar one", default="planar"
    )
    joints: Maybe = option("The joint law; the parameters', or prescribed, if left out", default=None)
    parameters: MaybeName = option(
        "A preset or a parameter file (TOML): its numbers for water and robots instead of the paper's, which stay "
        "beside them for efficiency, and its joint law unless --joints is given",
        default=None,
    )
    repeats: File = option(
        "Repeated measurements (CSV: gait, config, alpha_deg, omega_deg_s, delta_deg, v_m_s, P_avg_W) to show on the "
        "figures of the efficiency study with their scatter",
        default=None,
    )
    workers: int | None = quantity(
        "", "Processes to spread the work over; one per core if left out", ge=1, default=None
    )
    output: Folder = option("The folder; made if need be, files of the same names are replaced", default="reproduction")
    json: bool = option("Print one JSON object instead of the tables", default=False)

    def __call__(self) -> int:
        """Run, write, print, and return the exit status."""
        from laticauda.errors import SimulationFailed
        from laticauda.paper.repeats import load_repeats
        from laticauda.paper.report.experiments import paper_experiments
        from laticauda.paper.report.reproduce import reproduce

        parameters = self._parameters()
        settings = paper_experiments(parameters)
        joints = self.joints or (parameters.joints if parameters is not None else None) or "prescribed"
        repeats = () if self.repeats is None else load_repeats(self.repeats)
        _warn_of_compiling()
        try:
            done = reproduce(
                self.output,
                settings,
                only=self.only,
                model=self.model,
                joints=joints,
                repeats=repeats,
                workers=os.cpu_count() or 1 if self.workers is None else self.workers,
                progress=_progress(),
            )
        except SimulationFailed as error:
            print(error, file=sys.stderr)
            return 1
        print(as_json(done) if self.json else as_text(done))
        return 0

    def _parameters(self) -> "Parameters | None":
        from laticauda.robot import load_parameters

        return None if self.parameters is None else load_parameters(self.parameters)


def _warn_of_compiling() -> None:
    from laticauda.robot import load_water
    from laticauda.simulate import needs_compiling

    if needs_compiling(load_water("paper-lateral")):
        print(COMPILING, file=sys.stderr, flush=True)


def _progress() -> Callable[[str, int, int], None]:
    """A bar on standard error for each part of the work, if that is a terminal."""
    bars: dict[str, Any] = {}

    def show(what: str, done: int, total: int) -> None:
        if not sys.stderr.isatty():
            return
        if what not in bars:
            from tqdm import tqdm

            bars[what] = tqdm(total=total, desc=what, bar_format=FORMAT, leave=False, file=sys.stderr)
        bars[what].update(done - bars[what].n)
        if done >= total:
            bars[what].close()

    return show
