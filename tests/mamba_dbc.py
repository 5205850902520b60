"""The file `mamba.dbc`: every node has frames of its own, so a program writes it. After a change of the messages:

python tests/mamba_dbc.py
"""

from pathlib import Path

from laticauda import protocol
from laticauda.protocol.can import LAYOUTS, NUMBERS

FILE = Path(protocol.__file__).with_name("mamba.dbc")
OPERATOR = "Operator"


def dbc_text() -> str:
    """The file's text."""
    nodes = [f"Node{number:02d}" for number in NUMBERS["node"]]
    lines = ['VERSION "1"', "", "NS_ :", "", "BS_:", "", "BU_: " + " ".join([OPERATOR, *nodes]), ""]
    remarks = [
        'CM_ "The CAN bus of the swimming snake robot Mamba: 1 Mbit/s, 11-bit identifiers, node 1 at the tail.";'
    ]
    values: list[str] = []
    for layout, number in ((one, number) for one in LAYOUTS for number in one.numbers):
        identifier, suffix = layout.identifier + number, {"": "", "node": f"{number:02d}", "group": str(number)}
        sender, hears = OPERATOR, ",".join(nodes)
        if layout.number == "node":
            sender, hears = nodes[number - 1], OPERATOR
        lines.append(f"BO_ {identifier} {layout.kind.__name__}{suffix[layout.number]}: {layout.length} {sender}")
        remarks.append(f'CM_ BO_ {identifier} "{layout.says}";')
        for name, kind, how, _, start, _, _, is_word in layout.signals:
            sign = "-" if how.signed else "+"
            lines.append(f' SG_ {name} : {start}|{how.bits}@1{sign} ({how.scale},0) [0|0] "{how.unit}" {hears}')
            if how.says:
                remarks.append(f'CM_ SG_ {identifier} {name} "{how.says}";')
            if is_word and kind is not bool:
                words = " ".join(f'{word.value} "{word.name}"' for word in kind)
                values.append(f"VAL_ {identifier} {name} {words} ;")
        lines.append("")
    return "\n".join([*lines, *remarks, *values, ""])


if __name__ == "__main__":
    FILE.write_text(dbc_text(), encoding="utf-8")
