"""Both models call the same compiled scalar laws."""

from laticauda.models.dynamics.shared_laws import SHARED_LAWS, compile_shared_laws
from laticauda.models.planar.model import specialize


def test_a_template_gets_the_one_list_of_laws():
    shared = compile_shared_laws()
    assert specialize().drives.shared is shared
    for law in SHARED_LAWS:
        assert getattr(shared, law.__name__).py_func.__code__.co_name == law.__name__
