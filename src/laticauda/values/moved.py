"""Import paths of 0.2, which lead to the modules of today until the next release, with a warning.

The packages of 0.2 stand in sixteen rooms now. Who imports `laticauda.fluid` gets
`laticauda.water.fluid`, the same module, and a `DeprecationWarning` that says so.
"""

from typing import Any, cast

from laticauda.values import errors
from laticauda.values.packaging import moved_modules, renamed_names

PLACES = {
    "access": "values.access",
    "actuation": "motion.joints",
    "angles": "values.angles",
    "arguments": "values.arguments",
    "cockpit": "show.cockpit",
    "codec": "values.codec",
    "control.predictive": "control.mpc.predictive",
    "cosim": "connect",
    "dynamics": "models.dynamics",
    "errors": "values.errors",
    "estimation": "control.estimation",
    "extensions": "values.extensions",
    "figures": "show.figures",
    "files": "values.files",
    "fluid": "water.fluid",
    "formulas": "values.formulas",
    "gaits": "motion.gaits",
    "hydrodynamics": "robot.hydrodynamics",
    "interfaces": "scenarios.interfaces",
    "kinematics": "robot.kinematics",
    "lab": "tank.lab",
    "logs": "trials.logs",
    "mujoco_water": "water.mujoco",
    "operate": "tank.operate",
    "packaging": "values.packaging",
    "pictures": "show.pictures",
    "planar": "models.planar",
    "protocol": "tank.protocol",
    "quantities": "values.quantities",
    "reports": "show.reports",
    "scalars": "values.scalars",
    "series": "values.series",
    "simulate": "models.simulate",
    "spatial": "models.spatial",
    "trial": "trials",
}
"""Where the packages and modules of 0.2 are now, both without `laticauda.`; what was inside moved with them."""
RENAMED_INSIDE = {"operate.course": "tank.operate.procedure"}
"""Packages inside moved ones that have another name now, likewise."""
FORMER_PACKAGES = {old: f"laticauda.{new}:" for old, new in PLACES.items() if "." not in old}
"""Those that were attributes of laticauda, `lc.logs`, for `packaging.renamed_names`."""
NOT_ERRORS = {
    "at_least_one": "checks:check_not_empty",
    "deaf": "interrupts:defer_interrupts",
    "finite": "checks:check_finite",
    "flag": "checks:check_flag",
    "hostname": "checks:check_hostname",
    "instance": "checks:check_instance",
    "label": "checks:check_label",
    "load_mujoco": "optional:load_mujoco",
    "nearest": "checks:suggest_nearest",
    "not_negative": "checks:check_not_negative",
    "one_of": "checks:check_choice",
    "optional_import": "optional:optional_import",
    "positive": "checks:check_positive",
    "shown": "checks:show_value",
    "text": "checks:check_text",
    "whole": "checks:check_whole_number",
    "within": "checks:check_within",
}
"""Names of 0.2 in `laticauda.errors` that are no errors, and where they are now in `laticauda.values`."""


def accept_former_paths() -> None:
    """Let modules be imported by their names of 0.2, too."""
    moved_modules(
        {f"laticauda.{old}": f"laticauda.{new}" for old, new in (PLACES | RENAMED_INSIDE).items()}
    )
    elsewhere = {old: f"laticauda.values.{new}" for old, new in NOT_ERRORS.items()}
    cast(Any, errors).__getattr__ = renamed_names(errors.__name__, elsewhere)
