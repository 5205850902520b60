from show.figures.runs import run

from laticauda.show.figures import plot_overlay, save_figure


def labels(figure) -> list[tuple[str, str]]:
    return [(ax.get_xlabel(), ax.get_ylabel()) for ax in figure.axes]


def test_several_trials_are_drawn_in_one_figure_with_their_names(tmp_path):
    figure = plot_overlay([run("lateral"), run("fin"), run("short")], ["a", "b", "c"])
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["a", "b", "c"]
    assert labels(figure) == [("x [m]", "y [m]"), ("time [s]", "speed, mean over a cycle [m/s]")]
    looks = {(line.get_color(), str(line.get_linestyle())) for line in figure.axes[1].lines}
    assert len(looks) == 3
    save_figure(figure, tmp_path / "a.png")


def test_a_run_without_a_whole_cycle_is_drawn_beside_others():
    still = run("still")
    figure = plot_overlay([run("lateral"), still], ["a", "b"])
    assert figure.axes[1].lines[1].get_xdata().size == still.time.size
