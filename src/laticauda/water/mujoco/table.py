"""Layout of the numbers that the compiled loads read: the table of one model, its water, and its elements."""

# pyright: reportUntypedNamedTuple=false
from collections import namedtuple
from itertools import accumulate

from laticauda.values import MOST_NUMBERS
from laticauda.water.fluid.edges import Plate
from laticauda.water.fluid.laws import MOTION, Element

# --- The table of one model: 64-bit integers ------------------------------------------------------
# It begins with the offsets of MuJoCo's fields [bytes]: in the data, as in all setups of kernels
# that read it, and in the model, where `o_friction` holds the motion of the water, see `currents`.
AT = namedtuple(
    "AT",
    "qpos qvel qacc xpos xmat xipos subtree_com cdof cdof_dot cvel crb M qfrc_passive qfrc_fluid time cacc cfrc_int "
    "cfrc_ext site_xpos site_xmat sensordata",
)(*range(21))
IN_MODEL = namedtuple("IN_MODEL", "gravity disableflags o_friction timestep dof_armature")(
    *range(21, 26)
)
(
    N_BODIES,
    N_DOFS,
    N_ELEMENTS,
    HAS_INERTIA,  # 1: M is rewritten
    IMPLICIT_DRAG,  # 1: the drag's secant slope, times the step, is added to the inertia
    HAS_SURFACE,
    FIRST_ORDER,  # 1: the integrator is of first order in the step
    # addresses
    PARENT,  # of each body
    FIRST_DOF,  # of each body, then the end
    ROOT,  # of each body
    DOF_BODY,
    DOF_PARENT,
    ROW_END,  # of each row of M: index of its diagonal element
    ROW_LENGTH,
    ELEMENT_BODY,
    ELEMENTS,  # records of numbers, see below
    WATER,  # numbers: see below
    LAWS,  # of each element: its law, a cfunc of two addresses; see law_entry
    FLOWS,  # of the last MOST_FLOWS flows: number, cfunc of two addresses (law_entry), address of its own numbers
    FLOW_LOST,  # message for a model whose flow is no longer among them
    HOLD,  # inertia and force to be added to each degree of freedom; 0: none
    OUT,  # loads per element; 0: not requested
    GRID,  # of the terrain, see ground.Terrain.nodes
    GRID_SIZE,  # number of values; 0: none
    SENSORS,  # of each force and torque sensor: index of its data, site, body, and 1 for force
    N_SENSORS,
    NO_GRAVITY,  # the bit of the model's flags that disables gravity
    TABLE_SIZE,
) = range(len(AT) + len(IN_MODEL), 54)

# --- Numbers of the water
DENSITY = 0
"""Density rho, for the buoyancy [kg/m^3]."""
LEVEL = 1
"""Mean height of the surface [m]."""
OWN_VELOCITY = 2
"""1 if the added mass's velocity terms contain the element's own velocity, 0 in the form `classic`."""
KIRCHHOFF = 3
"""1 for the complete velocity terms of the added mass."""
TERRAIN = 4
"""The four numbers of `ground.Terrain.profile`."""
WATER_SIZE = 8
"""Number of numbers of the water."""

# --- One record of numbers per element
RECORD = {
    "position": 3,  # in the body's frame
    "rotation": 9,  # from element axes to the body's, row by row
    "drag": 3,
    "torque_linear": 3,
    "torque_quadratic": 3,
    "added_mass": 3,
    "added_inertia": 3,
    "half_size": 3,
    "thrust": 3,
    "pull": 3,
    "volume": 1,
    "tether_drag": 1,
    "wake_mass": 1,
    "shape": 1,
    "plate": 5,  # as in fluid.laws.plate
    "heave_damping": 1,
    "tilt_damping": 3,
    "contact": 5,  # the fields of ground.Contact; those of ground.Terrain are 4 numbers of the water
    "edge": len(
        Plate._fields
    ),  # as in fluid.edges.Plate; only of robots, whose model advances the memory
    "edge_memory": 2,  # z, and dz/dt, which the loads set
    "own_mass": 1,  # of the body and what is fixed to it, per element on them
    "own_inertia": 1,  # the least, likewise
}
"""Fields of a record, and how many numbers each holds."""
PLACES = (*accumulate(RECORD.values(), initial=0),)
"""Start of each field in a record, then the end of them all."""
STARTS = dict(zip(RECORD, PLACES[:-1], strict=True))
"""Start of each field in a record."""
POSITION = STARTS["position"]
ROTATION = STARTS["rotation"]
DRAG = STARTS["drag"]
TORQUE_LINEAR = STARTS["torque_linear"]
TORQUE_QUADRATIC = STARTS["torque_quadratic"]
MASS = STARTS["added_mass"]
INERTIA = STARTS["added_inertia"]
HALF = STARTS["half_size"]
THRUST = STARTS["thrust"]
PULL = STARTS["pull"]
VOLUME = STARTS["volume"]
TETHER_DRAG = STARTS["tether_drag"]
WAKE_MASS = STARTS["wake_mass"]
SHAPE = STARTS["shape"]
PLATE = STARTS["plate"]
HEAVE_DAMPING = STARTS["heave_damping"]
TILT_DAMPING = STARTS["tilt_damping"]
CONTACT = STARTS["contact"]
EDGE = STARTS["edge"]
EDGE_LAG = EDGE + Plate._fields.index("lag")
"""The lag; 0: no edge of finite span."""
EDGE_MEMORY = STARTS["edge_memory"]
OWN_MASS = STARTS["own_mass"]
OWN_INERTIA = STARTS["own_inertia"]
LAW_NUMBERS = PLACES[-1]
"""The record ends with the drag law's own numbers, in the order of its fields."""
ELEMENT_SIZE = LAW_NUMBERS + MOST_NUMBERS
OUT_SIZE = 13
"""Loads of an element: drag, added mass (its velocity part), buoyancy, effectors [N] in world axes, wet share [-]."""

LOADS = MOTION + len(Element._fields)
"""Number of arguments of a drag law: velocities and the element's coefficients; its loads follow."""

MOST_FLOWS = 64
"""Number of flows that a water keeps."""
FLOW_COLUMNS = 3
"""Numbers per flow: its number, the address of its cfunc, and that of its own numbers."""
WORD = 8
"""Size of a 64-bit number [bytes]."""
