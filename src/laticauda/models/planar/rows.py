"""Positions of all numbers of a planar run in the single flat array that the kernels work on.

The array is a list of *rows*; a row holds one number per lane, one lane per trial, and ``S[q]`` is
row `q` of all lanes (see `lanes`). First come the header rows, then one record of ``BODY_ROWS``
rows per body (tail first), then one record of ``STRIP_ROWS`` rows per fin strip and one of
``PLATE_ROWS`` rows per pectoral fin, then the numbers of a flow and of a recording, if any.
"""

from laticauda.motion.gaits import WaveState
from laticauda.motion.joints import (
    FIRST_FREE as FIRST_FREE,
    JOINT,
    LOCKED as LOCKED,
    PASSIVE as PASSIVE,
    PRESCRIBED as PRESCRIBED,
)
from laticauda.values import MOST_NUMBERS

# --- Header: parameters ---------------------------------------------------------------------------
(
    CURRENT_X,  # V_x [m/s]
    CURRENT_Y,  # V_y [m/s]
    OWN_VELOCITY,  # 1: added-mass velocity terms use v - V (relative, kirchhoff); 0: only -V (classic)
    KIRCHHOFF,  # 1: momentum-conserving terms and Munk moment on; 0: off
    WAKE_MASS,  # m' of the trailing edge [kg/m]; 0: off
    WAKE_POSITION,  # x of the trailing edge from the tail end of body 0 [m], headward positive
    ACTIVE_POWER,  # power of the electronics above idle [W]
    TETHER_DRAG,  # k [kg/m]
    TETHER_FORCE_X,  # [N]
    TETHER_FORCE_Y,  # [N]
    # the commanded gait
    AMPLITUDE,  # alpha [rad]
    FREQUENCY,  # omega [rad/s]
    PHASE_SHIFT,  # delta [rad]
    OFFSET,  # phi_0 [rad]
    FIN_AMPLITUDE,  # of a driven fin [rad]
    FIN_FREQUENCY,  # [rad/s]
    FIN_OFFSET,  # [rad]
    FIN_LEAD,  # phase lead over the integral of its frequency [rad]; not filtered
    BANDWIDTH,  # of the filters on all of these except the last [rad/s]
    RAMP,  # T of the smooth start [s]; 0: none
    KNOTS,  # row where a recording of the body's joints begins, after all records; 0: no recording
    N_KNOTS,  # number of its knots, each with the time, then angle and rate of every joint
    FLOW,  # row where the numbers of the water's flow begin (`fluid.flow.rows_of`), if it has one
    HEIGHT,  # height of the body's axis above the mean surface, for the flow [m]
    # --- Header: state ----------------------------------------------------------------------------
    TIME,  # [s]
    TIME_REST,  # accumulated rounding error of TIME (Kahan summation) [s]
    HEADING,  # mean angle of the body's links [rad]
    X,  # center of mass [m]
    Y,
    HEADING_RATE,  # [rad/s]
    VX,  # velocity of the center of mass [m/s]
    VY,
    PHASE,  # phase of the wave of the body's joints [rad], then the other fields of gaits.reference.WaveState
) = range(33)
AMPLITUDE_NOW, FREQUENCY_NOW, PHASE_SHIFT_NOW, OFFSET_NOW, OFFSET_RATE = (
    PHASE + k for k in (1, 3, 5, 7, 8)
)
FIN_PHASE = PHASE + len(WaveState._fields)  # the same for a driven fin, which has no phase shift
FIN_AMPLITUDE_NOW, FIN_FREQUENCY_NOW, FIN_OFFSET_NOW, FIN_OFFSET_RATE = (
    FIN_PHASE + k for k in (1, 3, 5, 6)
)
(
    WORK_ABSOLUTE,  # integral of sum |u phi'| [J]
    WORK_NET,  # integral of sum u phi' [J]
    WORK_POSITIVE,  # integral of sum max(u phi', 0) [J]
    WORK_ELECTRICAL,  # integral of the supply power above idle [J]
    # --- Header: scratch --------------------------------------------------------------------------
    HEADING_ACCELERATION,
    AX,
    AY,
    POWER_ABSOLUTE,
    POWER_NET,
    POWER_POSITIVE,
    POWER_ELECTRICAL,
    SIN_PHASE,
    COS_PHASE,
    SIN_SHIFT,
    COS_SHIFT,
    KNOT,  # last knot of the recording before the current time
    DECAY,  # decay of the generator's filters over one of its steps
    WELL,  # 1 until the lane's numbers leave the finite range, then 0
    SAMPLES,  # number of samples logged until then
    SAVED,  # six rows: the base's state at the start of a step, from HEADING to VY
) = range(FIN_OFFSET_RATE + 1, FIN_OFFSET_RATE + 21)
SLOPES = SAVED + 6  # six rows for each of the six stages of a step: the slopes of the base's state
TETHER_WATER = (
    SLOPES + 36
)  # five rows each: motion of the water at tether and trailing edge, as from WATER_T on
WAKE_WATER = TETHER_WATER + 5
LAW = WAKE_WATER + 5  # numbers of the drag law, in the order of its fields
JOINT_LAW = LAW + MOST_NUMBERS  # numbers of the joint law, if it is user-defined
HEADER_ROWS = JOINT_LAW + MOST_NUMBERS

# --- The log: the state rows of the header (TIME ... WORK_ELECTRICAL), then four numbers per joint
LOG_STATE = HEADING_ACCELERATION - TIME

# --- One record per body, beginning with the joint at the body's tail end -------------------------
ENVELOPE, STIFFNESS, DAMPING, DRIVE, MOTOR, STALL_POWER, JOINT_ROWS = JOINT
(
    LENGTH,  # 2l [m]
    INERTIA,  # I00, rigid plus added, about the tail end [kg m^2]
    COUPLING,  # m c + sum mu_n x [kg m]
    CENTRIPETAL,  # m c (+ sum mu_t x in the classic form) [kg m]
    MASS_T,  # m + sum mu_t [kg]
    MASS_N,  # m + sum mu_n [kg]
    MU_T,  # sum mu_t [kg]
    MU_N,  # sum mu_n [kg]
    MOMENT_T,  # sum mu_t x [kg m]
    MOMENT_N,  # sum mu_n x [kg m]
    MASS_SHARE,  # m / m_t
    FIRST_MOMENT_SHARE,  # m c / m_t [m]
    CENTER,  # position of its own loads from its tail end [m]; from here on as in a strip (loads.element_drag)
    C_T,
    C_N,
    LAMBDA_2,
    LAMBDA_3,
    OWN_MU_T,  # added mass of this element alone; these and the following only if the water has a flow [kg]
    OWN_MU_N,
    DISPLACED,  # mass of the displaced water [kg]
    WATER_T,  # velocity of the water there, link axes
    WATER_N,
    FLOW_T,  # its material acceleration
    FLOW_N,
    SPIN,  # its rotation [rad/s]
    THRUST_T,  # thrusters, in link axes [N]
    THRUST_N,
    THRUST_MOMENT,  # about the tail end [N m]
    HEADING_SHARE,  # share of the body's links on the head side of the joint
    # --- state
    ANGLE,  # phi
    RATE,  # phi'
    # --- scratch
    REFERENCE,  # phi_ref and its derivatives
    REFERENCE_1,
    REFERENCE_2,
    ACCELERATION,  # phi''
    TORQUE,  # u: what the actuator delivers [N m]
    TOTAL_TORQUE,  # free joint: actuator, skin and implicit terms; prescribed joint: the required torque
    IMPLICIT,  # contribution of the joint law to S^T I S [kg m^2]
    SLOPE_P,  # -du/dphi, skin included, at the start of a step
    SLOPE_D,  # -du/dphi'
    COS,
    SIN,
    LINK_RATE,  # theta'
    UX,  # velocity of the tail end of this body relative to that of body 0
    UY,
    PX,  # world position of its tail end; only if the water has a flow
    PY,
    V_T,  # velocity of its tail end relative to the water, link axes; over ground if the water has a flow
    V_N,
    EXTRA_T,  # loads in addition to the body's own drag, link axes, moment about the tail end
    EXTRA_N,
    EXTRA_MOMENT,
    A00,  # rotation row of the articulated inertia about the joint, world axes (rotation, x, y)
    A01,
    A02,
    P0,  # bias force
    P1,
    P2,
    SWING,  # free joints: phi'' if the body behind did not accelerate
    GIVE,  # reduction of phi'' per acceleration of the body behind: rotation, then its tail end
    GIVE_X,
    GIVE_Y,
    LINK_ACCELERATION,  # theta''
    QX,  # acceleration of the tail end of this body
    QY,
    SAVED_ANGLE,
    SAVED_RATE,
    SLOPE_ANGLE,
    SLOPE_RATE,
    BODY_ROWS,
) = range(JOINT_ROWS, 81)

# --- One record per fin strip: the rows of an element, from CENTER on -----------------------------
(MU_T_OF, MU_N_OF, DISPLACED_OF, WATER_OF) = (
    row - CENTER for row in (OWN_MU_T, OWN_MU_N, DISPLACED, WATER_T)
)
(STRIP_POSITION, STRIP_LAMBDA_3, STRIP_DISPLACED, STRIP_ROWS) = (0, 4, 7, 13)

# --- One record per pectoral fin: its position from the tail end of its body [m], five numbers of
# fluid.laws.plate, and the water's motion there, as from WATER_T on
(PLATE_X, PLATE_Y, PLATE_ANGLE, PLATE_LAW, PLATE_WATER, PLATE_ROWS) = (*range(4), 8, 13)
