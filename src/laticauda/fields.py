"""The docstrings under the fields of dataclasses: what a field is, and the unit that it is in."""

import ast
import functools
import inspect
import re
import textwrap

from laticauda.quantities import quantities_of, texts_of


@functools.cache
def field_docs(kind: type) -> dict[str, str]:
    """The docstrings of a dataclass's fields by name, or what stands for them in a declared `value`."""
    texts, numbers = texts_of(kind), quantities_of(kind)
    if any(texts.values()):
        return {
            name: f"{text} [{numbers[name].unit}]." if name in numbers else f"{text}." for name, text in texts.items()
        }
    (definition,) = ast.parse(textwrap.dedent(inspect.getsource(kind))).body
    assert isinstance(definition, ast.ClassDef)
    found: dict[str, str] = {}
    for node, following in zip(definition.body, definition.body[1:], strict=False):
        if not isinstance(node, ast.AnnAssign) or not isinstance(node.target, ast.Name):
            continue
        if isinstance(following, ast.Expr) and isinstance(following.value, ast.Constant):
            found[node.target.id] = str(following.value.value)
    return found


def split_unit(doc: str) -> tuple[str, str]:
    """A field's docstring as what it says and the unit in brackets at its end; "" for a pure number.

    Args:
        doc: As `field_docs` has it.

    Example:
        >>> split_unit("Whole length 2l [m].")
        ('Whole length 2l', 'm')
    """
    text = " ".join(doc.split())
    found = re.fullmatch(r"(.*?)\s*\[([^\[\]]+)\]\.?", text)
    if found is None:
        return text.rstrip("."), ""
    return found[1], "" if found[2] == "-" else found[2]
