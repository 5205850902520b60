"""The inertia of the water that a body takes along, where the water itself moves and accelerates.

With v, w the velocity and angular velocity of a body, a and alpha their rates (a without what the turning of the axes
adds), V the velocity of the water where the body is, DV/Dt its material acceleration, s its own rotation (half its
vorticity), u = v - V, m the added mass and I the added inertia along and about the body's axes,

    f = -m (a - DV/Dt - s x u + w x V) - (w - s) x m u
    tau = -I (alpha + w x s) - (w - s) x I (w - s) - u x m u

These are Kirchhoff's equations as seen from the water, which accelerates by DV/Dt and turns by s: a body that moves and
turns with it bears no such load. For a sphere they are m (DV/Dt - dv/dt) + 2 m s x u, added mass and the lift of a weak
shear. The force that moves the displaced water itself, rho DV/Dt per volume, comes on top. Bodies are small against the
field: what it does over their length, and the rate of s, are left out.

Plain scalar functions of one component i, for kernels of all kinds; j and k are the axes that follow it. For motion in
a plane, the components of w and s in it are zero.
"""


def carried(flow: float, s_j: float, s_k: float, u_j: float, u_k: float) -> float:
    """Acceleration against which the body's is counted, DV/Dt + s x u, along i [m/s^2].

    Args:
        flow: DV/Dt along i [m/s^2].
        s_j: Rotation of the water about j [rad/s].
        s_k: The same about k [rad/s].
        u_j: Velocity relative to the water along j [m/s].
        u_k: The same along k [m/s].
    """
    return flow + s_j * u_k - s_k * u_j


def load(keep: float, m: float, rate: float, turned: float) -> float:
    """Minus the rate of a momentum that is m u in turning axes, along i.

    Args:
        keep: 1 if it turns with the axes (`kirchhoff`), else 0.
        m: Mass or inertia of i.
        rate: Of u along i.
        turned: What turning makes of the momentum, (w - s) x m u along i; of a torque u x m u as well.
    """
    return -(m * rate + keep * turned)
