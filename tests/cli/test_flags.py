from dataclasses import fields, replace

import pytest

from laticauda.cli.flag_names import FLAG_NAMES
from laticauda.cli.flags import (
    BadFlag,
    options_of,
    parse_command,
    spell_field,
    spell_fields_in,
    spell_flag,
    spell_option,
    was_typed,
)
from laticauda.cli.identify import IdentificationTarget
from laticauda.cli.studies import Optimize, Sweep
from laticauda.cli.swim import ResumeSwim
from laticauda.cli.trial import Show, View
from laticauda.cli.vary import Study
from laticauda.motion.gaits import Gait, Wave, lateral_undulation
from laticauda.robot import Water, load_water
from laticauda.scenarios import Start
from laticauda.values import Extensible
from laticauda.values.quantities import fields_of, option, quantity, texts_of, value_class
from laticauda.water.fluid.laws import PolynomialDrag


@value_class
class Shape:
    """A shape."""

    angle: float = quantity("rad", "How far it is turned", ge=-1.0, le=1.0, default=0.5)
    sides: int = quantity("", "How many there are", ge=3, default=4)
    is_open: bool = option("Whether a side is missing", default=False)


@value_class
class Draw:
    """Draw it."""

    shape: Shape = option("What", default=Shape())
    at: tuple[float, float] = quantity("m", "Where", default=(0.0, 0.0))
    label: str | None = option("What stands below", default=None)


def drawn(line: str, default: Draw | None = None) -> Draw:
    return parse_command(Draw, line.split(), "draw", default)


def test_flags_left_out_have_what_the_class_or_the_default_has():
    assert drawn("") == Draw()
    start = Draw(shape=Shape(sides=7), label="x")
    assert drawn("", start) == start
    assert drawn("--angle-deg 0", start) == replace(start, shape=replace(start.shape, angle=0.0))


def test_an_angle_is_typed_in_degrees():
    assert drawn("--angle-deg 30").shape.angle == pytest.approx(0.5235987755982988, abs=1e-15)


def test_numbers_texts_and_switches_are_read():
    found = drawn("--at 1 -2e-3 --sides 5 --is-open --label a")
    assert found == Draw(shape=Shape(sides=5, is_open=True), at=(1.0, -0.002), label="a")


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("--angle-deg 90", "--angle-deg must be between -57.2958 and 57.2958 deg, got 90."),
        ("--angle-deg x", "--angle-deg must be a number, got 'x'."),
        ("--angle-deg nan", "--angle-deg must be a finite number in deg, got nan."),
        ("--sides 2", "--sides must be a whole number >= 3, got 2."),
        ("--sides 3.5", "--sides must be a whole number, got '3.5'."),
        ("--at 1 inf", "--at must be a finite number in m, got inf."),
    ],
)
def test_a_number_out_of_range_is_refused_in_the_unit_that_was_typed(line, message):
    with pytest.raises(BadFlag) as refused:
        drawn(line)
    assert str(refused.value) == message


@pytest.mark.parametrize(
    ("line", "named"),
    [
        ("swim --save ''", "--save"),
        ("trial show ''", "FILE"),
        ("sweep --output $'\\0'", "--output"),
        ("serve --host .", "--host"),
        ("cockpit --host 'a\nb'", "--host"),
        ("lab --host ..", "--host"),
    ],
)
def test_what_can_be_the_name_of_no_file_and_of_no_host_is_refused_by_its_option(run, line, named):
    done = run(line.replace("$'\\0'", "\0"))
    assert done.status == 2
    assert named in done.err and "Traceback" not in done.err


def test_an_argument_is_told_by_its_option():
    assert spell_field("angle", Draw()) == "--angle-deg"
    assert spell_field("at[1]", Draw()) == "--at"
    assert spell_field("sigma", Draw()) == "`sigma`"
    names = {field.name for field in options_of(Draw())}
    assert names == {"angle", "sides", "is_open", "at", "label"}


def test_one_of_several_values_is_told_by_the_option_that_gives_them():
    assert spell_field("scenarios[1].model", View(file="a.nc")) == "--beside"
    assert spell_field("bounds[0]", None) == "--vary"


def test_other_options_in_a_rule_are_told_by_their_flags():
    rule = "must be < `angle`, unless `label` is `open`, and not `sigma`, got 2"
    options = options_of(Draw())
    spelled = "must be < --angle-deg, unless --label is `open`, and not `sigma`, got 2"
    assert spell_fields_in(rule, options) == spelled


def test_an_option_is_spelled_in_one_way_wherever_it_is_named():
    names_in_messages = {
        "interval": IdentificationTarget(),  # a scenario's has another flag
        "frames_per_second": ResumeSwim(),
        "file": Show(file="a.nc"),
        "depth": Wiggle(gait=lateral_undulation(amplitude=0.5, frequency=2.0, phase_shift=0.7)),
    }
    spelled = [spell_field(name, command) for name, command in names_in_messages.items()]
    assert spelled == ["--interval", "--fps", "FILE", "`depth`"]
    start = fields_of(Start)
    assert spell_option(start["pitch"]) == "--start-pitch-deg"
    assert spell_option(start["center_of_mass"]) == "--position"


@pytest.mark.parametrize(
    ("words", "is_typed"),
    [
        ("--free-start", True),
        ("--no-free-start", True),
        ("--free_start", True),
        ("--interval=2", True),
        ("--columns a.toml", False),
    ],
)
def test_an_option_counts_as_typed_however_it_is_written(words, is_typed):
    options = fields_of(IdentificationTarget)
    typed = [was_typed(options[name], words.split()) for name in ("free_start", "interval")]
    assert any(typed) == is_typed


@value_class
class Wiggle:
    """Wiggle."""

    gait: Gait = option("How")


def test_a_second_wave_is_there_once_a_number_of_it_is_typed_and_keeps_what_was_not():
    plain = lateral_undulation(amplitude=0.5, frequency=2.0, phase_shift=0.7)
    wave = Wave(amplitude=0.1, frequency=3.0, phase_shift=0.2, phase=0.4)
    assert parse_command(Wiggle, [], "wiggle", Wiggle(gait=plain)).gait == plain
    added = parse_command(Wiggle, ["--pitch-offset-deg", "0"], "wiggle", Wiggle(gait=plain)).gait
    assert added.pitch == Wave(amplitude=0.0, frequency=2.0, phase_shift=0.7)
    changed = parse_command(
        Wiggle, ["--pitch-offset-deg", "0"], "wiggle", Wiggle(gait=replace(plain, pitch=wave))
    ).gait
    assert changed.pitch is not None and changed.pitch.frequency == 3.0
    assert changed.pitch.phase == pytest.approx(0.4, rel=1e-9)


def test_every_field_of_water_and_of_its_law_is_an_option_with_its_text(run):
    text = " ".join(run("swim --water paper-lateral --help").out.replace("│", " ").split())
    for kind in (Water, PolynomialDrag):
        for field in fields(kind):
            if field.name not in ("name", "drag"):
                assert spell_flag(field.name) in text
                assert " ".join(texts_of(kind)[field.name].split()) in text


def test_the_help_shows_what_a_preset_has(run):
    assert (
        f"(default: {load_water('paper-eel').tangential_friction:g})"
        in run("swim --water paper-eel --help").out
    )


def test_a_number_of_ones_own_that_is_called_like_an_option_of_studies_has_its_class_in_front():
    @value_class
    class Stiffened(Extensible, group="test_stiffened"):
        share: float = quantity("", "Of the body that is stiff", default=0.25)

    (field,) = fields_of(Stiffened).values()
    assert spell_option(field) == "--stiffened-share"
    of_commands = set(fields_of(Sweep)) | set(fields_of(Optimize))
    assert of_commands - set(fields_of(Study)) <= FLAG_NAMES.words_of_studies
