"""The mutants of campaigns/mutants.py, the stored answer, and a small package that is asked in full."""

import ast
import json
import os
import subprocess
import sys
import textwrap

import pytest
from campaign_scripts import FOLDER, campaign

mutants = campaign("mutants")
mutants_of = mutants.mutants_of


def faults(code: str) -> list[str]:
    """The line of the first mutated statement, mutant by mutant, as Python writes it."""
    return [ast.unparse(ast.parse(one.after)) for one in mutants_of(code)]


@pytest.mark.parametrize(
    ("code", "expected"),
    [
        ("x = a < b", ["x = a <= b", "x = a >= b"]),
        ("x = a >= b", ["x = a > b", "x = a < b"]),
        ("x = a == b", ["x = a != b"]),
        ("x = a is b", ["x = a is not b"]),
        ("x = a in b", ["x = a not in b"]),
        ("x = a and b and c", ["x = a or b or c"]),
        ("x = not a", ["x = a"]),
        ("x = -a", ["x = a"]),
        ("x = a if b else c", ["x = a if not b else c"]),
        ("x = a + b", ["x = a - b"]),
        ("x = a // b", ["x = a / b"]),
        ("x = a ** b", ["x = a * b"]),
        ("x = a @ b", []),
        ("x = 3", ["x = 4", "x = 2"]),
        ("x = 0.5", ["x = 1.5", "x = -0.5"]),
        ("x = True", ["x = False"]),
        ("x = np.abs(a)", ["x = a"]),
        ("x = min(a, b)", ["x = max(a, b)"]),
        ("x = np.maximum(a, b)", ["x = np.minimum(a, b)"]),
        ("a.b = c", ["pass"]),
        ("a(b)", ["pass"]),
        ("a += b", ["pass"]),
        ("raise A", ["pass"]),
        ("x = f'{a + b} c'", ["x = f'{a - b} c'"]),
        ('"""text"""', []),
        ("assert a < b", []),
        ("x = 'text'", []),
        ("x: TypeAlias = A | B", []),
        ("x = cast('A', 1 + b)", []),
        ("zip(a, b, strict=True)", ["pass"]),
    ],
)
def test_a_mutant_is_one_small_fault_and_what_only_people_and_checkers_read_has_none(
    code, expected
):
    assert faults(code) == expected


def test_a_mutant_knows_its_function_and_changes_nothing_else():
    code = textwrap.dedent("""
        LIMIT = 2

        class A:
            @property
            def size(self, n: int = 3) -> int:
                def inside(k):
                    return k + n
                for i in n:
                    if i:
                        break
                return inside(
                    n
                )
    """)
    found = mutants_of(code)
    assert [(one.function, one.line, one.after) for one in found] == [
        ("", 2, "LIMIT = 3"),
        ("", 2, "LIMIT = 1"),
        ("", 6, "def size(self, n: int = 4) -> int:"),
        ("", 6, "def size(self, n: int = 2) -> int:"),
        ("A.size", 8, "return None"),
        ("A.size", 8, "return (k - n)"),
        ("A.size", 10, "if (not i):"),
        ("A.size", 11, "continue"),
        ("A.size", 12, "return None"),
    ]
    assert {one.first for one in found if one.function} == {5}  # its decorator's line
    for one in found:
        assert len(one.text.splitlines()) == len(code.splitlines())
        ast.parse(one.text)


def test_wilsons_interval_is_the_textbooks():
    assert mutants.wilson(85, 100) == pytest.approx((0.7672, 0.9069), abs=1e-4)
    assert mutants.wilson(10, 10)[1] == pytest.approx(1.0)
    assert mutants.wilson(0, 0) == (0.0, 1.0)


SOURCE = """
IS_OPEN = True


def within(x):
    return IS_OPEN and x < 3


def count(n):
    while n > 0:
        n -= 1
    return n
"""
TESTS = """
from small import count, within

def test_at_the_limit():
    assert within(2) and not within(3)

def test_count():
    assert count(4) == 0
"""
ASK = """
import sys
from pathlib import Path
import mutants
root = Path(sys.argv[1])
mutants.AT_LEAST = 0.7
target = mutants.Target(files=("small.py",), tests=("test_small.py",))
mutants.try_all(root, target, mutants.work_in(root, "small.py"), root / "progress")
"""


@pytest.mark.slow
def test_faults_are_noticed_hang_or_live_in_functions_and_where_a_file_is_imported(tmp_path):
    (tmp_path / "small.py").write_text(SOURCE)
    (tmp_path / "test_small.py").write_text(TESTS)
    (tmp_path / "pytest.ini").write_text("[pytest]\npythonpath = .\n")
    path = os.pathsep.join([str(FOLDER), *sys.path])
    words = [sys.executable, "-c", ASK, str(tmp_path)]
    subprocess.run(
        words, check=True, env={**os.environ, "PYTHONPATH": path}, cwd=tmp_path, timeout=120
    )
    rows = [json.loads(line) for line in (tmp_path / "progress").read_text().splitlines()]
    assert {row["after"]: row["outcome"] for row in rows} == {
        "IS_OPEN = False": "noticed",
        "return None": "noticed",
        "return (IS_OPEN or x < 3)": "noticed",
        "return IS_OPEN and (x <= 3)": "noticed",
        "return IS_OPEN and (x >= 3)": "noticed",
        "return IS_OPEN and x < 4": "noticed",
        "return IS_OPEN and x < 2": "noticed",
        "while (n >= 0):": "noticed",
        "while (n <= 0):": "noticed",
        "while n > 1:": "noticed",
        "while n > -1:": "noticed",
        "pass": "hung",
        "n -= 2": "alive",
        "n -= 0": "hung",
    }


def test_of_the_faults_in_safety_code_and_estimation_enough_are_noticed():
    rows = {row["file"]: row for row in mutants.stored()}
    asked = [file for target in mutants.TARGETS for file in target.files]
    assert set(rows) == {*asked, "all"}
    for part in ("tank/operate/safety", "control/estimation"):
        these = [row for file, row in rows.items() if part in file]
        tried, noticed = (sum(int(row[name]) for row in these) for name in ("tried", "seen"))
        assert tried == sum(int(row["mutants"]) for row in these)
        assert noticed / tried >= mutants.ENOUGH


def test_a_mutant_that_is_called_equivalent_is_one_that_can_be_made_and_has_a_reason():
    every = {
        mutants.key_of(work)
        for target in mutants.TARGETS
        for file in target.files
        for work in mutants.work_in(mutants.ROOT, file)
    }
    for key, reason in mutants.equivalents().items():
        assert key in every
        assert len(reason.split()) > 2
