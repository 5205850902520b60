"""What newcomers type, and what the answer must hold: 27 mistakes in Python and 13 in the shell.

An answer is the text of an error or of a warning. Mistakes that are not answered yet are listed
with the reason.
"""

import pickle
import warnings
from collections.abc import Callable
from copy import deepcopy
from importlib import import_module

import pytest
from odd_robots import MM_ROBOT

import laticauda as lc
from laticauda.cli import app
from laticauda.identify import from_table
from laticauda.values import UnitWarning

NUMBERS = {"amplitude_deg": 30, "frequency_deg_s": 130, "phase_shift_deg": 40}
GAIT = lc.lateral_undulation(**NUMBERS)
HEADER = "gait,alpha_deg,omega_deg_s,delta_deg,v_m_s\n"
ROW = "LU,30,130,40,0.15\n"


@pytest.fixture(scope="module")
def trial():
    """A short run."""
    return lc.swim("mamba", GAIT, 1.0)


def changed(**numbers):
    return lc.lateral_undulation(**{**NUMBERS, **numbers})


def swim_until_it_diverges() -> lc.Trial:
    """Return a run of somebody who ignores warnings."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return lc.swim("mamba", changed(frequency_deg_s=3000), 5.0)


IN_PYTHON: dict[str, tuple[Callable[[lc.Trial], object], str]] = {
    "trial.speed": (
        lambda trial: trial.speed,
        "did you mean forward_velocity, steady_velocity?",
    ),
    "trial.power": (lambda trial: trial.power, "did you mean mean_power, mechanical_power"),
    "trial.position": (lambda trial: trial.position, "did you mean center_of_mass?"),
    "trial.forward_velocty": (lambda trial: trial.forward_velocty, "mean forward_velocity?"),
    "trial.electrical_power": (lambda trial: trial.electrical_power, "joints='servo'"),
    "trial.save('run.xlsx')": (lambda trial: trial.save("run.xlsx"), ".nc or .mcap"),
    "trial.efficiency": (lambda trial: trial.efficiency, "did you mean cost_of_transport"),
    "lc.fit": (lambda _: lc.fit, "did you mean laticauda.identify.fit?"),
    "lc.sweep": (lambda _: lc.sweep, "did you mean laticauda.studies.run_sweep, swim_many?"),
    "lc.Simulation": (lambda _: lc.Simulation, "did you mean swim?"),
    "lc.Robot.load": (lambda _: lc.Robot.load("mamba"), "did you mean laticauda.load_robot?"),
    "robot.weight": (lambda trial: trial.robot.weight, "did you mean mass?"),
    "load_robot('mambo')": (lambda _: lc.load_robot("mambo"), "did you mean `mamba`?"),
    "swim(time=5)": (lambda _: lc.swim("mamba", GAIT, time=5.0), "did you mean duration?"),
    "swim(water=...)": (
        lambda _: lc.swim("mamba", GAIT, water="paper-lateral"),
        "did you mean environment?",
    ),
    "swim(gait, robot)": (lambda _: lc.swim(GAIT, "mamba"), "the robot comes first"),
    "swim(robot, name)": (
        lambda _: lc.swim("mamba", "lateral-undulation"),
        '"lateral-undulation", amplitude_deg=30, frequency_deg_s=130, phase_shift_deg=40',
    ),
    "swim(robot, gaits)": (lambda _: lc.swim("mamba", [GAIT, GAIT]), "did you mean swim_many?"),
    "swim(joints='servos')": (
        lambda _: lc.swim("mamba", GAIT, joints="servos"),
        "did you mean `servo`?",
    ),
    "lateral_undulation(30, 130, 40)": (
        lambda _: lc.lateral_undulation(30, 130, 40),
        "lateral_undulation(amplitude_deg=30, frequency_deg_s=130, phase_shift_deg=40), or in rad and rad/s: "
        "amplitude=, frequency=, phase_shift=",
    ),
    "degrees taken for radians": (
        lambda _: lc.lateral_undulation(amplitude=30, frequency=2.3, phase_shift=0.7),
        "did you mean amplitude_deg=30?",
    ),
    "radians taken for degrees": (
        lambda _: changed(amplitude_deg=0.5),
        "did you mean amplitude=0.5, in rad?",
    ),
    "deg/s taken for rad/s": (
        lambda _: lc.eel_like(amplitude=0.5, frequency=130, phase_shift=0.7),
        "did you mean frequency_deg_s=130?",
    ),
    "20000 deg/s": (lambda _: changed(frequency_deg_s=20000), "is 55.6 cycles per second"),
    "freq=": (
        lambda _: lc.lateral_undulation(amplitude=0.5, freq=2.3, phase_shift=0.7),
        "did you mean `frequency` [rad/s], or `frequency_deg_s` or `frequency_hz`?",
    ),
    "no phase shift": (
        lambda _: lc.lateral_undulation(amplitude=0.5, frequency=2.3),
        "also needs `phase_shift` [rad], or `phase_shift_deg`",
    ),
    "a run that diverged": (
        lambda _: swim_until_it_diverges().forward_velocity,
        "A run that failed has no figures: The run diverged",
    ),
}
NOT_ANSWERED: dict[str, str] = {}
IN_SHELL: dict[str, tuple[str, str]] = {
    "no command": ("", "Try first: laticauda swim mamba"),
    "another command": ("simulate mamba", "did you mean `swim`?"),
    "another robot": ("swim mambo", "did you mean `mamba`?"),
    "a result as an option": ("swim mamba --speed 1", "--frequency-deg-s"),
    "no unit of the frequency": ("swim mamba --frequency 130", "did you mean --frequency-deg-s"),
    "no unit of the amplitude": ("swim --amplitude 30", "did you mean --amplitude-deg?"),
    "half a gait": ("swim mamba --gait lateral", "did you mean `lateral-undulation`?"),
    "no picture": ("trial plot run.nc", "--output FILE"),
    "own columns": (
        "identify --table own.csv --parameters water.normal_drag",
        "column `amplitude` is not known; did you mean `alpha_deg`? "
        "column `frequency` is not known; did you mean `omega_deg_s`? "
        "column `phase` is not known; did you mean `delta_deg`? "
        "column `speed` is not known; did you mean `v_m_s`?",
    ),
    "cm/s": (
        "identify --table cm.csv --parameters water.normal_drag",
        "cm.csv: row 3: `v_m_s` of 15 at",
    ),
    "a table as a trial": (
        "identify cm.csv --parameters water.normal_drag",
        "`laticauda identify --table`",
    ),
    "a robot in mm": ("robots mm.toml", "mm"),
    "water in g/cm^3": ("swim mamba --density 1", "did you mean 1000 (1 g/cm^3)?"),
}
FILES = {
    "own.csv": "gait,amplitude,frequency,phase,speed\nLU,30,130,40,0.15\n",
    "cm.csv": f"{HEADER}{ROW}LU,30,130,40,15\n",
    "mm.toml": MM_ROBOT,
}


def test_at_least_36_of_40_are_answered():
    assert (len(IN_PYTHON), len(IN_SHELL)) == (27, 13)
    assert NOT_ANSWERED.keys() <= IN_PYTHON.keys() | IN_SHELL.keys()
    assert len(IN_PYTHON) + len(IN_SHELL) - len(NOT_ANSWERED) >= 36


@pytest.mark.parametrize("mistake", [name for name in IN_PYTHON if name not in NOT_ANSWERED])
def test_python_answers_with_the_cure(mistake, trial):
    make, cure = IN_PYTHON[mistake]
    with warnings.catch_warnings():
        warnings.simplefilter("error", UnitWarning)
        with pytest.raises(
            (AttributeError, TypeError, ValueError, RuntimeError, UserWarning)
        ) as answer:
            make(trial)
    assert cure in str(answer.value)


@pytest.mark.parametrize("mistake", [name for name in IN_SHELL if name not in NOT_ANSWERED])
def test_the_shell_answers_with_the_cure(mistake, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    for name, text in FILES.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    typed, cure = IN_SHELL[mistake]
    assert app.main(typed.split()) == 2
    assert cure in " ".join(capsys.readouterr().err.split())


def test_an_empty_cell_is_named(tmp_path):
    rows = [ROW] * 20
    rows[13] = "LU,30,130,40,\n"
    (tmp_path / "tank.csv").write_text(HEADER + "".join(rows), encoding="utf-8")
    with pytest.warns(UserWarning, match="tank.csv: 1 of 20 rows has no speed: row 15"):
        assert len(from_table(tmp_path / "tank.csv")) == 19


def test_a_gait_is_also_known_by_name_and_its_frequency_in_hz():
    assert lc.build_scenario("mamba", "lateral undulation", **NUMBERS).motion == GAIT
    assert lc.build_scenario("mamba", "lateral_undulation", **NUMBERS).motion == GAIT
    in_hz = lc.eel_like(amplitude_deg=30, frequency_hz=0.5, phase_shift_deg=40)
    assert repr(in_hz.frequency) == repr(lc.Gait(**{**NUMBERS, "frequency_deg_s": 180}).frequency)
    with pytest.raises(ValueError, match="`frequency_hz` must not be given together with"):
        changed(frequency_hz=0.5)
    with pytest.raises(ValueError, match="`amplitude_deg` must be given only with the name"):
        lc.build_scenario("mamba", GAIT, amplitude_deg=30)
    with pytest.raises(ValueError, match="did you mean `eel-like`"):
        lc.build_scenario("mamba", "eel", **NUMBERS)


def test_wrong_names_are_wrong_names_still(trial):
    for thing in (trial, trial.robot, trial.gait):
        assert not hasattr(thing, "speed")
        assert not hasattr(type(thing), "load")
        assert getattr(thing, "power", None) is None
        assert not hasattr(thing, "__array__")
    assert not hasattr(lc, "fit")
    assert deepcopy(trial.robot) == pickle.loads(pickle.dumps(trial.robot)) == trial.robot
    assert pickle.loads(pickle.dumps(trial)).equals(trial)
    with pytest.raises(AttributeError) as wrong:
        trial.robot.lenght  # noqa: B018
    assert wrong.value.name == "lenght"
    copy = pickle.loads(pickle.dumps(wrong.value))
    assert (
        str(copy) == str(wrong.value) == "a Robot has no attribute 'lenght'; did you mean length?"
    )


def test_a_property_that_fails_says_why_itself():
    class Odd(lc.Robot):
        @property
        def wheel(self):
            return self.modules.spokes

    mamba = lc.load_robot("mamba")
    odd = Odd(name="odd", modules=mamba.modules, joints=mamba.joints)
    with pytest.raises(AttributeError, match="'tuple' object has no attribute 'spokes'"):
        odd.wheel  # noqa: B018


def test_what_is_meant_exists(trial):
    for names in lc._MEANT.values():
        for name in names:
            if name.startswith("laticauda."):
                module, _, attribute = name.rpartition(".")
                assert hasattr(import_module(module), attribute), name
    for thing in (trial, trial.robot, trial.gait):
        for names in type(thing)._meant.values():
            for name in names:
                if name.isidentifier():
                    assert name in dir(thing), name
