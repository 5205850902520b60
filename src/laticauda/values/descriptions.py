"""Values in words, for people: their fields with units, as texts and as tables of notebooks."""

import dataclasses
import html
import inspect
import math
from collections.abc import Iterable
from typing import Any, cast

from laticauda.values.declared_fields import Field, fields_of
from laticauda.values.declared_quantities import Quantity


def describe_fields(value: object, *left_out: str) -> dict[str, str]:
    """Describe the content of a value in words, by field; fields that are None, empty or 0 are omitted.

    Numbers have their units, angles are in degrees; nested values give their `words`, or are put in
    parentheses.

    Args:
        value: The value.
        left_out: Fields that are described elsewhere.
    """
    descriptions: dict[str, str] = {}
    for name, field in fields_of(type(value)).items():
        if name in left_out:
            continue
        description = describe_field(getattr(value, name), field.quantity)
        if description:
            descriptions[name] = description
    return descriptions


def describe_field(content: Any, quantity: Quantity | None) -> str:
    """Return the content of a field in words, angles in degrees; "" for 0.

    Args:
        content: Content of the field.
        quantity: Its unit and range, if it holds numbers.
    """
    if hasattr(content, "words"):
        return content.words
    if dataclasses.is_dataclass(content):
        return _describe_part(content)
    if quantity is not None:
        return _describe_numbers(content, quantity)
    if isinstance(content, str):
        return content
    if content is True:
        return "yes"
    return ""


def _describe_part(part: object) -> str:
    fields = [f"{name} {description}" for name, description in describe_fields(part).items()]
    if not fields:
        return ""
    return f"({', '.join(fields)})"


def _describe_numbers(content: Any, quantity: Quantity) -> str:
    numbers = (content,)
    if isinstance(content, tuple):
        numbers = cast("tuple[Any, ...]", content)
    are_finite = all(
        isinstance(number, int | float) and math.isfinite(number) for number in numbers
    )
    if not any(numbers) or not are_finite:
        return ""
    unit = quantity.display
    listed = ", ".join(f"{unit.from_si(number):g}" for number in numbers)
    if len(numbers) > 1:
        listed = f"({listed})"
    return f"{listed} {unit.name}".rstrip()


def html_table(title: str, rows: Iterable[tuple[str, str]]) -> str:
    """Return a table with a `title`, and `rows` of names and texts, as shown by notebooks."""
    row = '<tr><th style="text-align:left">{}</th><td style="text-align:left">{}</td></tr>'
    lines = [row.format(html.escape(name), html.escape(text)) for name, text in rows]
    return f"<table><caption>{html.escape(title)}</caption>{''.join(lines)}</table>"


def value_as_table(value: Any) -> str:
    """Return a value as notebooks show it.

    Args:
        value: A value with declared fields.
    """
    title = getattr(value, "words", value.__class__.__name__)
    return html_table(title, describe_fields(value).items())


FIELDS = "\n\nFields:\n"
"""What stands between the docstring of a class and the list of its fields."""


def show_call(value: Any) -> str:
    """Return the call that makes an equal value, without defaults, and with round angles in degrees.

    Args:
        value: A value with declared fields.
    """
    kind: type = value.__class__
    arguments: list[str] = []
    for field in fields_of(kind).values():
        content = getattr(value, field.name)
        if not field.is_required and content == field.make_default():
            continue
        in_display_unit = field.exact_in_display_unit(content)
        if in_display_unit is None or field.display_name is None:
            arguments.append(f"{field.name}={content!r}")
        else:
            arguments.append(f"{field.display_name}={in_display_unit:.12g}")
    return f"{kind.__name__}({', '.join(arguments)})"


def docstring_with_fields(kind: type) -> str:
    """Return the docstring of a class with its fields appended.

    Args:
        kind: A dataclass with declared fields.
    """
    docstring = inspect.cleandoc(kind.__doc__ or kind.__name__)
    lines = [f"    {field.name}: {_document_field(field)}.\n" for field in fields_of(kind).values()]
    return docstring + FIELDS + "".join(lines)


def docstring_without_fields(kind: type) -> str:
    """Return the docstring of a class as its author wrote it, without the list that was appended.

    Args:
        kind: Any class.
    """
    docstring, _, _ = (kind.__doc__ or "").partition(FIELDS)
    return docstring


def _document_field(field: Field) -> str:
    text = field.text
    if field.quantity is not None:
        text += f" [{field.unit or '-'}]"
        if field.quantity.range:
            text += f", {field.quantity.range}"
    if field.default is not dataclasses.MISSING:
        text += f"; default {field.default!r}"
    return text
