"""Layout of the numbers that the compiled loads read: the table of one model, its water, and its elements."""

# pyright: reportUntypedNamedTuple=false
from collections import namedtuple
from itertools import accumulate

from laticauda.values import MOST_NUMBERS
from laticauda.water.fluid.laws import MOTION, Element

# --- The table of one model: 64-bit integers ------------------------------------------------------
# It begins with the offsets of MuJoCo's fields [bytes]: in the data, as in all setups of kernels
# that read it, and in the model, where `o_friction` holds four numbers of our own: velocity of the
# water [m/s], or 0 and its flow's number.
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
(DENSITY, LEVEL, OWN_VELOCITY, KIRCHHOFF, TERRAIN, WATER_SIZE) = (*range(5), 8)

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
    "contact": 5,  # the fields of ground.Contact; those of ground.Terrain are 4 numbers of the water
    "own_mass": 1,  # of the body and what is fixed to it, per element on them
    "own_inertia": 1,  # the least, likewise
}
"""Fields of a record, and how many numbers each holds."""
PLACES = (*accumulate(RECORD.values(), initial=0),)
"""Start of each field in a record, then the end of them all."""
_start = dict(zip(RECORD, PLACES, strict=False))
POSITION = _start["position"]
ROTATION = _start["rotation"]
DRAG = _start["drag"]
TORQUE_LINEAR = _start["torque_linear"]
TORQUE_QUADRATIC = _start["torque_quadratic"]
MASS = _start["added_mass"]
INERTIA = _start["added_inertia"]
HALF = _start["half_size"]
THRUST = _start["thrust"]
PULL = _start["pull"]
VOLUME = _start["volume"]
TETHER_DRAG = _start["tether_drag"]
WAKE_MASS = _start["wake_mass"]
SHAPE = _start["shape"]
PLATE = _start["plate"]
CONTACT = _start["contact"]
OWN_MASS = _start["own_mass"]
OWN_INERTIA = _start["own_inertia"]
LAW_NUMBERS = PLACES[-1]
"""The record ends with the drag law's own numbers, in the order of its fields."""
ELEMENT_SIZE = LAW_NUMBERS + MOST_NUMBERS
OUT_SIZE = 13  # drag, added mass (its velocity part), buoyancy, effectors [N] in world axes, submerged share [-]

# --- Arguments of a drag law: velocities and the element's coefficients, followed by its loads
LOADS = MOTION + len(Element._fields)

MOST_FLOWS = 64
