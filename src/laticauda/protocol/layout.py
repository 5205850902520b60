"""Between the numbers of a frame and its bytes, by the layout from which the DBC file is written."""

import struct
from collections.abc import Sequence
from typing import Any

from laticauda.errors import finite
from laticauda.protocol.dbc import Layout

NOT_AVAILABLE = -32768
"""The lowest number of a signed word: what a sensor says that has nothing to say."""
MAY_LACK = ("ForceAlong", "ForceLeft", "ForceUp")
"""Signals that may be not available; for all others the lowest number is kept out."""
FORMS = {(8, False): "B", (16, False): "H", (16, True): "h"}


class Packer:
    """Numbers of one kind of frame into bytes and out of them; least significant byte first.

    Args:
        layout: Of the frame: words of 8 and 16 bits, and flags of 1 bit, eight of them in a row.
    """

    def __init__(self, layout: Layout) -> None:
        signals = layout.signals
        self._names = tuple(signal.name for signal in signals)
        self._scales = tuple(float(signal.scale) for signal in signals)
        self._limits = tuple(
            (-(2 ** (s.bits - 1)) + (s.name not in MAY_LACK), 2 ** (s.bits - 1) - 1) if s.signed else (0, 2**s.bits - 1)
            for s in signals
        )
        flags = [at for at, signal in enumerate(signals) if signal.bits == 1]
        assert len(flags) in (0, 8) and flags == list(range(flags[0], flags[0] + 8) if flags else ())
        self._flags = flags[0] if flags else None
        words = [FORMS[s.bits, s.signed] for s in signals if s.bits > 1]
        if self._flags is not None:
            words.insert(self._flags, "B")
        self._form = struct.Struct("<" + "".join(words))
        assert self._form.size == layout.length
        self._scaled = tuple((at, scale) for at, scale in enumerate(self._scales) if scale != 1.0)
        self._lacking = tuple(at for at, name in enumerate(self._names) if name in MAY_LACK)

    def packed(self, values: Sequence[Any]) -> bytes:
        """The bytes of a frame. Numbers beyond their range saturate.

        Args:
            values: In the order of the layout, in their units; None where it is not available.

        Raises:
            ValueError: If one is not finite.
        """
        raw: list[int] = []
        for value, scale, (low, high) in zip(values, self._scales, self._limits, strict=True):
            try:
                number = NOT_AVAILABLE if value is None else round(value / scale)
            except (ValueError, OverflowError):
                finite(self._names[len(raw)], value)
                raise
            raw.append(low if number < low else high if number > high else number)
        at = self._flags
        if at is not None:
            raw[at : at + 8] = [sum(bit << k for k, bit in enumerate(raw[at : at + 8]))]
        return self._form.pack(*raw)

    def unpacked(self, data: bytes) -> list[Any] | None:
        """The numbers of a frame in their units; None instead of those not available, and if its length is wrong.

        Args:
            data: Its bytes.
        """
        if len(data) != self._form.size:
            return None
        values: list[Any] = list(self._form.unpack(data))
        at = self._flags
        if at is not None:
            flags = values[at]
            values[at : at + 1] = [(flags >> k) & 1 for k in range(8)]
        lacking = [k for k in self._lacking if values[k] == NOT_AVAILABLE] if self._lacking else ()
        for k, scale in self._scaled:
            values[k] *= scale
        for k in lacking:
            values[k] = None
        return values
