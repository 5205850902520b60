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
from typing import Any

EDGES = {ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE, ast.GtE: ast.Gt}
OPPOSITES: dict[type[ast.cmpop], type[ast.cmpop]] = {
    **{
        ast.Lt: ast.GtE,
        ast.GtE: ast.Lt,
        ast.Gt: ast.LtE,
        ast.LtE: ast.Gt,
        ast.Eq: ast.NotEq,
        ast.NotEq: ast.Eq,
    },
    **{ast.Is: ast.IsNot, ast.IsNot: ast.Is, ast.In: ast.NotIn, ast.NotIn: ast.In},
}
ARITHMETIC: dict[type[ast.operator], type[ast.operator]] = {
    **{
        ast.Add: ast.Sub,
        ast.Sub: ast.Add,
        ast.Mult: ast.Div,
        ast.Div: ast.Mult,
        ast.FloorDiv: ast.Div,
    },
    **{ast.Mod: ast.Mult, ast.Pow: ast.Mult, ast.LShift: ast.RShift, ast.RShift: ast.LShift},
    **{ast.BitAnd: ast.BitOr, ast.BitOr: ast.BitAnd},
}
NAMES = {
    "min": "max",
    "max": "min",
    "any": "all",
    "all": "any",
    "minimum": "maximum",
    "maximum": "minimum",
}
TYPING = ("Literal", "Annotated", "TypeVar", "cast")


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
    found = {one.text: one for one in (_mutant(lines, *fault) for fault in _faults(tree, _Place()))}
    return list(found.values())


@dataclass(frozen=True)
class _Place:
    """Where a node is."""

    names: tuple[str, ...] = ()
    outer: ast.FunctionDef | None = None
    qualified: str = ""
    holder: ast.JoinedStr | None = None

    def inside(self, node: ast.AST) -> "_Place":
        if isinstance(node, ast.JoinedStr):
            return _Place(self.names, self.outer, self.qualified, self.holder or node)
        if isinstance(node, ast.ClassDef):
            return _Place((*self.names, node.name), self.outer, self.qualified, None)
        if isinstance(node, ast.FunctionDef):
            names = (*self.names, node.name)
            return _Place(names, self.outer or node, self.qualified or ".".join(names), None)
        return self


Fault = tuple[_Place, ast.AST, str]


def _faults(node: ast.AST, place: _Place) -> Iterator[Fault]:
    """The place, the node that is written anew, and how, of every fault in a node and what is in it."""
    for field, value in ast.iter_fields(node):
        if field in ("annotation", "returns", "decorator_list"):
            continue
        for child, swap in _children(node, field, value):
            if _is_for_checkers(child):
                continue
            within = place.inside(child)
            for new in _of_expression(child) if isinstance(child, ast.expr) else ():
                if within.holder is None or child is within.holder:
                    yield (
                        place,
                        child,
                        ast.unparse(new)
                        if isinstance(new, ast.Constant)
                        else f"({ast.unparse(new)})",
                    )
                else:  # where a part of such a text stands is not known before Python 3.12: it is written as a whole
                    swap(new)
                    yield place, within.holder, ast.unparse(within.holder)
                    swap(child)
            if isinstance(child, ast.stmt):
                yield from ((place, child, text) for text in _of_statement(child))
            if isinstance(child, ast.If | ast.IfExp | ast.While) and isinstance(
                child.test, ast.Name | ast.Call | ast.Attribute
            ):
                yield place, child.test, f"(not {ast.unparse(child.test)})"
            if isinstance(child, ast.FunctionDef):  # defaults are made where it is defined
                yield from _faults(child.args, place)
                yield from _faults(ast.Module(child.body, []), within)
            else:
                yield from _faults(child, within)


def _children(node: ast.AST, field: str, value: Any) -> Iterator[tuple[ast.AST, Any]]:
    """The nodes in a field, and what puts another in the place of each."""
    if isinstance(value, ast.AST):
        yield value, lambda new: setattr(node, field, new)
    elif isinstance(value, list):
        for i, one in enumerate(value):
            if isinstance(one, ast.AST):
                yield one, lambda new, i=i: value.__setitem__(i, new)


def _is_for_checkers(node: ast.AST) -> bool:
    """Whether a node only says something to people or to checkers of types."""
    if (isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)) or getattr(
        node, "arg", ""
    ) == "strict":
        return True
    if isinstance(node, ast.Assert | ast.Import | ast.ImportFrom | ast.pattern | ast.arguments):
        return True
    if isinstance(node, ast.AnnAssign):
        return isinstance(node.annotation, ast.Name) and node.annotation.id == "TypeAlias"
    if isinstance(node, ast.If):
        return isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING"
    called = (
        node.func
        if isinstance(node, ast.Call)
        else node.value
        if isinstance(node, ast.Subscript)
        else None
    )
    return isinstance(called, ast.Name) and called.id in TYPING


def _of_expression(node: ast.expr) -> Iterator[ast.expr]:
    match node:
        case ast.Compare(ops=[*operators]):
            for i, one in enumerate(operators):
                for table in (EDGES, OPPOSITES):
                    if type(one) in table:
                        swapped = [*operators[:i], table[type(one)](), *operators[i + 1 :]]
                        yield ast.Compare(node.left, swapped, node.comparators)
        case ast.BoolOp(op=one):
            yield ast.BoolOp(ast.Or() if isinstance(one, ast.And) else ast.And(), node.values)
        case ast.UnaryOp(op=ast.Not() | ast.USub() | ast.Invert()):
            yield node.operand
        case ast.BinOp(op=one) if type(one) in ARITHMETIC and not _is_union(node):
            yield ast.BinOp(node.left, ARITHMETIC[type(one)](), node.right)
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
    ends = [ast.unparse(one).split("[")[0].split(".")[-1] for one in (node.left, node.right)]
    return any(
        end[:1].isupper() or end in ("None", "int", "float", "bool", "str", "list", "tuple")
        for end in ends
    )


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


def _mutant(lines: list[bytes], place: _Place, node: Any, new: str) -> Mutant:
    begin, end = node.lineno - 1, node.end_lineno - 1
    head, tail = lines[begin][: node.col_offset], lines[end][node.end_col_offset :]
    changed = head + new.encode() + tail
    text = b"".join(
        [
            *lines[:begin],
            changed,
            b"\n" * (end - begin) if tail.endswith(b"\n") else b"",
            *lines[end + 1 :],
        ]
    )
    outer = place.outer
    first = (
        0 if outer is None else min([outer.lineno, *(one.lineno for one in outer.decorator_list)])
    )
    return Mutant(
        function=place.qualified,
        line=node.lineno,
        first=first,
        before=_in_one(b"".join(lines[begin : end + 1])),
        after=_in_one(changed),
        text=text.decode(),
    )


def _in_one(lines: bytes) -> str:
    return " ".join(lines.decode().split())
