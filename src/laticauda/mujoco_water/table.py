"""Layout of the numbers that the compiled loads read: the table of one model, its water, and its elements."""

# pyright: reportUntypedNamedTuple=false
import tomllib
from collections import namedtuple
from itertools import accumulate
from pathlib import Path

from laticauda.fluid.laws import MOTION, Element
from laticauda.formulas import MOST_NUMBERS

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

# --- One record of numbers per element: start of each field
RECORD: dict[str, int] = tomllib.loads(
    Path(__file__).with_suffix(".toml").read_text(encoding="utf-8")
)
PLACES = (*accumulate(RECORD.values(), initial=0),)
(POSITION, ROTATION, DRAG, TORQUE_LINEAR, TORQUE_QUADRATIC, MASS, INERTIA, HALF, THRUST) = PLACES[
    :9
]
(
    PULL,
    VOLUME,
    TETHER_DRAG,
    WAKE_MASS,
    SHAPE,
    PLATE,
    CONTACT,
    OWN_MASS,
    OWN_INERTIA,
    LAW_NUMBERS,
) = PLACES[9:]
ELEMENT_SIZE = LAW_NUMBERS + MOST_NUMBERS
# A record ends with the drag law's own numbers, in the order of its fields.
OUT_SIZE = 13  # drag, added mass (its velocity part), buoyancy, effectors [N] in world axes, submerged share [-]

# --- Arguments of a drag law: velocities and the element's coefficients, followed by its loads
LOADS = MOTION + len(Element._fields)

MOST_FLOWS = 64
