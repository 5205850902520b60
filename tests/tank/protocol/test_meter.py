import pytest
from hypothesis import given, strategies as st

from laticauda.tank.protocol import MeterReading, ProtocolError, meter
from laticauda.tank.protocol.meter import LineReader, decode_displayed, displayed_text

AMPERES = st.integers(-(10**6), 10**6).map(lambda raw: raw * 1e-5)
RECORDS = st.tuples(AMPERES, AMPERES, AMPERES).map(sorted)
"""Minimum, average and maximum."""


def shows(live, record, duration):
    minimum, average, maximum = record
    return MeterReading(
        live=live, average=average, minimum=minimum, maximum=maximum, duration=duration
    )


READINGS = st.builds(MeterReading, live=AMPERES) | st.builds(
    shows, AMPERES, RECORDS, st.integers(0, 10**6)
)


@given(reading=READINGS, now=st.integers(0, 10**6))
def test_what_the_meter_displays_comes_back(reading, now):
    back = decode_displayed(displayed_text(reading, now))
    for name in ("live", "average", "minimum", "maximum", "duration"):
        found, expected = getattr(back, name), getattr(reading, name)
        assert found == expected or found == pytest.approx(
            expected, rel=1e-6, abs=1e-3 * (name == "duration")
        )


@given(current=AMPERES)
def test_the_current_comes_back(current):
    number, *rest = meter.live_text(current).split(",")
    assert (float(number), rest) == (pytest.approx(current, rel=1e-6), ["ADC", "NORMAL", "NONE"])


@given(
    lines=st.lists(st.text(alphabet=st.characters(min_codepoint=32, max_codepoint=126))),
    cut=st.integers(1, 5),
)
def test_lines_come_back_however_the_stream_is_cut(lines, cut):
    stream = b"".join(map(meter.encode_question, lines))
    reader = LineReader()
    assert [
        line for i in range(0, len(stream), cut) for line in reader.feed(stream[i : i + cut])
    ] == lines


@given(data=st.binary(max_size=3000))
def test_random_bytes_give_lines(data):
    reader = LineReader()
    for line in reader.feed(data):
        try:
            decode_displayed(line)
        except ProtocolError:
            pass
    assert len(reader._unfinished) <= meter.LONGEST_LINE


@given(reading=READINGS, data=st.data())
def test_an_answer_that_is_cut_short_is_an_error_or_lacks_digits_of_its_time_only(reading, data):
    text = displayed_text(reading)
    cut = text[: data.draw(st.integers(0, text.rindex(",")))]
    with pytest.raises(ProtocolError):
        decode_displayed(cut)


def test_what_is_no_direct_current_is_refused():
    with pytest.raises(ProtocolError, match="overloaded"):
        decode_displayed(displayed_text(MeterReading(live=9.99999999e37)))
    with pytest.raises(ProtocolError, match="must show a direct current"):
        decode_displayed(
            "V_DC,NONE,AUTO,VDC,5,0,OFF,0.000,0,1,LIVE,1.0E0,VDC,0,4,5,NORMAL,NONE,0.0"
        )


def answer(**words: str) -> str:
    """What the meter displays of 1 A, with other words at some places."""
    sound = displayed_text(MeterReading(live=1.0), 5.0).split(",")
    return ",".join(words.get(f"at_{i}", word) for i, word in enumerate(sound))


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (answer(), ""),
        (answer(at_7="soon"), "the meter's answer to QDDA is invalid: 'A_DC,"),
        (answer(at_8="-1"), "the meter must show a direct current, its answer to QDDA is 'A_DC,"),
        (answer(at_9="2"), "the meter's answer to QDDA is cut short: 'A_DC,"),
        (answer(at_11="much"), "the meter's answer to QDDA is invalid: 'A_DC,"),
        (answer(at_11="-1E38"), "the meter is overloaded: it reads '-1E38'"),
        (answer(at_11="nan"), "the meter is overloaded: it reads 'nan'"),
        (
            answer(at_10="PEAK"),
            "the meter must show a direct current, its answer to QDDA is 'A_DC,",
        ),
        (
            answer(at_16="INVALID"),
            "the meter must show a direct current, its answer to QDDA is 'A_DC,",
        ),
    ],
)
def test_an_answer_is_a_reading_or_it_is_said_what_is_wrong_with_it(text, says):
    if not says:
        assert decode_displayed(text) == MeterReading(live=1.0)
    else:
        with pytest.raises(ProtocolError) as error:
            decode_displayed(text)
        assert str(error.value).startswith(says)


def test_an_answer_begins_with_how_it_went_and_may_have_a_line_of_data():
    assert meter.encode_answer() == b"0\r"
    assert meter.encode_answer("1,2") == b"0\r1,2\r"
    assert meter.encode_answer(acknowledgment=meter.Acknowledgment.NO_DATA) == b"5\r"


def answered(**values):
    """An answer to QDDA with these readings, at 100 s."""
    fields = [f"{name},{value},ADC,0,4,5,NORMAL,NONE,100" for name, value in values.items()]
    return ",".join([f"A_DC,NONE,AUTO,ADC,10,0,OFF,0,1,MIN_MAX_AVG,{len(fields)}", *fields])


def test_a_record_that_contradicts_itself_is_no_reading():
    usual = {"LIVE": 2.0, "AVERAGE": 2.0, "MINIMUM": 1.0, "MAXIMUM": 3.0}
    assert meter.decode_displayed(answered(**usual)).average == 2.0
    for text in (
        answered(**usual | {"AVERAGE": 9.0}),
        answered(**usual | {"MINIMUM": 4.0}),
        answered(**usual).replace(",OFF,0,", ",OFF,1000,"),
    ):
        with pytest.raises(ProtocolError, match=r"^the meter's record contradicts itself"):
            meter.decode_displayed(text)
    doubled = answered(**usual).replace("AVERAGE", "LIVE")
    with pytest.raises(ProtocolError, match=r"^the meter's answer to QDDA has two 'LIVE'"):
        meter.decode_displayed(doubled)
