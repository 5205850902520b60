import pytest

from laticauda.fields import field_docs, split_unit
from laticauda.gaits import Gait
from laticauda.robot import Module, Water


def test_the_docstrings_of_fields_are_found_by_name():
    assert field_docs(Module)["length"] == "Whole length 2l [m]."
    assert "name" in field_docs(Water)
    assert field_docs(Gait).keys() == Gait.__dataclass_fields__.keys()


@pytest.mark.parametrize(
    ("doc", "parts"),
    [
        ("Whole length 2l [m].", ("Whole length 2l", "m")),
        ("C_f, or None for the water's [-].", ("C_f, or None for the water's", "")),
        ("Whether the drag has a part that is linear.", ("Whether the drag has a part that is linear", "")),
        ("Viscous friction,\n    likewise [N m s/rad].", ("Viscous friction, likewise", "N m s/rad")),
    ],
)
def test_a_unit_stands_in_brackets_at_the_end(doc: str, parts: tuple[str, str]):
    assert split_unit(doc) == parts
