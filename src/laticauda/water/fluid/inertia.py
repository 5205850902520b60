"""Added-mass loads on a body in water that itself moves and accelerates.

With v, w the velocity and angular velocity of a body, a and alpha their rates (a without the
contribution of the rotating axes), V the velocity of the water at the body, DV/Dt its material
acceleration, s its own rotation (half its vorticity), u = v - V, m the added mass and I the added
inertia along and about the body's axes,

    f = -m (a - DV/Dt - s x u + w x V) - (w - s) x m u
    tau = -I (alpha + w x s) - (w - s) x I (w - s) - u x m u

These are Kirchhoff's equations in the frame of the water, which accelerates with DV/Dt and rotates
with s: a body that moves and rotates with the water has no such load. For a sphere they are m
(DV/Dt - dv/dt) + 2 m s x u, added mass and the lift in weak shear. The force that accelerates the
displaced water itself, rho DV/Dt per volume, is additional. Bodies are small compared with the
field: its variation over their length, and the rate of s, are neglected.

Plain scalar functions of one component i, for kernels of all kinds; j and k are the axes that
follow it. For motion in a plane, the components of w and s in that plane are zero.
"""


def carried(flow: float, s_j: float, s_k: float, u_j: float, u_k: float) -> float:
    """Return the acceleration relative to which the body's is counted, DV/Dt + s x u, along i [m/s^2].

    Args:
        flow: DV/Dt along i [m/s^2].
        s_j: Rotation of the water about j [rad/s].
        s_k: Rotation of the water about k [rad/s].
        u_j: Velocity relative to the water along j [m/s].
        u_k: Velocity relative to the water along k [m/s].
    """
    return flow + s_j * u_k - s_k * u_j


def load(keep: float, m: float, rate: float, turned: float) -> float:
    """Return minus the rate of change of a momentum m u in rotating axes, along i.

    Args:
        keep: 1 if the momentum rotates with the axes (`kirchhoff`), else 0.
        m: Mass or inertia of i.
        rate: Rate of change of u along i.
        turned: Contribution of rotation to the rate of the momentum, (w - s) x m u along i; for a
            torque plus u x m u.
    """
    return -(m * rate + keep * turned)
