"""Layout of the kernels' arrays: state, command, setup, joints, and a sample of the log.

A state is one flat array: the rows below, then qpos, qvel, the link angles and, in a scene, the
contact forces on every link.
"""

from laticauda.motion.gaits import WaveState
from laticauda.motion.joints import JOINT, PASSIVE as PASSIVE, PRESCRIBED as PRESCRIBED
from laticauda.values import MOST_NUMBERS
from laticauda.water.mujoco import AT

# --- Rows of a state
TIME = 0
TIME_REST = 1
"""What rounding took from the time."""
PHASE = 2
"""Wave of the yaw joints: the fields of `gaits.reference.WaveState`, from its phase on."""
PHASE_SHIFT_NOW = PHASE + WaveState._fields.index("phase_shift")
OFFSET_NOW = PHASE + WaveState._fields.index("offset")
WORK_ABSOLUTE = PHASE + len(WaveState._fields)
"""Work of the joints, followed by the net, positive and electrical work."""
WORK_ELECTRICAL = WORK_ABSOLUTE + 3
PITCH = WORK_ABSOLUTE + 4
"""Wave of the pitch joints."""
FIN = PITCH + len(WaveState._fields)
"""Wave of a driven fin."""
EDGE_MEMORY = FIN + len(WaveState._fields)
"""z, the speed across that the wake of an edge of finite span remembers [m/s]."""
STATE_ROWS = EDGE_MEMORY + 1

SECOND = PITCH - PHASE
"""Rows from the wave of the yaw joints to that of the pitch joints."""
THIRD = FIN - PHASE
"""Rows from the wave of the yaw joints to that of a driven fin."""

# --- The command and the generator's settings
AMPLITUDE = 0
"""Target of the yaw joints' wave: the fields of `gaits.reference.WaveTarget`."""
AHEAD = 4
"""Last field of that target."""
PITCH_COMMAND = 5
"""Target of the pitch joints' wave."""
FIN_COMMAND = 10
"""Target of the wave of a driven fin."""
BANDWIDTH = 15
RAMP = 16
IS_LED = 17
"""Whether there is a command at all; without one, no reference moves the joints."""
ACTIVE_POWER = 18
"""Power of the electronics [W]."""
N_KNOTS = 19
"""Knots of a recording, 0: none. It is stored after all rows: time, then angle and rate of every yaw joint."""
KNOT = 20
"""Last knot before the current time."""
JOINT_LAW = 21
"""Parameters of a user-defined joint law."""
COMMAND_ROWS = JOINT_LAW + MOST_NUMBERS

# --- Integers that the kernels need, after the offsets of MuJoCo's data
MODEL = len(AT)
DATA = MODEL + 1
N_QPOS = MODEL + 2
N_QVEL = MODEL + 3
N_BASE_QPOS = MODEL + 4
"""Size of the root's qpos, which come before those of the joints."""
N_BASE_QVEL = MODEL + 5
N_LINKS = MODEL + 6
N_BODIES = MODEL + 7
IS_IMPLICIT = MODEL + 8
"""Whether any joint is free."""
IS_PLANAR = MODEL + 9
HAS_SCENE = MODEL + 10
"""Whether there is a scene: contact forces are then part of the state."""
N_FIN_BODIES = MODEL + 11
"""Bodies of the fin, whose contacts count toward the tail link."""
N_FLEXES = MODEL + 12
"""Flexes in the scene: MuJoCo does not count their contacts toward the bodies."""
CONTACTS = MODEL + 13
"""The fields of `native.ContactLayout`."""
GEOM_BODY = CONTACTS + 5
"""Address of the body of every geom, 32 bits each."""
EDGE_RECORD = GEOM_BODY + 1
"""Address of z and dz/dt in the record of the edge's element; 0 without an edge of finite span."""
SETUP_SIZE = EDGE_RECORD + 1

# --- Start of each robot's part in the arrays of all robots in one scene; a last row holds the ends
FIRST_STATE = 0
FIRST_COMMAND = 1
FIRST_JOINT = 2
FIRST_BODY = 3
FIRST_COLUMN = 4
FIRST_QPOS = 5
FIRST_QVEL = 6
PLACES = 7

# --- One row of joint parameters: the joint's numbers, its law, and the wave that moves it
ENVELOPE, STIFFNESS, DAMPING, DRIVE, MOTOR, STALL_POWER, LEAD, LAW = JOINT
WAVE = LAW + 1
YAW_WAVE = 0
PITCH_WAVE = 1
FIN_WAVE = 2
NO_WAVE = 3
OWN_INERTIA = WAVE + 1
"""Inertia of the module on the head side of the joint about it, without water [kg m^2]."""

# --- What a stage of a step knows of its free joints (`driven`): one row each
COAST_ANGLE = 0
"""Angle in the implicit state if the joint does not accelerate."""
COAST_RATE = 1
GUESS = 2
"""Acceleration at which the tangent lies [rad/s^2]."""
GUESS_TORQUE = 3
"""Torque of law and skin there."""
IMPLICIT = 4
"""Inertia that stands for the slope of the tangent [kg m^2]."""
TOTAL_TORQUE = 5
"""Torque of the tangent without acceleration."""
RATE = 6
"""Rate in the implicit state."""
STAGE_ROWS = 7

# --- One sample of the log: the state's rows, then these, then links, then angle, rate, reference
# and torque of the body's joints, then the same for the fin's joints and, in a scene, the contact
# forces on every link
COM = 0
COM_RATE = 3
HEADING = 6
HEADING_RATE = 7
ORIENTATION = 8
MEAN_PITCH = 12
SAMPLE_HEADER = 13
