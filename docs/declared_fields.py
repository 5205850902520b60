"""For the API reference: a field that is declared by its unit and text has them as its docstring.

So `quantity` and `option` of values, `Series` of a log and `Figure` of a trial. And `Example:` in a
docstring, which would be shown as prose, is what the reader of docstrings calls `Examples:`, code
with its result.
"""

import ast
from typing import Any

import griffe

DECLARED = ("quantity", "option", "Series", "Figure")


class DeclaredFields(griffe.Extension):
    """Reads the declarations as they stand in the source; nothing is imported."""

    def on_instance(self, *, obj: griffe.Object, **_: Any) -> None:
        """Name a docstring's example so that it is shown as code."""
        if obj.docstring is not None:
            obj.docstring.value = obj.docstring.value.replace(
                "Example:\n    >>>", "Examples:\n    >>>"
            )

    def on_attribute_instance(self, *, attr: griffe.Attribute, **_: Any) -> None:
        """Give a declared field its docstring."""
        value: Any = attr.value
        if (
            isinstance(attr.annotation, griffe.ExprSubscript)
            and str(attr.annotation.left) == "Annotated"
        ):
            attr.annotation, value = attr.annotation.slice.elements
        if not isinstance(value, griffe.ExprCall) or str(value.function) not in DECLARED:
            return
        first = [str(one) for one in value.arguments if not isinstance(one, griffe.ExprKeyword)][:2]
        texts = [ast.literal_eval(one) if one[:1] in "'\"(" else one for one in first]
        given = {
            one.name: one.value for one in value.arguments if isinstance(one, griffe.ExprKeyword)
        }
        bounds = [
            f"{sign} {given[name]}"
            for name, sign in (("gt", ">"), ("ge", ">="), ("le", "<="))
            if name in given
        ]
        unit = [texts[0] or "-"] if len(texts) == 2 else []
        text = texts[-1]
        if str(value.function) in ("Series", "Figure"):
            text = text[:1].upper() + text[1:]
        if attr.docstring is None:
            attr.docstring = griffe.Docstring(
                f"{text} [{', '.join([*unit, *bounds])}]." if unit else f"{text}."
            )
        if value is attr.value:
            attr.value = given.get("default")
