"""Where every number sits that the compiled loads read: the table of one model, its water, and its elements."""

from laticauda.fluid.laws import MOTION, Element
from laticauda.formulas import MOST_NUMBERS

# --- The table of one model: 64-bit integers -----------------------------------------------------------------------
(
    N_BODIES,
    N_DOFS,
    N_ELEMENTS,
    HAS_INERTIA,  # 1: M is written anew
    IMPLICIT_DRAG,  # 1: the drag's secant slope, times the step, is added to the inertia
    HAS_SURFACE,
    FIRST_ORDER,  # 1: the integrator is of first order in the step
    # addresses
    PARENT,  # of each body
    FIRST_DOF,  # of each body, and the end
    ROOT,  # of each body
    DOF_BODY,
    DOF_PARENT,
    ROW_END,  # of each row of M: place of its diagonal element
    ROW_LENGTH,
    ELEMENT_BODY,
    ELEMENTS,  # records of numbers, see below
    WATER,  # numbers: see below
    LAWS,  # of each element: its law, a cfunc of two addresses; see law_entry
    CURRENT,  # cfunc: x, y, z, t in, velocity, acceleration and rotation out behind them; 0: constant
    HOLD,  # inertia and force to be added to each degree of freedom; 0: none
    OUT,  # loads per element; 0: not wanted
    GRID,  # of the terrain, see ground.Terrain.nodes
    GRID_SIZE,  # how many numbers; 0: none
    SENSORS,  # of each force and torque sensor: place of its data, site, body, and 1 for force
    N_SENSORS,
    # offsets in the model
    AT_GRAVITY,
    AT_TIME_STEP,
    AT_ARMATURE,
    # offsets in the data
    AT_QVEL,
    AT_QACC,
    AT_XPOS,
    AT_XMAT,
    AT_SUBTREE_COM,
    AT_CDOF,
    AT_CDOF_DOT,
    AT_CVEL,
    AT_CRB,
    AT_M,
    AT_QFRC_PASSIVE,
    AT_QFRC_FLUID,
    AT_TIME,
    AT_CACC,
    AT_CFRC_INT,
    AT_SITE_XPOS,
    AT_SITE_XMAT,
    AT_SENSORDATA,
    TABLE_SIZE,
) = range(47)

# --- Numbers of the water
(DENSITY, LEVEL, V_X, V_Y, V_Z, OWN_VELOCITY, KIRCHHOFF, TERRAIN, WATER_SIZE) = (*range(8), 11)

# --- One record of numbers per element
POSITION = 0  # in the body's frame, 3
ROTATION = 3  # from element axes to the body's, 9, row by row
DRAG = 12  # 3
TORQUE_LINEAR = 15  # 3
TORQUE_QUADRATIC = 18  # 3
MASS = 21  # 3
INERTIA = 24  # 3
VOLUME = 27
SHAPE = 28
HALF = 29  # 3
THRUST = 32  # 3
PULL = 35  # 3
TETHER_DRAG = 38
WAKE_MASS = 39
PLATE = 40  # 5, as in fluid.laws.plate
CONTACT = 45  # 5, the fields of ground.Contact; those of ground.Terrain are 4 numbers of the water
OWN_MASS = 50  # of the body, per element on it
OWN_INERTIA = 51  # the least of the body's, likewise
LAW_NUMBERS = 52  # of the drag law, in the order of its fields
ELEMENT_SIZE = LAW_NUMBERS + MOST_NUMBERS
OUT_SIZE = 13  # drag, added mass (its velocity part), buoyancy, effectors [N] in world axes, share under water [-]

# --- What a drag law is called with: velocities, the element's coefficients, and behind them its loads
LOADS = MOTION + len(Element._fields)
