"""Names of 0.2 in modules that pages and examples imported from: they work for one release, with a warning."""

from importlib import import_module

import pytest

FORMER_NAMES = [
    ("laticauda.values.quantities", "value", "value_class"),
    ("laticauda.identify.candidates", "swims", "swim_candidates"),
    ("laticauda.identify.design", "design", "design_experiment"),
    ("laticauda.cli.flags", "read", "parse_command"),
    ("laticauda.cli.flags", "Stored", "TrialOutput"),
    ("laticauda.paper.scores", "scores", "score_study"),
    ("laticauda.models.simulate.numbers", "changed", "change_parameters"),
    ("laticauda.models.simulate.numbers", "parameters", "list_parameters"),
    ("laticauda.show.pictures.render", "video", "render_film"),
    ("laticauda.show.pictures.render", "still", "write_still"),
    ("laticauda.models.spatial.mjcf", "spec", "build_spec"),
    ("laticauda.trials.feasibility", "feasibility", "judge_feasibility"),
]


@pytest.mark.parametrize(("module_name", "former", "current"), FORMER_NAMES)
def test_a_former_name_is_the_same_object_and_says_its_new_name(module_name, former, current):
    module = import_module(module_name)
    with pytest.warns(DeprecationWarning, match=current):
        former_object = getattr(module, former)
    assert former_object is getattr(module, current)
