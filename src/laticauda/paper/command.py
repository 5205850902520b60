"""`laticauda reproduce`: the paper's experiments in simulation, as one folder with a report."""

import os
from typing import TYPE_CHECKING, Literal

from laticauda.cli.command import Command, Outcome
from laticauda.cli.flags import File, Folder
from laticauda.cli.progress import progress
from laticauda.cli.scene import warn_of_compiling
from laticauda.paper.printed import as_text, facts_of
from laticauda.quantities import option, quantity, value

if TYPE_CHECKING:
    from laticauda.robot import Parameters

FORMAT = "{desc} {n_fmt} of {total_fmt} |{bar}| {remaining} left"


@value
class Reproduce(Command):
    """Repeat the paper's experiments in simulation, and put them beside what was measured on the robot.

    Locomotion efficiency (Table 1, Figs. 4 to 11), path following (Table 2, Figs. 12 to 23), what the paper did not
    try, and a verdict on each of its claims. Figures (PNG and PDF), tables (CSV), data (netCDF) and report.html, which
    needs no network, go into one folder. For example: laticauda reproduce --joints prescribed --output reproduction
    """

    only: Literal["efficiency", "path-following"] | None = option("Run this half of the paper only", default=None)
    model: Literal["planar", "spatial"] = option(
        "The model of the body; the one in MuJoCo takes minutes, and is compared with the planar one", default="planar"
    )
    joints: str | None = option("The joint law; the parameters', or prescribed, if left out", default=None)
    parameters: str | None = option(
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

    def run(self) -> Outcome:
        """Run and write."""
        from laticauda.paper.repeats import load_repeats
        from laticauda.paper.report.experiments import paper_experiments
        from laticauda.paper.report.reproduce import reproduce
        from laticauda.robot import load_water

        parameters = self._parameters()
        settings = paper_experiments(parameters)
        joints = self.joints or (parameters.joints if parameters is not None else None) or "prescribed"
        repeats = () if self.repeats is None else load_repeats(self.repeats)
        warn_of_compiling(load_water("paper-lateral"))
        bar = progress(FORMAT)
        done = reproduce(
            self.output,
            settings,
            only=self.only,
            model=self.model,
            joints=joints,
            repeats=repeats,
            workers=os.cpu_count() or 1 if self.workers is None else self.workers,
            progress=lambda what, done, total: bar(done, total, what),
        )
        return Outcome(facts=facts_of(done), text=as_text(done))

    def _parameters(self) -> "Parameters | None":
        from laticauda.robot import load_parameters

        return None if self.parameters is None else load_parameters(self.parameters)
