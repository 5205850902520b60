import numpy as np

from laticauda.figures.style import new_figure
from laticauda.figures.timing import plot_timing


def test_the_marks_are_median_99_percent_and_largest():
    values = np.linspace(0.001, 0.02, 1000)
    figure = new_figure(3.5, 2.5)
    ax = plot_timing(figure.subplots(), values, 0.01, "latency")
    texts = [text.get_text() for text in ax.texts]
    assert "median 10.50" in texts
    assert "largest 20.00" in texts
    assert any(text.startswith("99 % 19.8") for text in texts)
    assert ax.get_xlabel() == "latency [ms]"
