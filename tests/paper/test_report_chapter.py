from laticauda.paper.report.chapter import figure_numbers


def test_numbers_of_figures_in_a_row_are_said_from_to():
    assert figure_numbers([12, 14, 15, 16, 18]) == "Figs. 12, 14 to 16 and 18"
    assert figure_numbers([17]) == "Fig. 17"
