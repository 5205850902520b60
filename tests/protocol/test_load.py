import pytest
from hypothesis import given
from hypothesis import strategies as st

from laticauda.protocol import bus_load, frame_bits


def stuffed(bits):
    """Bits on the wire after stuffing: after five equal ones comes one of the other kind, which counts for the next."""
    wire, run, last = 0, 0, None
    for bit in bits:
        wire += 1
        run = run + 1 if bit == last else 1
        last = bit
        if run == 5:
            wire += 1
            last, run = 1 - bit, 1
    return wire


@given(n=st.integers(0, 8), data=st.data())
def test_no_frame_is_longer_than_the_bound(n, data):
    bits = data.draw(st.lists(st.integers(0, 1), min_size=34 + 8 * n, max_size=34 + 8 * n))
    assert stuffed(bits) + 13 <= frame_bits(n)  # CRC delimiter, acknowledgment, end of frame, pause: 13 bits


def test_the_bound_is_reached():
    for n in range(9):
        worst = [0] * 5 + [1 - (k // 4) % 2 for k in range(34 + 8 * n - 5)]
        assert stuffed(worst) + 13 == frame_bits(n)


def test_davis_gives_eight_bytes_135_bits():
    assert [frame_bits(n) for n in (0, 8)] == [55, 135]  # 55 + 10 s


@pytest.mark.parametrize(("n_nodes", "share"), [(18, 0.432), (19, 0.452)])
def test_eighteen_modules_at_100_hz_fit_and_a_driven_fin_beside_them(n_nodes, share):
    load = bus_load(n_nodes)
    assert load.fits
    assert load.share == pytest.approx(share, abs=0.001)
    answers = next(kind for kind in load.traffic if kind.name == "JointState")
    assert answers.delay < 0.005  # half a period


def test_a_tenth_of_the_bit_rate_is_too_little():
    assert not bus_load(bitrate=1e5).fits


def test_bad_arguments_are_refused():
    with pytest.raises(ValueError, match=r"`n_nodes` must be <= 19, got 20\."):
        bus_load(20)
    with pytest.raises(ValueError, match=r"`n_bytes` must be <= 8, got 9\."):
        frame_bits(9)
    with pytest.raises(ValueError, match=r"`rate` must be > 0 Hz, got 0\."):
        bus_load(18, 0)
