"""Names of all numbers of a planar run: their places in the one flat array that the kernels work on.

The array is a list of *rows*; a row holds one number per lane, one lane per trial, and ``S[q]`` is
row `q` of all lanes (see `lanes`). First come the header rows, then one record of ``BODY_ROWS``
rows per body (tail first), then one record of ``STRIP_ROWS`` rows per fin strip and one of
``PLATE_ROWS`` rows per pectoral fin, then the numbers of a flow and of a recording, if any.

Rows are handed out in the order of the lines below: a new line moves all rows after it, and needs
no other change here. Names of the header are rows of the array. Names of a record are counted from
the record's begin: with `b` the first row of a body, its rate is ``S[b + RATE]``.
"""

from laticauda.models.dynamics.semi_implicit import N_STAGES
from laticauda.motion.gaits import WaveState
from laticauda.motion.joints import (
    FIRST_FREE as FIRST_FREE,
    JOINT,
    LOCKED as LOCKED,
    PASSIVE as PASSIVE,
    PRESCRIBED as PRESCRIBED,
    Drive,
)
from laticauda.values import MOST_NUMBERS
from laticauda.water.fluid.edges import Plate


class _Counter:
    """Hands out rows, one after the other.

    Args:
        first: The first of them.
    """

    def __init__(self, first: int = 0) -> None:
        self.n = first
        """Number of rows up to here, which is also the next row."""

    def take(self, count: int = 1) -> int:
        """Return the next row, or the first one of the next `count` rows."""
        row = self.n
        self.n += count
        return row


N_FREEDOMS = 3
"""Degrees of freedom of the base: heading, x and y of the center of mass."""
BASE_ROWS = 2 * N_FREEDOMS + 1
"""Rows of the base's state, HEADING to EDGE_MEMORY: the degrees of freedom, their rates, the state of an edge."""
MOST_STAGES = 6
"""Stages whose slopes a step can keep: the room in SLOPES, which a method need not fill."""
JOINT_STAGES = N_STAGES
"""Stages of steps with free joints, whose slopes joints keep."""

# --- Motion of the water at a point; only if the water has a flow -----------------------------------
_water = _Counter()
CURRENT_T = _water.take()  # velocity of the water there, link axes [m/s]
CURRENT_N = _water.take()
CURRENT_T_RATE = _water.take()  # its material acceleration [m/s^2]
CURRENT_N_RATE = _water.take()
CURRENT_SPIN = _water.take()  # its rotation [rad/s]
WATER_ROWS = _water.n

# --- Element: the part of a body, or the strip of a fin, that a drag law acts on ----------------------
_element = _Counter()
POSITION_OF = _element.take()  # position of its loads from the tail end of its body [m]
C_T_OF = _element.take()
C_N_OF = _element.take()
LAMBDA_2_OF = _element.take()
LAMBDA_3_OF = _element.take()
# its own added mass; this and the following only if the water has a flow [kg]
MU_T_OF = _element.take()
MU_N_OF = _element.take()
DISPLACED_OF = _element.take()  # mass of the displaced water [kg]
WATER_OF = _element.take(WATER_ROWS)
ELEMENT_ROWS = _element.n

# --- Header: parameters, which the environment or a command sets --------------------------------------
_header = _Counter()
CURRENT_X = _header.take()  # V_x [m/s]
CURRENT_Y = _header.take()  # V_y [m/s]
# 1: added-mass velocity terms use v - V (relative, kirchhoff); 0: only -V (classic)
OWN_VELOCITY = _header.take()
KIRCHHOFF = _header.take()  # 1: momentum-conserving terms and Munk moment on; 0: off
WAKE_MASS = _header.take()  # m' of the trailing edge [kg/m]; 0: off
# x of the trailing edge from the tail end of body 0 [m], headward positive; of a finite span, x_w
WAKE_POSITION = _header.take()
# a plate of finite span at the tail instead of WAKE_MASS: the fields of `fluid.edges.Plate`
EDGE = _header.take(len(Plate._fields))
EDGE_LAG = EDGE + Plate._fields.index("lag")  # its l [m]; 0: none
ACTIVE_POWER = _header.take()  # power of the electronics above idle [W]
TETHER_DRAG = _header.take()  # k [kg/m]
TETHER_FORCE_X = _header.take()  # [N]
TETHER_FORCE_Y = _header.take()  # [N]
# the commanded gait: the first four are the target of the wave of the body's joints
AMPLITUDE = _header.take()  # alpha [rad]
FREQUENCY = _header.take()  # omega [rad/s]
PHASE_SHIFT = _header.take()  # delta [rad]
OFFSET = _header.take()  # phi_0 [rad]
FIN_AMPLITUDE = _header.take()  # of a driven fin [rad]
FIN_FREQUENCY = _header.take()  # [rad/s]
FIN_OFFSET = _header.take()  # [rad]
FIN_LEAD = _header.take()  # phase lead over the integral of its frequency [rad]; not filtered
BANDWIDTH = _header.take()  # of the filters on all of these except the last [rad/s]
RAMP = _header.take()  # T of the smooth start [s]; 0: none
# row where a recording of the body's joints begins, after all records; 0: no recording
KNOTS = _header.take()
# number of its knots, each with the time, then angle and rate of every joint
N_KNOTS = _header.take()
# row where the numbers of the water's flow begin (`fluid.flow.rows_of`), if it has one
FLOW = _header.take()
# 1: the first sample is in a log already, as the last one of the run before; `stepping.run` sets it back
RESUMES = _header.take()
HEIGHT = _header.take()  # height of the body's axis above the mean surface, for the flow [m]

STILL_WATER = ((CURRENT_X, 0.0), (CURRENT_Y, 0.0), (OWN_VELOCITY, 1.0), (KIRCHHOFF, 0.0))
"""Rows and their values in still water, with the relative form of the added mass."""

# --- Header: state, which a step carries on; these rows begin every sample of the log, in this order ---
TIME = _header.take()  # [s]
TIME_REST = _header.take()  # accumulated rounding error of TIME (Kahan summation) [s]
HEADING = _header.take()  # mean angle of the body's links [rad]
X = _header.take()  # center of mass [m]
Y = _header.take()
HEADING_RATE = _header.take()  # [rad/s]
VX = _header.take()  # velocity of the center of mass [m/s]
VY = _header.take()
EDGE_MEMORY = _header.take()  # z, the speed across that the wake of a finite span remembers [m/s]
# wave of the body's joints: the fields of WaveState, its phase first
PHASE = _header.take(len(WaveState._fields))
AMPLITUDE_NOW = PHASE + WaveState._fields.index("amplitude")
FREQUENCY_NOW = PHASE + WaveState._fields.index("frequency")
PHASE_SHIFT_NOW = PHASE + WaveState._fields.index("phase_shift")
OFFSET_NOW = PHASE + WaveState._fields.index("offset")
OFFSET_RATE = PHASE + WaveState._fields.index("offset_rate")
FIN_WAVE = tuple(name for name in WaveState._fields if not name.startswith("phase_shift"))
# the same for a driven fin, which has one joint and no phase shift: the fields FIN_WAVE
FIN_PHASE = _header.take(len(FIN_WAVE))
FIN_AMPLITUDE_NOW = FIN_PHASE + FIN_WAVE.index("amplitude")
FIN_FREQUENCY_NOW = FIN_PHASE + FIN_WAVE.index("frequency")
FIN_OFFSET_NOW = FIN_PHASE + FIN_WAVE.index("offset")
FIN_OFFSET_RATE = FIN_PHASE + FIN_WAVE.index("offset_rate")
WAVE_ROWS = _header.n - PHASE
"""Rows of the state of both waves."""
WORK_ABSOLUTE = _header.take()  # integral of sum |u phi'| [J]
WORK_NET = _header.take()  # integral of sum u phi' [J]
WORK_POSITIVE = _header.take()  # integral of sum max(u phi', 0) [J]
WORK_ELECTRICAL = _header.take()  # integral of the supply power above idle [J]
LOG_STATE = _header.n - TIME
"""Number of these rows."""
N_WORKS = WORK_ELECTRICAL + 1 - WORK_ABSOLUTE
"""Kinds of work, each with a power."""

# --- Header: scratch, which every stage of a step computes anew ----------------------------------------
HEADING_ACCELERATION = _header.take()
AX = _header.take()
AY = _header.take()
POWER_ABSOLUTE = _header.take()  # powers when work was counted last, in the order of the works [W]
POWER_NET = _header.take()
POWER_POSITIVE = _header.take()
POWER_ELECTRICAL = _header.take()
SIN_PHASE = _header.take()
COS_PHASE = _header.take()
SIN_SHIFT = _header.take()
COS_SHIFT = _header.take()
# 1 if the water is still and the form the relative one, see `STILL_WATER`
IS_STILL = _header.take()
# 1 if the references of all joints stand still as long as the command is held
RESTS = _header.take()
KNOT = _header.take()  # last knot of the recording before the current time
DECAY = _header.take()  # decay of the generator's filters over one of its steps
STAGE_DECAYS = _header.take(JOINT_STAGES)  # the same from the begin of a step to its stages
SAVED_TIME = _header.take(2)  # TIME and TIME_REST at the start of a step
SAVED_WAVES = _header.take(WAVE_ROWS)  # the rows from PHASE on at the start of a step
WELL = _header.take()  # 1 until the lane's numbers leave the finite range, then 0
SAMPLES = _header.take()  # number of samples logged until then
SAVED = _header.take(BASE_ROWS)  # the base's state at the start of a step
SLOPES = _header.take(MOST_STAGES * BASE_ROWS)  # slopes of the base's state in each stage
EDGE_MEMORY_RATE = _header.take()  # dz/dt [m/s^2]
# the shape, see `prescribed`: how heading, center of mass and inertia follow from body 0, in its axes
TURN = _header.take()  # mean angle of the links from body 0 [rad]
TURN_RATE = _header.take()  # its rate [rad/s]
TURN_ACCELERATION = _header.take()  # the rate of that [rad/s^2]
MEAN_X = _header.take()  # center of mass from the tail end of body 0 [m]
MEAN_Y = _header.take()
MEAN_VX = _header.take()  # its rate while body 0 is held [m/s]
MEAN_VY = _header.take()
MEAN_AX = _header.take()  # the rate of that [m/s^2]
MEAN_AY = _header.take()
# inertia of the stiff robot about that tail end, added mass included: 00, 01, 02, 11, 12, 22
STIFF_INERTIA = _header.take(6)
TETHER_WATER = _header.take(WATER_ROWS)  # motion of the water at the tether
WAKE_WATER = _header.take(WATER_ROWS)  # motion of the water at the trailing edge

# --- Header: numbers of laws ------------------------------------------------------------------------
LAW = _header.take(MOST_NUMBERS)  # those of the drag law, in the order of its fields
JOINT_LAW = _header.take(MOST_NUMBERS)  # those of the joint law, if it is user-defined
HEADER_ROWS = _header.n

# --- One record per body, beginning with the joint at the body's tail end ------------------------------
# Its first rows are the numbers of a joint of either model, in the order of `motion.joints.laws.JOINT`
# (`dynamics.joint_table` fills them): angle per amplitude of the gait, torque of the skin per angle and
# per rate, then the fields of `laws.Drive`; those from MOTOR to STALL_POWER are what `laws.motor_power`
# takes; LEAD is the phase of the joint ahead of the wave.
# From there come also the codes of joint laws, LOCKED and so on: kernels take both from here.
ENVELOPE, STIFFNESS, DAMPING, DRIVE, MOTOR, STALL_POWER, LEAD, JOINT_ROWS = JOINT
SERVO_GAIN = DRIVE + Drive._fields.index("servo_gain")
NO_LOAD_SPEED = DRIVE + Drive._fields.index("no_load_speed")
_body = _Counter(JOINT_ROWS)
# parameters: `layout` writes those from LENGTH to CENTER in this order
LENGTH = _body.take()  # 2l [m]
INERTIA = _body.take()  # I00, rigid plus added, about the tail end [kg m^2]
COUPLING = _body.take()  # m c + sum mu_n x [kg m]
CENTRIPETAL = _body.take()  # m c (+ sum mu_t x in the classic form) [kg m]
MASS_T = _body.take()  # m + sum mu_t [kg]
MASS_N = _body.take()  # m + sum mu_n [kg]
MU_T = _body.take()  # sum mu_t [kg]
MU_N = _body.take()  # sum mu_n [kg]
MOMENT_T = _body.take()  # sum mu_t x [kg m]
MOMENT_N = _body.take()  # sum mu_n x [kg m]
MASS_SHARE = _body.take()  # m / m_t
FIRST_MOMENT_SHARE = _body.take()  # m c / m_t [m]
# the body's own element, its position from the tail end first [m]
CENTER = _body.take(ELEMENT_ROWS)
C_T = CENTER + C_T_OF
DISPLACED = CENTER + DISPLACED_OF
WATER_T = CENTER + WATER_OF  # motion of the water there
THRUST_T = _body.take()  # thrusters, in link axes [N]
THRUST_N = _body.take()
THRUST_MOMENT = _body.take()  # about the tail end [N m]
HEADING_SHARE = _body.take()  # share of the body's links on the head side of the joint
# state; a new number here: see `STATE_OF_JOINT`
ANGLE = _body.take()  # phi
RATE = _body.take()  # phi'
# scratch
REFERENCE = _body.take()  # phi_ref and its derivatives
REFERENCE_1 = _body.take()
REFERENCE_2 = _body.take()
ACCELERATION = _body.take()  # phi''
TORQUE = _body.take()  # u: what the actuator delivers [N m]
# free joint: actuator, skin and implicit terms; prescribed joint: the required torque
TOTAL_TORQUE = _body.take()
IMPLICIT = _body.take()  # what an implicit step adds to the inertia about the joint [kg m^2]
COS = _body.take()
SIN = _body.take()
LINK_RATE = _body.take()  # theta'
UX = _body.take()  # velocity of the tail end of this body relative to that of body 0
UY = _body.take()
PX = _body.take()  # world position of its tail end; only if the water has a flow
PY = _body.take()
# velocity of its tail end relative to the water, link axes; over ground if the water has a flow
V_T = _body.take()
V_N = _body.take()
# loads in addition to the body's own drag, link axes, moment about the tail end
EXTRA_T = _body.take()
EXTRA_N = _body.take()
EXTRA_MOMENT = _body.take()
# rotation row of the articulated inertia about the joint, world axes (rotation, x, y)
A00 = _body.take()
A01 = _body.take()
A02 = _body.take()
P0 = _body.take()  # bias force
P1 = _body.take()
P2 = _body.take()
SWING = _body.take()  # free joints: phi'' if the body behind did not accelerate
# reduction of phi'' per acceleration of the body behind: rotation, then its tail end
GIVE = _body.take()
GIVE_X = _body.take()
GIVE_Y = _body.take()
LINK_ACCELERATION = _body.take()  # theta''
QX = _body.take()  # acceleration of the tail end of this body
QY = _body.take()
# the shape, see `prescribed`: where all joints are prescribed, it depends on the time alone
JOINT_COS = _body.take()  # of phi; 1 and 0 at body 0, which has no joint
JOINT_SIN = _body.take()
SHAPE_COS = _body.take()  # of the angle from body 0 to this body
SHAPE_SIN = _body.take()
ARM_T = _body.take()  # from the tail end of body 0 to that of this body, link axes [m]
ARM_N = _body.take()
# share of this body's direction in the way from the tail end of body 0 to the center of mass [m]
MEAN_ARM = _body.take()
# free joints: state at the start of a step, and slopes of the stages, see `driven`
SAVED_ANGLE = _body.take()
SAVED_RATE = _body.take()
STAGE_RATES = _body.take(JOINT_STAGES)
STAGE_ACCELERATIONS = _body.take(JOINT_STAGES)
COAST_ANGLE = _body.take()  # implicit state of the stage if the joint did not accelerate
COAST_RATE = _body.take()
GUESS = _body.take()  # acceleration at which the tangent touches the law
GUESS_TORQUE = _body.take()  # torque of the law there, less that of the skin [N m]
if _body.n % 2 == 0:
    # An even number of cache lines would put the same row of all bodies into few sets of the cache.
    _body.take()
BODY_ROWS = _body.n

# --- One record per fin strip, which is an element ------------------------------------------------------
STRIP_ROWS = ELEMENT_ROWS

# --- One record per pectoral fin ------------------------------------------------------------------------
_plate = _Counter()
PLATE_X = _plate.take()  # its position from the tail end of its body [m]
PLATE_Y = _plate.take()
PLATE_ANGLE = _plate.take()
PLATE_LAW = _plate.take(5)  # the numbers of fluid.laws.plate that follow the velocities
PLATE_WATER = _plate.take(WATER_ROWS)  # motion of the water there
PLATE_ROWS = _plate.n

# --- The log ---------------------------------------------------------------------------------------------
STATE_OF_JOINT = (ANGLE, RATE)
"""Rows of a body that are the state of its joint."""
LOGGED_OF_JOINT = (*STATE_OF_JOINT, REFERENCE, TORQUE)
"""Rows of a body that are logged, in the order of a sample (`sample_format`); the state comes first."""
