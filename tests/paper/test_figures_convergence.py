import numpy as np

from laticauda.figures import new_figure
from laticauda.paper import convergence


def test_curves_bounds_and_slopes_are_drawn_on_logarithmic_axes():
    dt = np.array([0.004, 0.002, 0.001])
    curves = {"pd": {at: at**2 for at in dt.tolist()}, "servo": {at: 2.0 * at**2 for at in dt.tolist()}}
    ax = new_figure(3.5, 2.5).add_subplot()
    assert convergence(curves, ax, ylabel="path [-]", orders={"pd": 2}, bounds=[(3e-3, "0.3 %")]) is ax
    assert (ax.get_xscale(), ax.get_yscale(), ax.get_ylabel()) == ("log", "log", "path [-]")
    pd, slope, servo, bound = ax.get_lines()
    np.testing.assert_allclose(pd.get_xydata(), np.column_stack([1e3 * dt, dt**2]))
    np.testing.assert_allclose(servo.get_ydata(), 2.0 * dt**2)
    np.testing.assert_allclose(bound.get_ydata(), 3e-3)
    (x_0, x_1), (y_0, y_1) = slope.get_xdata(), slope.get_ydata()
    np.testing.assert_allclose(np.log(y_0 / y_1) / np.log(x_0 / x_1), 2.0)
    assert {text.get_text() for text in ax.texts} == {"0.3 %", "order 2"}
