"""The file `mamba.dbc`: every node has frames of its own, so a program writes it. After a change of the messages:

python tests/mamba_dbc.py
"""

from pathlib import Path

from laticauda.tank import protocol
from laticauda.tank.protocol.can import LAYOUTS, NOT_AVAILABLE, NUMBERS

FILE = Path(protocol.__file__).with_name("mamba.dbc")
OPERATOR = "Operator"
CYCLE = {
    "References": 10,
    "Sync": 10,
    "JointState": 10,
    "Loads": 50,
    "Acceleration": 50,
    "Heartbeat": 100,
}
"""Usual time between two frames; what is not there comes when it is needed [ms]."""


def dbc_text() -> str:
    """The file's text."""
    nodes = [f"Node{number:02d}" for number in NUMBERS["node"]]
    lines = ['VERSION "1"', "", "NS_ :", "", "BS_:", "", "BU_: " + " ".join([OPERATOR, *nodes]), ""]
    remarks = [
        'CM_ "The CAN bus of the swimming snake robot Mamba: 1 Mbit/s, 11-bit identifiers, node 1 at the tail.";'
    ]
    times = ['BA_DEF_ BO_ "GenMsgCycleTime" INT 0 65535;', 'BA_DEF_DEF_ "GenMsgCycleTime" 0;']
    values: list[str] = []
    for layout, number in ((one, number) for one in LAYOUTS for number in one.numbers):
        identifier, suffix = (
            layout.identifier + number,
            {"": "", "node": f"{number:02d}", "group": str(number)},
        )
        sender, hears = OPERATOR, ",".join(nodes)
        if layout.number == "node":
            sender, hears = nodes[number - 1], OPERATOR
        lines.append(
            f"BO_ {identifier} {layout.kind.__name__}{suffix[layout.number]}: {layout.length} {sender}"
        )
        remarks.append(f'CM_ BO_ {identifier} "{layout.says}";')
        if layout.kind.__name__ in CYCLE:
            times.append(f'BA_ "GenMsgCycleTime" BO_ {identifier} {CYCLE[layout.kind.__name__]};')
        for name, kind, how, _, start, low, _, is_word in layout.signals:
            sign = "-" if how.signed else "+"
            lines.append(
                f' SG_ {name} : {start}|{how.bits}@1{sign} ({how.scale},0) [0|0] "{how.unit}" {hears}'
            )
            if how.says:
                remarks.append(f'CM_ SG_ {identifier} {name} "{how.says}";')
            if is_word and kind is not bool:
                words = " ".join(f'{word.value} "{word.name}"' for word in kind)
                values.append(f"VAL_ {identifier} {name} {words} ;")
            if low == NOT_AVAILABLE:
                values.append(f'VAL_ {identifier} {name} {low} "not available" ;')
        lines.append("")
    return "\n".join([*lines, *remarks, *times, *values, ""])


if __name__ == "__main__":
    FILE.write_text(dbc_text(), encoding="utf-8")
