"""All variables of an exported robot, in the order in which they are numbered."""

import laticauda as lc
from laticauda.connect.native.body_parameters import (
    list_joint_parameters,
    list_module_parameters,
)
from laticauda.connect.native.outputs import list_outputs
from laticauda.connect.native.settable import (
    list_current_variables,
    list_fin_parameters,
    list_gait_variables,
    list_reference_inputs,
    list_start_parameters,
    list_step_parameters,
    list_water_parameters,
)
from laticauda.connect.native.variable import Variable
from laticauda.models.planar import PlanarPlant


def list_variables(
    plant: PlanarPlant,
    gait: lc.Gait,
    start: lc.Start,
    *,
    inputs: str,
    has_body_parameters: bool = False,
) -> tuple[Variable, ...]:
    """Return all variables, in the order of their value references.

    Args:
        plant: Plant in water.
        gait: Gait that the joints follow unless the inputs say otherwise.
        start: Initial state.
        inputs: Inputs that drive the robot: gait or references.
        has_body_parameters: Whether numbers of modules and joints are parameters.
    """
    water = plant.environment
    assert isinstance(water, lc.Water)
    time = Variable(name="time", causality="independent", unit="s", symbol="t", description="Time.")
    variables = [
        time,
        *list_step_parameters(plant),
        *list_start_parameters(plant, start),
        *list_water_parameters(plant, water),
        *list_fin_parameters(plant),
    ]
    if has_body_parameters:
        variables.extend(list_module_parameters(plant))
        variables.extend(list_joint_parameters(plant))
    if inputs == "gait":
        variables.extend(list_gait_variables(plant, gait))
    else:
        variables.extend(list_reference_inputs(plant))
    variables.extend(list_current_variables(plant, water))
    variables.extend(list_outputs(plant))
    return tuple(variables)
