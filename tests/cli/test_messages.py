from laticauda.cli import messages
from laticauda.cli.swim import GaitFlags, RunFlags, Swim

SWIM = Swim(gait=GaitFlags(amplitude_deg=-3.0, offset_deg=0.0), run=RunFlags(heading_deg=400.0))


def test_options_are_found_in_all_groups():
    found = messages.options(SWIM)
    assert found["amplitude_deg"] == -3.0
    assert found["robot"] is None
    assert {"density", "no_linear_drag", "json", "resume"} <= found.keys()


def test_an_option_that_was_typed_counts_even_if_it_is_zero():
    assert messages.given(SWIM) == {"amplitude_deg": -3.0, "offset_deg": 0.0, "heading_deg": 400.0}


def test_an_option_in_degrees_is_told_in_degrees():
    text = messages.in_flags("`amplitude` must be >= 0 rad, got -0.0523.", SWIM)
    assert text == "--amplitude-deg must be >= 0 deg, got -3."


def test_bounds_within_a_message_are_read_in_degrees_too():
    swim = Swim(gait=GaitFlags(amplitude_deg=80.0))
    text = messages.in_flags("`amplitude` must be <= 1.047 rad, or a joint passes 1.571 rad; got 1.396.", swim)
    assert text == "--amplitude-deg must be <= 60 deg, or a joint passes 90 deg; got 80."


def test_an_option_in_its_own_unit_keeps_rule_and_value():
    text = messages.in_flags("`offset_bandwidth` must be > 0 rad/s, got -1.", SWIM)
    assert text == "--offset-bandwidth must be > 0 rad/s, got -1."


def test_every_argument_in_a_message_becomes_its_option_and_all_else_stays():
    text = messages.in_flags("`envelope[3]` must suit `kind`, robot `mamba` and `trial`.", SWIM)
    assert text == "--envelope must suit --gait, robot `mamba` and --resume."


def test_a_message_without_a_command_stays_as_it_is():
    assert messages.in_flags("`amplitude` must be >= 0 rad, got -1.", None) == "`amplitude` must be >= 0 rad, got -1."
