"""The text in the bytes of a file: UTF-8 or UTF-16, with or without a mark at its beginning, or else Latin-1."""

import codecs

LEAST_ZEROS = 0.3
"""Share of the bytes at even or odd places that are zero in a text of UTF-16, at least."""
CONTROL_CHARACTERS = bytes(set(range(32)) - set(b"\t\n\v\f\r"))
NO_TEXT = "it is not a text file of columns, or it is empty."


def decode_text(content: bytes) -> str:
    """Return the text of a table.

    Args:
        content: All bytes of the file.

    Raises:
        ValueError: If it is no text.
    """
    if content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return _decode_as(content, "utf-16")
    if b"\x00" in content:
        return _decode_as(content, _byte_order(content))
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        # Texts of other encodings have no control characters; binary files have many.
        if content.translate(None, CONTROL_CHARACTERS) != content:
            raise ValueError(NO_TEXT) from None
        return content.decode("latin-1")


def _byte_order(content: bytes) -> str:
    """Return the variant of UTF-16 in which a text without a mark is written: mostly, every other byte is zero."""
    n_pairs = len(content) // 2
    if content[1::2].count(0) > LEAST_ZEROS * n_pairs:
        return "utf-16-le"
    if content[0::2].count(0) > LEAST_ZEROS * n_pairs:
        return "utf-16-be"
    raise ValueError(NO_TEXT)


def _decode_as(content: bytes, encoding: str) -> str:
    try:
        text = content.decode(encoding)
    except UnicodeDecodeError:
        raise ValueError(NO_TEXT) from None
    if "\x00" in text:
        raise ValueError(NO_TEXT)
    return text
