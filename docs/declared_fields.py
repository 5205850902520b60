"""For the API reference: a field that is declared by `quantity` or `option` has its text as its docstring."""

import ast
from typing import Any

import griffe


class DeclaredFields(griffe.Extension):
    """Reads the declarations as they stand in the source; nothing is imported."""

    def on_attribute_instance(self, *, attr: griffe.Attribute, **_: Any) -> None:
        """Give a declared field its docstring."""
        value = attr.value
        if not isinstance(value, griffe.ExprCall) or str(value.function) not in ("quantity", "option"):
            return
        first = [str(one) for one in value.arguments if not isinstance(one, griffe.ExprKeyword)]
        texts = [ast.literal_eval(one) if one[:1] in "'\"(" else one for one in first]
        given = {one.name: one.value for one in value.arguments if isinstance(one, griffe.ExprKeyword)}
        bounds = [f"{sign} {given[name]}" for name, sign in (("gt", ">"), ("ge", ">="), ("le", "<=")) if name in given]
        unit = [texts[0] or "-"] if len(texts) == 2 else []
        attr.docstring = griffe.Docstring(f"{texts[-1]} [{', '.join([*unit, *bounds])}]." if unit else f"{texts[-1]}.")
        attr.value = given.get("default")
