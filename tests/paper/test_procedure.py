import pytest
from identify.trials import DRAG, FRICTION, speeds

from laticauda.identify import from_table1
from laticauda.paper import paper_procedure


def test_the_papers_procedure_fits_one_group_and_predicts_the_rest():
    rows = from_table1()
    for model in ("analytical-set", "vortex-set"):
        result = paper_procedure(rows, model=model, parameters=[FRICTION], n_starts=1)
        assert [name in result.fit.problem.groups for name in result.errors] == [True, False, False, False]
        assert len(result.fit.problem.measurements) == 4
        assert result.fit.problem.scenarios[0].environment.drag.linear == (model == "analytical-set")
        assert next(iter(result.errors.values())) < result.error_of_the_rest
        others = [row for row in rows if row.group not in result.fit.problem.groups]
        mean = sum(result.errors[row.group] for row in others) / len(others)
        assert result.error_of_the_rest == pytest.approx(mean)  # each row counts alike
    assert len(rows) == 20
    with pytest.raises(ValueError, match="`measurements` must hold speeds of gait `lateral_undulation` without fin"):
        paper_procedure(speeds(6, noise=0.002), parameters=[DRAG])
