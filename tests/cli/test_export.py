import json

import pytest

import laticauda as lc

mujoco = pytest.importorskip("mujoco")


def test_an_exported_mjcf_file_opens_in_mujoco(run, folder):
    done = run("export mjcf robot.xml --robot mamba-modules-fin --tank --actuators servo")
    assert (done.status, done.err) == (0, "")
    assert done.out.startswith("robot.xml: mamba-modules-fin, 19 modules, 14.855 kg, 1.71 m (")
    model = mujoco.MjModel.from_xml_path(str(folder / "robot.xml"))
    assert (model.nu, model.nv) == (18, 24)
    assert model.geom("floor").pos[2] == -1.5


def test_an_exported_urdf_file_opens_in_mujoco(run, folder):
    done = run("export urdf robot.urdf --robot mamba-fin --json")
    assert json.loads(done.out) == {
        "output": "robot.urdf",
        "robot": "mamba-fin",
        "n_links": 9,
        "mass": lc.load_robot("mamba-fin").mass,
        "length": lc.load_robot("mamba-fin").length,
    }
    assert mujoco.MjModel.from_xml_path(str(folder / "robot.urdf")).nv == 8


def test_a_robot_on_the_ground_is_exported_with_the_ground(run, folder):
    assert run("export mjcf robot.xml --ground coulomb --root planar --n-links 5 --robot chain").status == 0
    model = mujoco.MjModel.from_xml_path(str(folder / "robot.xml"))
    assert model.geom("ground").type[0] == mujoco.mjtGeom.mjGEOM_PLANE
    assert model.nv == 3 + 4


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("export mjcf robot.txt", "OUTPUT must be a file that ends in .xml, got robot.txt."),
        ("export urdf robot.xml", "OUTPUT must be a file that ends in .urdf, got robot.xml."),
        ("export mjcf no/robot.xml", "OUTPUT must be a file in a folder that exists, got no/robot.xml."),
        ("export mjcf robot.xml --ground coulomb --tank", "--tank must not be given with --ground."),
        ("export mjcf robot.xml --ground coulomb --water paper-eel", "--water must not be given with --ground."),
        ("export urdf robot.urdf --meshes a.stl", "--meshes must be one file per module, 9, or none, got 1."),
        ("export mjcf robot.xml --meshes a.stl", "--meshes must be one file per module, 9, or none, got 1."),
        ("export mjcf robot.xml --root fixed", "('free', 'planar')"),
        ("export mjcf robot.xml --robot mambo", "did you mean"),
        ("export", "Expected one of {mjcf, urdf}."),
    ],
)
def test_bad_input_is_refused_by_name(run, folder, line, message):
    done = run(line)
    assert done.status == 2
    assert message in " ".join(done.err.replace("│", " ").split())
    assert not list(folder.iterdir())
