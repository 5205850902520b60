"""Serial interface of Fluke 287 and 289 multimeters: one line of ASCII as the question, one or two as the answer.

A question ends with a carriage return. The answer begins with a line of one digit: 0 success, 1
syntax error, 2 execution error, 5 no data; a 0 is followed by a line of data, if there is any.
115200 baud, 8N1.

Fluke documents ID, QM and QDDA among others. `PRESS MINMAX`, which presses that button, is known
only from other programs; here it restarts the record of minimum, average and maximum.

References:
    Fluke, "Fluke 289/287 Remote Interface Specification" (remote_spec28X); N0ury/dmm_util for the fields' names.
"""

import math
from dataclasses import dataclass, field
from enum import IntEnum

from laticauda.tank.protocol.messages import ProtocolError

BAUD_RATE = 115200
"""Bits per second of the serial line."""
END = b"\r"
"""End of a line."""
IDENTITY = "ID"
"""Question for the meter's name."""
MEASURE = "QM"
"""Question for the present reading."""
DISPLAYED = "QDDA"
"""Question for all that the meter shows."""
RESTART = "PRESS MINMAX"
"""Order to press the button that restarts the record."""
LONGEST_LINE = 1000
"""Bytes of a line at most; valid ones are far shorter."""
READING_FIELDS = 9
"""Fields of a reading in the answer to QDDA."""
RECORD_ROUNDING = 1e-5
"""Share of the record's values by which the average may lie beyond them, as they are rounded [-]."""
OVERLOAD = 9.99999999e37
"""Number that the meter gives if it is overloaded."""


class Acknowledgment(IntEnum):
    """First line of an answer."""

    WELL = 0
    SYNTAX_ERROR = 1
    EXECUTION_ERROR = 2
    NO_DATA = 5


@dataclass(frozen=True, kw_only=True)
class MeterReading:
    """Reading of the supply's current by the meter."""

    live: float
    """Present current [A]."""
    average: float | None = None
    """Average since the record began; None: no record [A]."""
    minimum: float | None = None
    """Minimum since the record began; None: no record [A]."""
    maximum: float | None = None
    """Maximum since the record began; None: no record [A]."""
    duration: float | None = None
    """Duration of the record [s]."""


@dataclass
class LineReader:
    """Splits a stream of bytes into lines that end with a carriage return, and drops data too long for a line."""

    _unfinished: bytes = field(default=b"")

    def feed(self, data: bytes) -> list[str]:
        """Return the lines completed by `data`, without their ends; non-ASCII bytes are replaced."""
        *lines, self._unfinished = (self._unfinished + data).split(END)
        self._unfinished = self._unfinished[-LONGEST_LINE:]
        return [line.strip(b"\n").decode("ascii", errors="replace") for line in lines]


def encode_question(question: str) -> bytes:
    """Encode a question for transmission."""
    return question.encode("ascii") + END


def encode_answer(
    data: str | None = None, acknowledgment: Acknowledgment = Acknowledgment.WELL
) -> bytes:
    """Encode an answer for transmission.

    Args:
        data: The second line, if there is one.
        acknowledgment: The first line.
    """
    first_line = str(int(acknowledgment)).encode() + END
    if data is None:
        return first_line
    return first_line + data.encode("ascii") + END


def live_text(current: float) -> str:
    """Return the data of the answer to QM: value, unit, state, attribute."""
    return f"{current:.6E},ADC,NORMAL,NONE"


def displayed_text(reading: MeterReading, now: float = 0.0) -> str:
    """Return the data of the answer to QDDA.

    It contains primary and secondary function, range, unit, range number, multiplier, the lightning
    bolt, start time of the record, the number of modes and their names, the number of readings, and
    nine fields for each: name, value, unit, multiplier, decimals, digits, state, attribute, time.

    Args:
        reading: Reading that the meter shows.
        now: Time on the meter's clock [s].
    """
    readings: dict[str, float] = {"LIVE": reading.live}
    modes: tuple[str, ...] = ()
    began = 0.0
    if reading.average is not None and reading.minimum is not None and reading.maximum is not None:
        modes = ("MIN_MAX_AVG",)
        began = now - (reading.duration or 0.0)
        readings["PRIMARY"] = reading.live
        readings["MAXIMUM"] = reading.maximum
        readings["AVERAGE"] = reading.average
        readings["MINIMUM"] = reading.minimum
    fields = ["A_DC", "NONE", "AUTO", "ADC", "10", "0", "OFF", f"{began:.3f}"]
    fields += [str(len(modes)), *modes]
    fields.append(str(len(readings)))
    for name, value in readings.items():
        fields += [name, f"{value:.6E}", "ADC", "0", "4", "5", "NORMAL", "NONE", f"{now:.3f}"]
    return ",".join(fields)


@dataclass(frozen=True)
class _DisplayedValue:
    """One reading in the answer to QDDA: nine fields."""

    name: str
    value: str
    unit: str
    state: str
    time: str

    @classmethod
    def of(cls, fields: list[str]) -> "_DisplayedValue":
        """Return the reading in nine fields, four of which are not needed."""
        name, value, unit, _multiplier, _decimals, _digits, state, _attribute, time = fields
        return cls(name=name, value=value, unit=unit, state=state, time=time)


def decode_displayed(text: str) -> MeterReading:
    """Decode the answer to QDDA.

    Raises:
        ProtocolError: If it is not such an answer, or not a direct current.
    """
    try:
        return _decode_displayed_fields(text, text.split(","))
    except ProtocolError:
        raise
    except (IndexError, ValueError):
        raise ProtocolError(f"the meter's answer to QDDA is invalid: {text!r:.80}") from None


def _decode_displayed_fields(text: str, fields: list[str]) -> MeterReading:
    """Decode the fields of the answer; fields 3, 7 and 8 are the unit, the start and the number of modes."""
    no_direct_current = ProtocolError(
        f"the meter must show a direct current, its answer to QDDA is {text!r:.80}"
    )
    unit = fields[3]
    began = float(fields[7])
    n_modes = int(fields[8])
    if unit != "ADC" or not 0 <= n_modes < len(fields):
        raise no_direct_current
    n_readings = int(fields[9 + n_modes])
    reading_fields = fields[10 + n_modes :]
    if len(reading_fields) != n_readings * READING_FIELDS:
        raise ProtocolError(f"the meter's answer to QDDA is cut short: {text!r:.80}")
    values: dict[str, float] = {}
    times: list[float] = []
    for begin in range(0, len(reading_fields), READING_FIELDS):
        reading = _DisplayedValue.of(reading_fields[begin : begin + READING_FIELDS])
        if reading.name in values:
            raise ProtocolError(f"the meter's answer to QDDA has two {reading.name!r:.40}")
        if reading.unit == "ADC" and reading.state == "NORMAL":
            values[reading.name] = _current(reading.value)
        times.append(float(reading.time))
    live = values.get("LIVE", values.get("PRIMARY"))
    if live is None:
        raise no_direct_current
    duration = max(times, default=began) - began
    record_names = ("AVERAGE", "MINIMUM", "MAXIMUM")
    if not all(name in values for name in record_names) or not math.isfinite(duration):
        return MeterReading(live=live)
    minimum, average, maximum = values["MINIMUM"], values["AVERAGE"], values["MAXIMUM"]
    rounding = RECORD_ROUNDING * max(abs(minimum), abs(maximum))
    is_ordered = minimum - rounding <= average <= maximum + rounding
    if not is_ordered or duration < 0.0:
        raise ProtocolError(f"the meter's record contradicts itself: {text!r:.80}")
    return MeterReading(
        live=live,
        average=average,
        minimum=minimum,
        maximum=maximum,
        duration=duration,
    )


def _current(text: str) -> float:
    value = float(text)
    if not abs(value) < OVERLOAD:
        raise ProtocolError(f"the meter is overloaded: it reads {text!r:.40}")
    return value
