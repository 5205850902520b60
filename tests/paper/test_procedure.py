import pytest
from identify.trials import DRAG, FRICTION, speeds

from laticauda.identify import from_table1
from laticauda.paper import paper_procedure


def test_the_papers_procedure_fits_one_group_and_predicts_the_rest():
    rows = from_table1()
    for model in ("analytical-set", "vortex-set"):
        result = paper_procedure(rows, model=model, parameters=[FRICTION], n_starts=1)
        assert [group.was_fitted for group in result.groups] == [True, False, False, False]
        assert sum(group.n_measurements for group in result.groups) == 20
        assert len(result.fit.problem.measurements) == 4
        assert result.fit.problem.scenarios[0].environment.drag.linear == (model == "analytical-set")
        assert result.groups[0].error < result.error_of_the_rest
    with pytest.raises(ValueError, match="`measurements` must hold speeds of gait `lateral_undulation` without fin"):
        paper_procedure(speeds(6, noise=0.002), parameters=[DRAG])
