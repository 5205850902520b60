import pytest

pytest.importorskip("mujoco", reason="needs MuJoCo, the extra `spatial`")

from laticauda.paper import ParitySettings, parity_cases, run_parity
from laticauda.paper.claims import claims
from laticauda.paper.report.parity import parity_chapter


@pytest.fixture(scope="module")
def study():
    return run_parity(ParitySettings(cases=parity_cases()[::2], steps=(0.05, 0.025), duration=6.0))


def test_the_report_has_every_comparison_and_the_convergence_plot(study):
    told = []
    chapter = parity_chapter(study)
    ((name, caption, figure),) = chapter.figures()
    assert (name, len(figure.axes)) == ("parity", 2)
    assert "worst" in caption
    html = chapter.html({name: (caption, b"")})
    assert "At a step of 25 ms" in html and html.count("<img ") == 1
    assert len(chapter.tables["parity"]) == 2 * len(study.settings.cases)
    run_parity(
        ParitySettings(cases=parity_cases()[:1], steps=(0.05,), duration=3.0), progress=lambda *n: told.append(n)
    )
    assert told == [(1, 1)]


def test_the_claim_that_both_models_agree_is_judged_by_it(study):
    (claim,) = (claim for claim in claims(study) if claim.key == "same-as-vortex")
    assert claim.verdict == "holds"
    assert "step of 25 ms" in claim.found
    (untested,) = (claim for claim in claims() if claim.key == "same-as-vortex")
    assert untested.verdict == "not tested here"


def test_only_the_spatial_model_can_be_compared():
    with pytest.raises(ValueError, match="`model` must be one of `spatial`, got 'planar'"):
        run_parity(model="planar")
