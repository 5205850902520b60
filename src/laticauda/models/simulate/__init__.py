"""Creating plants by name and running them: `build_plant`, `run`, `swim`, and `swim_many` for many runs at once.

plants.py           plants of scenarios
runner.py           one run over time, with its controller and log
timeline.py         spans between control instants, and legs with one command each
several.py          several runs on threads, or several robots in one scene
cluster.py          tasks on the workers of a Dask cluster
many.py             `swim_many`: figures of many runs
batch_scenarios.py  scenarios and runs of a batch, from the arguments of `swim_many`
batch_run.py        running a batch, block by block
steered.py          runs that controllers steer, side by side
steered_trials.py   trials of these, each with its log
loads_of_many.py    what links and joints bear in each run of a batch
batch_figures.py    what is kept of each run, and the figures computed from it
run_table.py        many runs as columns, without an object for each
table_run.py        running these
harvest.py          what is taken from their logs, in compiled code (template)
run_figures.py      names, units and titles of these figures
numbers.py          parameters that can be swept, by dotted name
parameter_paths.py  steps of these names, and changing what they lead to
joint_motion.py     the numbers among them that a gait has for every joint
tapers.py           those of tapers along the body
joint_use.py        how much of what it offers every joint uses, in many runs
sensitivity.py      `compute_sensitivities`: figures and their derivatives
derivatives.py      batches that carry derivatives
row_derivatives.py  how a number enters a run
gradients.py        derivatives of a few figures to many numbers, backward in time
certainty.py        intervals of figures, from those of coefficients
"""

from typing import TYPE_CHECKING

from laticauda.values import lazy_exports

if TYPE_CHECKING:
    from laticauda.models.simulate.certainty import (
        intervals_of as intervals_of,
        figure_intervals as figure_intervals,
        widen_by_textbook_error as widen_by_textbook_error,
    )
    from laticauda.models.simulate.sensitivity import (
        Sensitivities as Sensitivities,
        compute_sensitivities as compute_sensitivities,
    )
    from laticauda.models.simulate.loads_of_many import TrialLoads as TrialLoads
    from laticauda.models.simulate.many import Swims as Swims, swim_many as swim_many
    from laticauda.models.simulate.numbers import (
        Parameter as Parameter,
        list_parameters as list_parameters,
        UNITS as UNITS,
        change_parameters as change_parameters,
        check_whole as check_whole,
        described as described,
        environment_prefix as environment_prefix,
        look_up as look_up,
        of_figure as of_figure,
        suggest_names as suggest_names,
        value_of as value_of,
    )
    from laticauda.models.simulate.plants import (
        needs_compiling as needs_compiling,
        build_plant as build_plant,
        plant_of_scenario as plant_of_scenario,
        school_of as school_of,
    )
    from laticauda.models.simulate.runner import (
        resume as resume,
        run as run,
        swim as swim,
        Progress as Progress,
        Until as Until,
        run_scenario as run_scenario,
        silent as silent,
    )
    from laticauda.models.simulate.several import swim_together as swim_together
    from laticauda.models.simulate.batch_figures import (
        Block as Block,
        Run as Run,
        joint_peaks as joint_peaks,
    )
    from laticauda.models.simulate.batch_run import run_batch as run_batch
    from laticauda.models.simulate.cluster import connected as connected
    from laticauda.models.simulate.batch_scenarios import runs_of as runs_of
    from laticauda.models.simulate.joint_use import run_joint_shares as run_joint_shares
    from laticauda.models.simulate.steered_trials import (
        HasArrived as HasArrived,
        swim_side_by_side as swim_side_by_side,
    )
    from laticauda.models.simulate.run_table import (
        RunTable as RunTable,
        make_run_table as make_run_table,
        scenarios_at as scenarios_at,
    )
    from laticauda.models.simulate.table_run import run_columns as run_columns

__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {
        "laticauda.models.simulate.certainty": [
            "intervals_of",
            "figure_intervals",
            "widen_by_textbook_error",
        ],
        "laticauda.models.simulate.sensitivity": ["Sensitivities", "compute_sensitivities"],
        "laticauda.models.simulate.loads_of_many": ["TrialLoads"],
        "laticauda.models.simulate.many": ["Swims", "swim_many"],
        "laticauda.models.simulate.numbers": ["Parameter", "list_parameters"],
        "laticauda.models.simulate.plants": ["needs_compiling", "build_plant"],
        "laticauda.models.simulate.runner": ["resume", "run", "swim"],
        "laticauda.models.simulate.several": ["swim_together"],
    },
    plain={
        "laticauda.models.simulate.batch_figures": ["Block", "Run", "joint_peaks"],
        "laticauda.models.simulate.batch_run": ["run_batch"],
        "laticauda.models.simulate.cluster": ["connected"],
        "laticauda.models.simulate.batch_scenarios": ["runs_of"],
        "laticauda.models.simulate.joint_use": ["run_joint_shares"],
        "laticauda.models.simulate.steered_trials": ["HasArrived", "swim_side_by_side"],
        "laticauda.models.simulate.run_table": ["RunTable", "make_run_table", "scenarios_at"],
        "laticauda.models.simulate.table_run": ["run_columns"],
        "laticauda.models.simulate.numbers": [
            "UNITS",
            "change_parameters",
            "check_whole",
            "described",
            "environment_prefix",
            "look_up",
            "of_figure",
            "suggest_names",
            "value_of",
        ],
        "laticauda.models.simulate.plants": ["plant_of_scenario", "school_of"],
        "laticauda.models.simulate.runner": ["Progress", "Until", "run_scenario", "silent"],
    },
    renamed={
        "parameters": "list_parameters",
        "plant": "build_plant",
        "sensitivities": "compute_sensitivities",
        "spread": "figure_intervals",
        "stated": "widen_by_textbook_error",
    },
)
