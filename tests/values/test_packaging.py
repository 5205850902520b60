import importlib
import importlib.metadata
import inspect
import pickle
import pkgutil
import sys
import types
import warnings

import faces
import pytest

import laticauda as lc
from laticauda.values import packaging

FACES = faces.find_faces()
LAZY = [
    ".".join(face.path.parent.relative_to(faces.ROOT / "src").parts)
    for face in FACES
    if face.path.is_relative_to(faces.ROOT / "src")
]


@pytest.mark.parametrize("package", LAZY)
def test_a_package_shows_its_public_names_and_nothing_else(package):
    module = importlib.import_module(package)
    # A module does not take the place of a function that has its name.
    for info in pkgutil.iter_modules(module.__path__):
        if info.name in module.__all__:
            importlib.import_module(f"{package}.{info.name}")
    assert dir(module) == sorted(module.__all__)
    assert all(not inspect.ismodule(getattr(module, name)) for name in module.__all__)
    assert not hasattr(module, "nothing")
    with pytest.raises(AttributeError, match=f"module '{package}' has no attribute 'nothing'"):
        module.nothing  # noqa: B018


def test_packages_have_tables_of_their_public_names():
    assert {"laticauda", "laticauda.robot", "laticauda.models.simulate"} <= set(LAZY)


@pytest.mark.parametrize("face", FACES, ids=lambda face: face.path.parent.name)
def test_type_checkers_see_the_names_of_the_table(face):
    assert face.imports == face.homes, "run `python tests/faces.py --update`"
    assert face.updated() == face.path.read_text(encoding="utf-8")


@pytest.mark.parametrize("face", FACES, ids=lambda face: face.path.parent.name)
def test_a_function_with_the_name_of_a_module_is_imported_at_once(face):
    modules = {info.name for info in pkgutil.iter_modules([str(face.path.parent)])}
    names = {name for names in face.homes.values() for name in names}
    assert not names & modules


def test_imports_are_written_as_the_formatter_does(tmp_path):
    path = tmp_path / "__init__.py"
    path.write_text(
        "if TYPE_CHECKING:\n    pass\nlazy_exports(1)\n"
        'x = lazy_exports(__name__, {"laticauda.a": ["A", "b"]}, own=["c"])\n'
    )
    face = faces.read_face(path)
    assert face is not None
    assert face.own == ["c"]
    assert face.updated().splitlines()[1] == "    from laticauda.a import A as A, b as b"
    long = [f"a_name_of_some_length_{i}" for i in range(3)]
    assert faces.import_lines("m", long)[1] == f"        {long[0]} as {long[0]},"


@pytest.fixture
def package(monkeypatch):
    """A package `sea` with a module `sea.fish`."""
    sea, fish = types.ModuleType("sea"), types.ModuleType("sea.fish")
    sea.__path__ = []

    def swim(speed: float) -> float:
        return 1.0 / speed

    swim.__module__ = "sea.fish"
    fish.swim, fish.N_FINS = swim, 7
    sea.own_name = "water"
    monkeypatch.setitem(sys.modules, "sea", sea)
    monkeypatch.setitem(sys.modules, "sea.fish", fish)
    return sea


def test_names_are_taken_from_their_module_at_each_use(package):
    get, names, public = packaging.lazy_exports(
        "sea", {"sea.fish": ["swim", "N_FINS"]}, own=["own_name"]
    )
    assert names() == public == ["N_FINS", "own_name", "swim"]
    assert get("N_FINS") == 7
    sys.modules["sea.fish"].N_FINS = 8  # pyright: ignore[reportAttributeAccessIssue]
    assert get("N_FINS") == 8


def test_a_public_function_names_an_argument_of_the_wrong_type(package):
    get, _, _ = packaging.lazy_exports("sea", {"sea.fish": ["swim"]})
    assert get("swim").__module__ == "sea"
    with pytest.raises(ValueError, match=r"`speed` must be of class float, got str"):
        get("swim")("fast")


def test_what_other_rooms_use_is_handed_on_as_it_is_and_not_shown(package):
    get, names, public = packaging.lazy_exports(
        "sea", {"sea.fish": ["N_FINS"]}, plain={"sea.fish": ["swim"]}
    )
    assert get("swim") is sys.modules["sea.fish"].swim
    assert names() == public == ["N_FINS"]


def test_an_old_name_of_a_package_works_with_a_warning_and_is_not_shown(package):
    get, names, _ = packaging.lazy_exports(
        "sea",
        {"sea.fish": ["swim"]},
        renamed={"crawl": "swim", "FINS": "sea.fish:N_FINS"},
    )
    package.__getattr__ = get
    with pytest.warns(DeprecationWarning, match=r"^sea\.crawl is now sea\.swim$") as caught:
        from sea import crawl  # pyright: ignore[reportMissingImports]
    assert crawl(2.0) == 0.5
    assert {warning.filename for warning in caught} == {__file__}
    with pytest.warns(DeprecationWarning, match=r"^sea\.FINS is now sea\.fish\.N_FINS$"):
        assert get("FINS") == 7
    assert names() == ["swim"]


def test_an_old_name_of_a_module_works_with_a_warning(package):
    get = packaging.renamed_names("sea.fish", {"FINS": "N_FINS"})
    with pytest.warns(DeprecationWarning, match=r"fish\.FINS is now sea\.fish\.N_FINS") as caught:
        assert get("FINS") == 7
    assert caught[0].filename == __file__
    with pytest.raises(AttributeError, match=r"module 'sea\.fish' has no attribute 'other'"):
        get("other")


@pytest.fixture
def moved(monkeypatch):
    """Packages `laticauda.brook` and `laticauda.tank`, which have moved."""
    monkeypatch.setattr(sys, "meta_path", [*sys.meta_path])
    before = set(sys.modules)
    packaging.moved_modules(
        {
            "laticauda.brook": "laticauda.water.fluid",
            "laticauda.brook.kin": "laticauda.robot.kinematics",
        }
    )
    yield
    for name in set(sys.modules) - before:
        if name.startswith("laticauda.brook"):
            del sys.modules[name]
    vars(lc).pop("brook", None)
    vars(sys.modules["laticauda.water.fluid"]).pop("kin", None)


def test_a_moved_package_and_its_modules_are_those_of_today(moved):
    from laticauda.robot import kinematics
    from laticauda.water.fluid import laws

    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        from laticauda.brook.laws import (  # pyright: ignore[reportMissingImports]
            PolynomialDrag,
        )
    assert PolynomialDrag is laws.PolynomialDrag
    assert [str(warning.message) for warning in caught] == [
        "laticauda.brook is now laticauda.water.fluid",
        "laticauda.brook.laws is now laticauda.water.fluid.laws",
    ]
    assert {warning.filename for warning in caught} == {__file__}
    assert laws.__name__ == "laticauda.water.fluid.laws" == laws.__spec__.name
    with pytest.warns(DeprecationWarning, match="is now laticauda.robot.kinematics"):
        assert importlib.import_module("laticauda.brook.kin") is kinematics


def test_what_was_pickled_under_an_old_name_can_be_read(moved):
    from laticauda.water.fluid import PolynomialDrag

    name = b"claticauda.brook.laws\nPolynomialDrag\n."
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)
        assert pickle.loads(name) is PolynomialDrag


def test_a_module_that_never_was_is_not_found(moved):
    with pytest.raises(ModuleNotFoundError, match=r"laticauda\.creek"):
        importlib.import_module("laticauda.creek")


def test_public_functions_can_be_pickled():
    assert pickle.loads(pickle.dumps(lc.swim)) is lc.swim


def test_the_version_is_the_installed_one():
    assert lc.__version__ == importlib.metadata.version("laticauda")
