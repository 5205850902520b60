"""Mutants of a Python file for campaigns/mutants.py: the same text with one small fault in it.

The faults are the usual ones: a comparison that lets its edge in, or out, or is the wrong way
round; `and` for `or`; a condition, a flag or a sign turned round; an arithmetic operator for its
opposite; a number that is one more or less; min for max, all for any; an absolute value that is
left out; a call, an assignment to a part of something or a `raise` that is left out; nothing
returned instead of something; the next turn of a loop for its end. Texts, annotations, decorators,
assertions (also the `strict` of zip) and what only type checkers read stay as they are.
"""

import ast
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

EDGES = {ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE, ast.GtE: ast.Gt}
"""Comparisons that let their edge in, or out."""
OPPOSITES: dict[type[ast.cmpop], type[ast.cmpop]] = {
    ast.Lt: ast.GtE,
    ast.GtE: ast.Lt,
    ast.Gt: ast.LtE,
    ast.LtE: ast.Gt,
    ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq,
    ast.Is: ast.IsNot,
    ast.IsNot: ast.Is,
    ast.In: ast.NotIn,
    ast.NotIn: ast.In,
}
"""Comparisons that are the wrong way round."""
ARITHMETIC: dict[type[ast.operator], type[ast.operator]] = {
    ast.Add: ast.Sub,
    ast.Sub: ast.Add,
    ast.Mult: ast.Div,
    ast.Div: ast.Mult,
    ast.FloorDiv: ast.Div,
    ast.Mod: ast.Mult,
    ast.Pow: ast.Mult,
    ast.LShift: ast.RShift,
    ast.RShift: ast.LShift,
    ast.BitAnd: ast.BitOr,
    ast.BitOr: ast.BitAnd,
}
"""Operators, and their opposites."""
NAMES = {
    "min": "max",
    "max": "min",
    "any": "all",
    "all": "any",
    "minimum": "maximum",
    "maximum": "minimum",
}
"""Functions for one another."""
TYPING = ("Literal", "Annotated", "TypeVar", "cast")
"""What only type checkers read."""
TYPES = ("None", "int", "float", "bool", "str", "list", "tuple")
"""Names of types that begin with a small letter."""


@dataclass(frozen=True, kw_only=True)
class Mutant:
    """One fault in one file."""

    function: str
    """The outermost function that it is in, by its qualified name; "": what runs when the file is imported."""
    line: int
    """Of the file, where the fault begins."""
    first: int
    """Line of the function's definition, as its code counts it; 0 outside of functions."""
    before: str
    """The lines as they are, in one."""
    after: str
    """With the fault."""
    text: str
    """The whole file with the fault."""


def mutants_of(text: str) -> list[Mutant]:
    """All of a file's text, in the order of the text."""
    tree = ast.parse(text)
    lines = [line.encode() for line in text.splitlines(keepends=True)]
    mutants: dict[str, Mutant] = {}
    for fault in _faults(tree, _Place()):
        mutant = _mutant(lines, fault)
        mutants[mutant.text] = mutant
    return list(mutants.values())


@dataclass(frozen=True)
class _Place:
    """Where a node is."""

    names: tuple[str, ...] = ()
    """Of the classes and functions that it is in."""
    outer: ast.FunctionDef | None = None
    """The outermost function that it is in."""
    qualified: str = ""
    """Its qualified name."""
    holder: ast.JoinedStr | None = None
    """The formatted text that it is a part of."""

    def inside(self, node: ast.AST) -> "_Place":
        if isinstance(node, ast.JoinedStr):
            return _Place(self.names, self.outer, self.qualified, self.holder or node)
        if isinstance(node, ast.ClassDef):
            return _Place((*self.names, node.name), self.outer, self.qualified, None)
        if isinstance(node, ast.FunctionDef):
            names = (*self.names, node.name)
            return _Place(names, self.outer or node, self.qualified or ".".join(names), None)
        return self


class Fault(NamedTuple):
    """Another text in the place of a node."""

    place: _Place
    node: Any
    text: str


def _faults(node: ast.AST, place: _Place) -> Iterator[Fault]:
    """Every fault in a node and what is in it."""
    for field, value in ast.iter_fields(node):
        if field in ("annotation", "returns", "decorator_list"):
            continue
        for child, swap in _children(node, field, value):
            if _is_for_checkers(child):
                continue
            within = place.inside(child)
            if isinstance(child, ast.expr):
                yield from _faults_of_expression(child, swap, place, within.holder)
            if isinstance(child, ast.stmt):
                for text in _of_statement(child):
                    yield Fault(place, child, text)
            if isinstance(child, ast.If | ast.IfExp | ast.While):
                if isinstance(child.test, ast.Name | ast.Call | ast.Attribute):
                    yield Fault(place, child.test, f"(not {ast.unparse(child.test)})")
            if isinstance(child, ast.FunctionDef):  # defaults are made where it is defined
                yield from _faults(child.args, place)
                yield from _faults(ast.Module(child.body, []), within)
            else:
                yield from _faults(child, within)


def _faults_of_expression(
    node: ast.expr, swap: Any, place: _Place, holder: ast.JoinedStr | None
) -> Iterator[Fault]:
    """Other expressions in the place of one, which may be a part of a formatted text, the holder."""
    for new in _of_expression(node):
        if holder is not None and node is not holder:
            # Where a part of such a text stands is not known before Python 3.12: it is written as a whole.
            swap(new)
            yield Fault(place, holder, ast.unparse(holder))
            swap(node)
        elif isinstance(new, ast.Constant):
            yield Fault(place, node, ast.unparse(new))
        else:
            yield Fault(place, node, f"({ast.unparse(new)})")


def _children(node: ast.AST, field: str, value: Any) -> Iterator[tuple[ast.AST, Any]]:
    """The nodes in a field, and what puts another in the place of each."""
    if isinstance(value, ast.AST):
        yield value, lambda new: setattr(node, field, new)
    elif isinstance(value, list):
        for i, child in enumerate(value):
            if isinstance(child, ast.AST):
                yield child, lambda new, i=i: value.__setitem__(i, new)


def _is_for_checkers(node: ast.AST) -> bool:
    """Whether a node only says something to people or to checkers of types."""
    if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):  # a docstring
        return True
    if getattr(node, "arg", "") == "strict":
        return True
    if isinstance(node, ast.Assert | ast.Import | ast.ImportFrom | ast.pattern | ast.arguments):
        return True
    if isinstance(node, ast.AnnAssign):
        return isinstance(node.annotation, ast.Name) and node.annotation.id == "TypeAlias"
    if isinstance(node, ast.If):
        return isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING"
    if isinstance(node, ast.Call):
        return isinstance(node.func, ast.Name) and node.func.id in TYPING
    if isinstance(node, ast.Subscript):
        return isinstance(node.value, ast.Name) and node.value.id in TYPING
    return False


def _of_expression(node: ast.expr) -> Iterator[ast.expr]:
    match node:
        case ast.Compare(ops=[*operators]):
            for i, operator in enumerate(operators):
                for table in (EDGES, OPPOSITES):
                    if type(operator) in table:
                        swapped = [*operators[:i], table[type(operator)](), *operators[i + 1 :]]
                        yield ast.Compare(node.left, swapped, node.comparators)
        case ast.BoolOp(op=ast.And()):
            yield ast.BoolOp(ast.Or(), node.values)
        case ast.BoolOp(op=ast.Or()):
            yield ast.BoolOp(ast.And(), node.values)
        case ast.UnaryOp(op=ast.Not() | ast.USub() | ast.Invert()):
            yield node.operand
        case ast.BinOp(op=operator) if type(operator) in ARITHMETIC and not _is_union(node):
            yield ast.BinOp(node.left, ARITHMETIC[type(operator)](), node.right)
        case ast.Constant(value=bool()):
            yield ast.Constant(not node.value)
        case ast.Constant(value=int() | float() as number):
            yield ast.Constant(number + 1)
            yield ast.Constant(number - 1)
        case ast.Call(func=ast.Name(id=name) | ast.Attribute(attr=name)) if (
            name in ("abs", "absolute") and node.args
        ):
            yield node.args[0]
        case ast.Name(id=name) if name in NAMES:
            yield ast.Name(NAMES[name])
        case ast.Attribute(attr=name) if name in NAMES:
            yield ast.Attribute(node.value, NAMES[name])


def _is_union(node: ast.BinOp) -> bool:
    """Whether it is a union of types, as far as its text tells."""
    if not isinstance(node.op, ast.BitOr):
        return False
    return _is_type(node.left) or _is_type(node.right)


def _is_type(node: ast.expr) -> bool:
    name, *_ = ast.unparse(node).split("[")
    *_, last_part = name.split(".")
    return last_part[:1].isupper() or last_part in TYPES


def _of_statement(node: ast.stmt) -> Iterator[str]:
    match node:
        case ast.Return(value=ast.expr() as value) if not (
            isinstance(value, ast.Constant) and value.value is None
        ):
            yield "return None"
        case ast.Expr(value=ast.Call()) | ast.Raise() | ast.AugAssign():
            yield "pass"
        case ast.Assign(targets=[ast.Attribute() | ast.Subscript(), *_]):
            yield "pass"
        case ast.Break():
            yield "continue"
        case ast.Continue():
            yield "break"


def _mutant(lines: list[bytes], fault: Fault) -> Mutant:
    node = fault.node
    begin, end = node.lineno - 1, node.end_lineno - 1
    head = lines[begin][: node.col_offset]
    tail = lines[end][node.end_col_offset :]
    changed = head + fault.text.encode() + tail
    lines_lost = b""
    if tail.endswith(b"\n"):
        lines_lost = b"\n" * (end - begin)  # other lines keep their numbers
    text = b"".join([*lines[:begin], changed, lines_lost, *lines[end + 1 :]])
    return Mutant(
        function=fault.place.qualified,
        line=node.lineno,
        first=_first_line(fault.place.outer),
        before=_in_one(b"".join(lines[begin : end + 1])),
        after=_in_one(changed),
        text=text.decode(),
    )


def _first_line(function: ast.FunctionDef | None) -> int:
    """Line of a function's definition with its decorators; 0 without one."""
    if function is None:
        return 0
    decorators = [decorator.lineno for decorator in function.decorator_list]
    return min([function.lineno, *decorators])


def _in_one(lines: bytes) -> str:
    return " ".join(lines.decode().split())
