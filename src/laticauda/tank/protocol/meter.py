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
END = b"\r"
IDENTITY, MEASURE, DISPLAYED, RESTART = "ID", "QM", "QDDA", "PRESS MINMAX"
LONGEST = 1000  # bytes of a line; valid ones are far shorter
READING_FIELDS = 9
OVERLOAD = 9.99999999e37


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

    _waiting: bytes = field(default=b"")

    def feed(self, data: bytes) -> list[str]:
        """Return the lines completed by `data`, without their ends; non-ASCII bytes are replaced."""
        *lines, self._waiting = (self._waiting + data).split(END)
        self._waiting = self._waiting[-LONGEST:]
        return [line.strip(b"\n").decode("ascii", errors="replace") for line in lines]


def encode_question(word: str) -> bytes:
    """Encode a question for transmission."""
    return word.encode("ascii") + END


def encode_answer(
    data: str | None = None, acknowledgment: Acknowledgment = Acknowledgment.WELL
) -> bytes:
    """Encode an answer for transmission.

    Args:
        data: The second line, if there is one.
        acknowledgment: The first line.
    """
    first = str(int(acknowledgment)).encode() + END
    return first if data is None else first + data.encode("ascii") + END


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
        modes, began = ("MIN_MAX_AVG",), now - (reading.duration or 0.0)
        values = (reading.live, reading.maximum, reading.average, reading.minimum)
        readings |= dict(zip(("PRIMARY", "MAXIMUM", "AVERAGE", "MINIMUM"), values, strict=True))
    words = [
        "A_DC",
        "NONE",
        "AUTO",
        "ADC",
        "10",
        "0",
        "OFF",
        f"{began:.3f}",
        str(len(modes)),
        *modes,
    ]
    words.append(str(len(readings)))
    for name, value in readings.items():
        words += [name, f"{value:.6E}", "ADC", "0", "4", "5", "NORMAL", "NONE", f"{now:.3f}"]
    return ",".join(words)


def decode_displayed(text: str) -> MeterReading:
    """Decode the answer to QDDA.

    Raises:
        ProtocolError: If it is not such an answer, or not a direct current.
    """
    words = text.split(",")
    try:
        began, n_modes = float(words[7]), int(words[8])
        if words[3] != "ADC" or not 0 <= n_modes < len(words):
            raise ProtocolError(
                f"the meter must show a direct current, its answer to QDDA is {text!r:.80}"
            )
        count = int(words[9 + n_modes])
        rest = words[10 + n_modes :]
        if len(rest) != count * READING_FIELDS:
            raise ProtocolError(f"the meter's answer to QDDA is cut short: {text!r:.80}")
        readings = [rest[i : i + READING_FIELDS] for i in range(0, len(rest), READING_FIELDS)]
        values = {r[0]: _current(r[1]) for r in readings if r[2] == "ADC" and r[6] == "NORMAL"}
        now = max((float(r[8]) for r in readings), default=began)
    except (IndexError, ValueError) as error:
        if isinstance(error, ProtocolError):
            raise
        raise ProtocolError(f"the meter's answer to QDDA is invalid: {text!r:.80}") from None
    live, duration = values.get("LIVE", values.get("PRIMARY")), now - began
    if live is None:
        raise ProtocolError(
            f"the meter must show a direct current, its answer to QDDA is {text!r:.80}"
        )
    record = {
        name.lower(): values[name] for name in ("AVERAGE", "MINIMUM", "MAXIMUM") if name in values
    }
    is_kept = len(record) == 3 and math.isfinite(duration)
    return (
        MeterReading(live=live, **record, duration=duration) if is_kept else MeterReading(live=live)
    )


def _current(word: str) -> float:
    value = float(word)
    if not abs(value) < OVERLOAD:
        raise ProtocolError(f"the meter is overloaded: it reads {word!r:.40}")
    return value
