"""Identify physical parameters and their uncertainty from measured trials (`fit`).

Needs the extra `identify`. `fit` takes measurements through these steps, in this order:

    1. A trial, a tow or a row of a table becomes a `Measurement`: a scenario, and what was measured
       of it with its noise (`conversion`, `tables`). `tasks` reads all of it from a file.
    2. The numbers to identify are found in these scenarios (`resolving`). With the measurements,
       they are a `Problem`: all measured numbers stand in one array, the data, and `depends_on`
       says which measurement depends on which unknown.
    3. At given values of the unknowns, every scenario is simulated, and what its sensors would show
       is a prediction of the data; derivatives come with it (`model`).
    4. Predicted minus measured, over the noise, are the residuals. A search makes their sum of
       squares least (`local_search`), from several starts (`fitting`).
    5. There, J^T J with the Jacobian J of the residuals is the information. Its inverse is the
       covariance, which gives intervals; its eigenvectors show what the data do not see
       (`identifiability`). `noise_factor` corrects the size of the stated noise, and
       `correlated_noise` the assumption that its samples are independent (`estimates`).
    6. The result is a `Fit`. `profiles`, `posterior_sample`, `leaving_out` and `validation` check
       it, and `exporting` puts its values into robots, waters and parameter files.

A new kind of measured number belongs to step 1 (`series`) and 3 (`sensing`), a new kind of trial to
3 (a module beside `tow_runs`), and a new remark on a result to 5 (`fit_warnings`). `design` and
`discrimination` run steps 2, 3 and 5 for trials that nobody has done yet.

A search does not move the values q themselves but coordinates x: ln q for a number that is always
positive, so that its steps and errors are relative, and q for all others. The size of an unknown is
a large change of its x, for comparing unknowns of different units (see `unknowns`).

Words that have one meaning in all modules:

    sigma      of a measured number: the standard deviation of its noise, one for a series or one
               for each sample (`Measurement`, `Problem.sigma`); of an estimate: that of the value
    deviation  a standard deviation of a coordinate, in sizes: relative, for a number on a log scale
    prior      what was known of an unknown beforehand: more residuals, which are never left out.
               By what share data and not priors determine all unknowns is asked by `noise_factor`,
               whether a value is hardly better known than by its prior by `is_known_from_prior`
    loss       weighs residuals of data and priors alike (`method`)

Numbers that are not numbers:

    inf        a deviation, or a covariance, of what nothing determines
    nan        a prediction: the run diverged or does not yield the figure, or the other data do not
               determine it (`leaving_out`). A correlation: one of both is not identified. A noise
               factor: there are no degrees of freedom.
    0          an eigenvalue of information: rounding, nothing is seen along it. The rows of a
               candidate's number that its run does not yield: no information (`trial_information`).

What was measured:

    measurements     a trial with its figures, series and their noise
    series           kinds of time series: one row of a table each
    towing           tows of a straight robot, and their loads
    conversion       trials and tows as measurements
    tables           rows of tables of speeds as measurements
    selection_bias   bias of numbers published as the best of several

What is unknown:

    unknowns         numbers to identify, with ranges and priors
    resolving        finds them in the measurements, and fills in what was left open
    dependence       which measurements depend on which unknowns
    problem          measurements and unknowns together

How the measurements are predicted:

    model            predictions and their derivatives
    planar_runs, spatial_runs, tow_runs   the three ways to compute them
    runs             their results, for all measurements
    sensing          what sensors show of a run
    interpolation    logs at the times of a measurement

How the unknowns are found:

    fitting            `fit`: searches from several starts
    starts             where searches begin, and when there are enough of them
    local_search       one search
    method             settings of a fit, and losses

How well they are known:

    noise_factor       ratio of the residuals to the stated noise
    correlated_noise   noise correlated in time, which widens intervals
    identifiability    what the data see
    combinations       combinations of unknowns in words
    estimates          from the end of a search to a result
    fit_warnings       what is unusual about it
    chi2               how large the sum of squares usually is
    doubt              whether the model, not the noise, is in doubt
    rival_laws         other laws of the water that are tried
    rival_search       their searches, which end early
    result             `Fit`: the result

How a result is checked, and used:

    profiles           intervals from profile likelihoods
    posterior_sample   a sample of the posterior
    leaving_out        predictions of data that a fit did not see
    validation         all of these, and models without physics
    exporting          identified values in robots, waters and parameter files

How a gait that was not measured is predicted:

    prediction         speed, power and path of a gait with one interval
    prediction_basis   what a fit leaves behind for that, in its files
    held_fixed         numbers held fixed, and how the fitted ones follow them
    model_error        what the model leaves out

What is done from files and on a day at the tank:

    tasks              measurements, unknowns and method, from a file or not
    trial_files        files of trials and tables in a task
    tank_day           two hours of trials, from an empty folder to the water's law

Which trials to do next:

    candidates         possible next trials
    trial_information  what trials would say
    selection          which trials to choose
    design             the trials that reduce the uncertainty most
    discrimination     the trials that tell rival models apart
    reasons            designs in words
"""

from typing import TYPE_CHECKING

from laticauda.values import lazy_exports

if TYPE_CHECKING:
    from laticauda.identify.conversion import from_trial as from_trial, from_tow as from_tow
    from laticauda.identify.fitting import fit as fit
    from laticauda.identify.leaving_out import (
        leave_out as leave_out,
        linear_leave_one_out as linear_leave_one_out,
    )
    from laticauda.identify.measurements import Measurement as Measurement
    from laticauda.identify.posterior_sample import sample_posterior as sample_posterior
    from laticauda.identify.profiles import profile_interval as profile_interval
    from laticauda.identify.prediction import (
        Prediction as Prediction,
        predict_scenario as predict_scenario,
        PredictedFigure as PredictedFigure,
        PredictedPath as PredictedPath,
        Shares as Shares,
    )
    from laticauda.identify.prediction_basis import (
        PredictionBasis as PredictionBasis,
        basis_of as basis_of,
        load_basis as load_basis,
        KEY_OF_BASIS as KEY_OF_BASIS,
        with_checksum as with_checksum,
        SCENARIO_FILE as SCENARIO_FILE,
        first_scenario as first_scenario,
        list_assumptions as list_assumptions,
    )
    from laticauda.identify.result import Fit as Fit, ParameterEstimate as ParameterEstimate
    from laticauda.identify.tables import from_table as from_table, from_table1 as from_table1
    from laticauda.identify.tasks import compare_laws as compare_laws, Task as Task
    from laticauda.identify.trial_files import TrialFile as TrialFile
    from laticauda.identify.unknowns import Unknown as Unknown, ResolvedUnknown as ResolvedUnknown
    from laticauda.identify.validation import (
        compared_with_null_models as compared_with_null_models,
        Validation as Validation,
    )
    from laticauda.identify.candidates import (
        SENSORS as SENSORS,
        coast_down as coast_down,
        swim_candidates as swim_candidates,
    )
    from laticauda.identify.design import (
        Design as Design,
        Judged as Judged,
        design_experiment as design_experiment,
    )
    from laticauda.identify.discrimination import (
        Discrimination as Discrimination,
        Rival as Rival,
        discriminate as discriminate,
        misidentification_probability as misidentification_probability,
    )
    from laticauda.identify.identifiability import LIMIT as LIMIT, marginal as marginal
    from laticauda.identify.trial_information import known_from as known_from
    from laticauda.identify.problem import Problem as Problem, make_problem as make_problem
    from laticauda.identify.reasons import format_share as format_share
    from laticauda.identify.series import SERIES as SERIES
    from laticauda.identify.towing import Tow as Tow

__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {
        "laticauda.identify.conversion": ["from_trial"],
        "laticauda.identify.fitting": ["fit"],
        "laticauda.identify.leaving_out": ["leave_out", "linear_leave_one_out"],
        "laticauda.identify.measurements": ["Measurement"],
        "laticauda.identify.posterior_sample": ["sample_posterior"],
        "laticauda.identify.profiles": ["profile_interval"],
        "laticauda.identify.prediction": ["Prediction", "predict_scenario"],
        "laticauda.identify.prediction_basis": ["PredictionBasis", "basis_of", "load_basis"],
        "laticauda.identify.result": ["Fit", "ParameterEstimate"],
        "laticauda.identify.tables": ["from_table", "from_table1"],
        "laticauda.identify.tasks": ["compare_laws"],
        "laticauda.identify.trial_files": ["TrialFile"],
        "laticauda.identify.unknowns": ["Unknown"],
        "laticauda.identify.validation": ["compared_with_null_models"],
    },
    plain={
        "laticauda.identify.candidates": ["SENSORS", "coast_down", "swim_candidates"],
        "laticauda.identify.conversion": ["from_tow"],
        "laticauda.identify.design": ["Design", "Judged", "design_experiment"],
        "laticauda.identify.discrimination": [
            "Discrimination",
            "Rival",
            "discriminate",
            "misidentification_probability",
        ],
        "laticauda.identify.identifiability": ["LIMIT", "marginal"],
        "laticauda.identify.trial_information": ["known_from"],
        "laticauda.identify.prediction": ["PredictedFigure", "PredictedPath", "Shares"],
        "laticauda.identify.prediction_basis": [
            "KEY_OF_BASIS",
            "with_checksum",
            "SCENARIO_FILE",
            "first_scenario",
            "list_assumptions",
        ],
        "laticauda.identify.problem": ["Problem", "make_problem"],
        "laticauda.identify.reasons": ["format_share"],
        "laticauda.identify.series": ["SERIES"],
        "laticauda.identify.tasks": ["Task"],
        "laticauda.identify.towing": ["Tow"],
        "laticauda.identify.validation": ["Validation"],
        "laticauda.identify.unknowns": ["ResolvedUnknown"],
    },
    renamed={"posterior": "sample_posterior", "profile": "profile_interval"},
)
