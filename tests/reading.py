"""How hard the source is to read, by package, and the limits that may only fall.

    python tests/reading.py            # figures of today beside the limits
    python tests/reading.py --update   # lower the limits of what has become easier to read

The limits stand in reading.csv, one row a package (a folder of src/laticauda, or its modules that
stand in no folder). `--update` removes the rows of packages that are gone, and adds those of new
ones, which must meet `LIMITS_OF_A_NEW_PACKAGE`. Whoever moves old code to a new package that does
not meet them writes its row by hand. A figure says where to look; reading says what to do.
"""

import argparse
import ast
import csv
import io
import math
import sys
import tokenize
from dataclasses import asdict, astuple, dataclass, fields
from pathlib import Path

SOURCES = Path(__file__).parent.parent / "src" / "laticauda"
TABLE = Path(__file__).with_name("reading.csv")

COMPREHENSIONS = (ast.ListComp, ast.SetComp, ast.DictComp, ast.GeneratorExp)
LAYOUT_TOKENS = {
    tokenize.COMMENT,
    tokenize.NL,
    tokenize.NEWLINE,
    tokenize.INDENT,
    tokenize.DEDENT,
    tokenize.ENDMARKER,
}
"""Tokens that hold no code."""
VAGUE_NAMES = frozenset(
    "answer asked each found given got had has held here how is_it it item_ kept known made obj one "
    "ones other others put rest said says seen some stuff taken that them there thing things "
    "this told took wanted what when where which word words value_ data_ result_".split()
)
"""Names that say that something was got, but not what it is."""


@dataclass
class Count:
    """What is counted in the source of one package."""

    lines: int = 0
    """Lines that hold code."""
    tokens: int = 0
    statements: int = 0
    expressions: int = 0
    """A table, see `is_table`, is a single one."""
    conditional_expressions: int = 0
    nested_comprehensions: int = 0
    """Comprehensions that hold another one, or loop over more than one thing."""
    bound_names: int = 0
    """Variables and arguments, at each place where they get a value."""
    vague_names: int = 0

    def add_module(self, text: str) -> None:
        """Count one module.

        Args:
            text: Its source.
        """
        tree = ast.parse(text)
        self._add_tokens(text, docstring_lines(tree))
        nodes: list[ast.AST] = [tree]
        while nodes:
            node = nodes.pop()
            self._add_node(node)
            if not is_table(node):
                nodes += ast.iter_child_nodes(node)

    def _add_tokens(self, text: str, docstrings: set[int]) -> None:
        lines: set[int] = set()
        for token in tokenize.generate_tokens(io.StringIO(text).readline):
            first, last = token.start[0], token.end[0]
            if token.type in LAYOUT_TOKENS or first in docstrings:
                continue
            self.tokens += 1
            lines.update(range(first, last + 1))
        self.lines += len(lines)

    def _add_node(self, node: ast.AST) -> None:
        if isinstance(node, ast.stmt):
            self.statements += 1
        if isinstance(node, ast.expr):
            self.expressions += 1
        if isinstance(node, ast.IfExp):
            self.conditional_expressions += 1
        if is_nested_comprehension(node):
            self.nested_comprehensions += 1
        name = bound_name(node)
        if name is not None:
            self.bound_names += 1
            self.vague_names += name.lstrip("_") in VAGUE_NAMES


@dataclass(frozen=True)
class Figures:
    """How hard a package is to read; the larger, the harder."""

    tokens: float
    """Tokens per line of code."""
    expressions: float
    """Expressions per statement."""
    conditional: float
    """Conditional expressions, `a if b else c`, per 1000 lines of code."""
    nested: float
    """Comprehensions in or over another one, per 1000 lines of code."""
    vague: float
    """Share of vague names in all names that get a value [%]."""

    @classmethod
    def of(cls, count: Count) -> "Figures":
        """Return the figures of what was counted.

        Args:
            count: The count of a package.
        """
        lines = max(count.lines, 1)
        return cls(
            tokens=count.tokens / lines,
            expressions=count.expressions / max(count.statements, 1),
            conditional=1000.0 * count.conditional_expressions / lines,
            nested=1000.0 * count.nested_comprehensions / lines,
            vague=100.0 * count.vague_names / max(count.bound_names, 1),
        )


NAMES = tuple(field.name for field in fields(Figures))
STEPS = Figures(tokens=0.1, expressions=0.1, conditional=1.0, nested=0.5, vague=0.2)
"""Limits are multiples of these: a figure rounded up, so that formatting alone does not break one."""
CLEAR_GAINS = Figures(tokens=0.5, expressions=0.4, conditional=5.0, nested=2.0, vague=1.5)
"""By how much a figure may stay below its limit before the limit has to be lowered."""
LIMITS_OF_A_NEW_PACKAGE = Figures(
    tokens=11.0, expressions=7.0, conditional=25.0, nested=2.0, vague=2.0
)


class TooHard(Exception):
    """A package is harder to read than it may be."""


def docstring_lines(tree: ast.AST) -> set[int]:
    """Return the lines of docstrings, and of strings that document a field."""
    lines: set[int] = set()
    for node in ast.walk(tree):
        if (
            isinstance(node, ast.Expr)
            and isinstance(node.value, ast.Constant)
            and isinstance(node.value.value, str)
        ):
            lines.update(range(node.lineno, (node.end_lineno or node.lineno) + 1))
    return lines


def is_table(node: ast.AST) -> bool:
    """Return whether this is a dictionary of constants, or of lists, tuples and dictionaries of them."""
    if not isinstance(node, ast.Dict):
        return False
    kinds = (ast.Dict, ast.List, ast.Tuple, ast.Constant, ast.expr_context)
    return all(isinstance(part, kinds) for part in ast.walk(node))


def is_nested_comprehension(node: ast.AST) -> bool:
    """Return whether this is a comprehension that holds another one, or has two `for`."""
    if not isinstance(node, COMPREHENSIONS):
        return False
    inner = [child for child in ast.walk(node) if isinstance(child, COMPREHENSIONS)]
    return len(node.generators) > 1 or len(inner) > 1


def bound_name(node: ast.AST) -> str | None:
    """Return the name of the variable or argument that is bound here, if there is one."""
    if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
        return node.id
    if isinstance(node, ast.arg):
        return node.arg
    return None


def measure_packages(sources: Path = SOURCES) -> dict[str, Figures]:
    """Return the figures of every package, by its name."""
    counts: dict[str, Count] = {}
    for module in sorted(sources.rglob("*.py")):
        text = module.read_text(encoding="utf-8")
        if module.name == "__init__.py" and "lazy_exports(" in text:
            continue  # it lists names, one a line, which would dilute the figures
        parts = module.relative_to(sources).parts
        package = sources.name
        if len(parts) > 1:
            package = parts[0]
        count = counts.setdefault(package, Count())
        count.add_module(text)
    return {package: Figures.of(counts[package]) for package in sorted(counts)}


def read_limits(table: Path = TABLE) -> dict[str, Figures]:
    """Return the limits of every package, by its name."""
    limits: dict[str, Figures] = {}
    with table.open(newline="", encoding="utf-8") as lines:
        for row in csv.DictReader(lines):
            limits[row["package"]] = Figures(**{name: float(row[name]) for name in NAMES})
    return limits


def write_limits(limits: dict[str, Figures], table: Path = TABLE) -> None:
    """Write the limits of every package, sorted by its name."""
    rows = ["package," + ",".join(NAMES)]
    rows += [format_row(package, limits[package]) for package in sorted(limits)]
    table.write_text("\n".join(rows) + "\n", encoding="utf-8")


def format_row(package: str, limits: Figures) -> str:
    """Return the row of a package in the table."""
    return ",".join([package, *(f"{limit:.1f}" for limit in astuple(limits))])


def round_up(figures: Figures) -> Figures:
    """Return the limits that these figures just meet, see `STEPS`."""
    limits: dict[str, float] = {}
    for name, figure in asdict(figures).items():
        step = getattr(STEPS, name)
        limits[name] = round(math.ceil(figure / step - 1e-9) * step, 1)
    return Figures(**limits)


def names_above(figures: Figures, limits: Figures) -> list[str]:
    """Return which figures are above their limits."""
    return [name for name in NAMES if getattr(figures, name) > getattr(limits, name)]


def names_far_below(figures: Figures, limits: Figures) -> list[str]:
    """Return which figures are so far below their limits that these should be lowered."""
    names: list[str] = []
    for name in NAMES:
        gain = getattr(limits, name) - getattr(figures, name)
        if gain > getattr(CLEAR_GAINS, name):
            names.append(name)
    return names


def update_limits(measured: dict[str, Figures], limits: dict[str, Figures]) -> dict[str, Figures]:
    """Return the limits after a change: none is higher than before.

    Args:
        measured: The figures of every package that there is.
        limits: The limits before the change.

    Raises:
        TooHard: If a new package does not meet `LIMITS_OF_A_NEW_PACKAGE`.
    """
    updated: dict[str, Figures] = {}
    for package, figures in measured.items():
        reached = round_up(figures)
        if package in limits:
            updated[package] = lower_of(reached, limits[package])
            continue
        too_high = names_above(figures, LIMITS_OF_A_NEW_PACKAGE)
        if too_high:
            row = format_row(package, reached)
            raise TooHard(
                f"{package} is new and too hard to read ({', '.join(too_high)}); "
                f"if its code is old, write its row by hand:\n{row}"
            )
        updated[package] = reached
    return updated


def lower_of(first: Figures, second: Figures) -> Figures:
    """Return the lower one of each figure."""
    return Figures(**{name: min(getattr(first, name), getattr(second, name)) for name in NAMES})


def print_table(measured: dict[str, Figures], limits: dict[str, Figures]) -> None:
    """Print the figures of every package, each with its limit in brackets."""
    columns = "{:<14}" + "{:>20}" * len(NAMES)
    print(columns.format("package", *NAMES))
    for package, figures in measured.items():
        cells: list[str] = []
        for name in NAMES:
            limit = "none"
            if package in limits:
                limit = f"{getattr(limits[package], name):.1f}"
            cells.append(f"{getattr(figures, name):.1f} ({limit})")
        print(columns.format(package, *cells))


def main(arguments: list[str] | None = None) -> None:
    """Print the figures, or update the limits."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--update", action="store_true", help="lower the limits in reading.csv")
    options = parser.parse_args(arguments)
    measured = measure_packages()
    limits = read_limits()
    if not options.update:
        print_table(measured, limits)
        return
    try:
        write_limits(update_limits(measured, limits))
    except TooHard as error:
        sys.exit(str(error))


if __name__ == "__main__":
    main()
