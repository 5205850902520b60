from typing import Any

import numpy as np
import pytest
from hypothesis import given, strategies as st

from laticauda.motion.gaits import (
    Anguilliform,
    Custom,
    EelLike,
    Envelope,
    Gait,
    Wave,
    custom_gait,
    eel_like,
    envelope_of,
    lateral_undulation,
    list_kinds,
)
from laticauda.values.codec import decode

WAVE: dict[str, Any] = {"amplitude": 0.5, "frequency": 2.0, "phase_shift": 0.7}

chains = st.integers(2, 40)


def uniform(i: int, n: int) -> float:
    return 1.0


@given(chains)
def test_lateral_undulation_is_the_same_in_every_joint(n: int):
    assert lateral_undulation(**WAVE).joint_envelope(n) == (1.0,) * (n - 1)


@given(chains)
def test_an_eel_like_wave_grows_from_head_to_tail(n: int):
    g = eel_like(**WAVE).joint_envelope(n)
    assert len(g) == n - 1
    assert list(g) == sorted(g, reverse=True)
    # (3) with i = 1 the tail-most joint.
    assert (g[0], g[-1]) == (pytest.approx((n - 1) / (n + 1)), pytest.approx(1 / (n + 1)))


@given(chains)
def test_an_anguilliform_wave_is_the_eel_like_one_whose_tail_most_joint_does_the_whole_amplitude(
    n: int,
):
    g = Gait(envelope=Anguilliform(), **WAVE).joint_envelope(n)
    assert (g[0], g[-1]) == (1.0, pytest.approx(1 / (n - 1)))
    assert g == pytest.approx(
        [one * (n + 1) / (n - 1) for one in eel_like(**WAVE).joint_envelope(n)]
    )


@given(chains)
def test_an_envelope_may_be_a_function_of_joint_and_links_or_a_list(n: int):
    by_function = custom_gait(envelope=lambda i, n: i / n, n_links=n, **WAVE)
    by_list = custom_gait(envelope=[i / n for i in range(1, n)], **WAVE)
    by_array = custom_gait(envelope=np.arange(1, n) / n, n_links=n, **WAVE)  # pyright: ignore[reportArgumentType]
    assert by_function == by_list == by_array
    assert by_function.kind == "custom"
    assert by_function.joint_envelope(n) == tuple(i / n for i in range(1, n))


def test_a_custom_envelope_can_be_one_of_the_built_in_ones():
    custom = custom_gait(envelope=lambda i, n: (n - i) / (n + 1), n_links=9, **WAVE)
    assert custom.joint_envelope(9) == eel_like(**WAVE).joint_envelope(9)


def test_the_offset_is_zero_unless_given():
    assert lateral_undulation(**WAVE).offset == 0.0
    assert eel_like(**WAVE, offset=0.1).offset == 0.1
    assert custom_gait(envelope=[1.0], **WAVE, offset=-0.1).offset == -0.1


def test_a_kind_may_be_written_with_hyphens():
    assert envelope_of("eel-like") == envelope_of("eel_like") == EelLike()
    assert (eel_like(**WAVE).kind, eel_like(**WAVE).words) == ("eel_like", "eel-like motion")
    assert list_kinds()[:3] == ("lateral_undulation", "eel_like", "anguilliform")
    assert "custom" not in list_kinds()


def test_a_kind_is_one_class():
    class Carangiform(Envelope):
        """Growing from the middle of the body on."""

        def __call__(self, i: int, n: int) -> float:
            return max(0.0, 1.0 - 2.0 * i / n)

    try:
        gait = Gait(envelope=Carangiform(), **WAVE)
        assert (gait.kind, gait.words) == ("carangiform", "carangiform")
        assert gait.joint_envelope(4) == (0.5, 0.0, 0.0)
        assert type(envelope_of("carangiform")) is Carangiform
        assert "carangiform" in list_kinds()
    finally:
        del Envelope._members["carangiform"]


def test_tables_of_older_files_have_the_kind_beside_the_values():
    assert decode(Gait, {**WAVE, "kind": "eel_like"}) == eel_like(**WAVE)
    assert decode(Gait, {**WAVE, "kind": "eel-like", "envelope": None}) == eel_like(**WAVE)
    assert decode(Gait, {**WAVE, "kind": "custom", "envelope": [0.5, 1]}) == custom_gait(
        envelope=[0.5, 1.0], **WAVE
    )
    assert decode(Gait, {**WAVE, "envelope": "eel-like"}) == eel_like(**WAVE)
    assert decode(Gait, WAVE) == lateral_undulation(**WAVE)


def test_numbers_become_floats_and_the_envelope_a_tuple():
    gait = Gait(amplitude=1, frequency=2, phase_shift=0, envelope=Custom(values=[1, 2]))  # pyright: ignore
    assert repr(gait.envelope) == "Custom(values=(1.0, 2.0))"
    assert all(isinstance(x, float) for x in (gait.amplitude, gait.frequency, gait.phase_shift))
    assert hash(gait) == hash(
        custom_gait(envelope=(1.0, 2.0), amplitude=1.0, frequency=2.0, phase_shift=0.0)
    )


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"amplitude": -0.1}, r"`amplitude` must be between 0 and 3.14159 rad, got -0.1\."),
        ({"amplitude": 30}, r"got 30: 30 rad is 1719 deg; did you mean amplitude_deg=30\?$"),
        (
            {"phase_shift": -40},
            r"got -40: -40 rad is -2292 deg; did you mean phase_shift_deg=-40\?$",
        ),
        ({"offset": 10.0}, r"got 10.0: 10 rad is 573 deg; did you mean offset_deg=10\?$"),
        ({"amplitude": 400.0}, r"`amplitude` must be between 0 and 3.14159 rad, got 400.0\."),
        ({"amplitude": float("nan")}, r"`amplitude` must be a finite number in rad, got nan\."),
        ({"amplitude": "30 deg"}, r"`amplitude` must be a number in rad, got '30 deg'\."),
        ({"amplitude": True}, r"`amplitude` must be a number in rad, got True\."),
        ({"frequency": -2.0}, r"`frequency` must be >= 0 rad/s, got -2.0\."),
        ({"frequency": float("inf")}, r"`frequency` must be a finite number in rad/s, got inf\."),
        ({"phase_shift": float("inf")}, r"`phase_shift` must be a finite number in rad, got inf\."),
        ({"phase_shift": None}, r"`phase_shift` must be a number in rad, got None\."),
        ({"offset": float("nan")}, r"`offset` must be a finite number in rad, got nan\."),
        ({"envelope": (1.0, 1.0)}, r"`envelope` must be of class Envelope, got tuple\."),
    ],
)
def test_a_gait_refuses(changes: dict[str, Any], message: str):
    with pytest.raises(ValueError, match=message):
        Gait(**{**WAVE, **changes})


@pytest.mark.parametrize(
    ("kind", "message"),
    [
        ("eellike", r"`kind` must be one of .*, got 'eellike'; did you mean `eel-like`\?"),
        (
            "custom",
            r"`kind` must be an envelope that needs no values, got `custom`; use `Custom\(values=...\)`\.",
        ),
        (3, r"`kind` must be the name of an envelope, got 3\."),
    ],
)
def test_an_envelope_by_name_is_refused(kind: Any, message: str):
    with pytest.raises(ValueError, match=message):
        envelope_of(kind)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (
            {"envelope": uniform},
            r"`n_links` must be given when `envelope` is a function g\(i, n\), got None\.",
        ),
        ({"envelope": uniform, "n_links": 0}, r"`n_links` must be a whole number >= 1, got 0\."),
        ({"envelope": complex, "n_links": 3}, r"`envelope\[0\]` must be a number, got \(1\+3j\)\."),
        (
            {"envelope": [1.0, 1.0], "n_links": 9},
            r"`envelope` must have one value per joint, 8 for 9 links, got 2\.",
        ),
        (
            {"envelope": None},
            r"`envelope` must be a sequence of numbers or a function g\(i, n\), got None\.",
        ),
    ],
)
def test_a_custom_gait_refuses(changes: dict[str, Any], message: str):
    with pytest.raises(ValueError, match=message):
        custom_gait(**WAVE, **changes)


def test_a_custom_envelope_fits_one_number_of_links_only():
    gait = custom_gait(envelope=[1.0, 0.5], **WAVE)
    assert gait.joint_envelope(3) == (1.0, 0.5)
    with pytest.raises(
        ValueError, match=r"`envelope` must have one value per joint, 8 for 9 links, got 2\."
    ):
        gait.joint_envelope(9)


def test_a_gait_prints_as_the_call_that_makes_it_with_round_angles_in_degrees():
    gait = eel_like(amplitude_deg=30, frequency_deg_s=130, phase_shift=0.7, offset_deg=-2.5)
    call = "Gait(amplitude_deg=30, frequency_deg_s=130, phase_shift=0.7, offset_deg=-2.5, envelope=EelLike())"
    assert repr(gait) == call
    assert eval(call) == gait
    fin = Wave(amplitude=0.25, frequency_hz=0.5)
    assert repr(fin) == "Wave(amplitude=0.25, frequency_deg_s=180)"
