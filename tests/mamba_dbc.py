"""The file `mamba.dbc`: every node has frames of its own, so a program writes it. After a change of the messages:

python tests/mamba_dbc.py
"""

from pathlib import Path

from laticauda.tank import protocol
from laticauda.tank.protocol.layouts import FRAME_NUMBERS, LAYOUTS
from laticauda.tank.protocol.packing import NOT_AVAILABLE

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
    nodes = [f"Node{number:02d}" for number in FRAME_NUMBERS["node"]]
    lines = ['VERSION "1"', "", "NS_ :", "", "BS_:", "", "BU_: " + " ".join([OPERATOR, *nodes]), ""]
    remarks = [
        'CM_ "The CAN bus of the swimming snake robot Mamba: 1 Mbit/s, 11-bit identifiers, node 1 at the tail.";'
    ]
    times = ['BA_DEF_ BO_ "GenMsgCycleTime" INT 0 65535;', 'BA_DEF_DEF_ "GenMsgCycleTime" 0;']
    values: list[str] = []
    for layout in LAYOUTS:
        for number in layout.numbers:
            identifier = layout.identifier + number
            name = layout.kind.__name__
            suffix = {"": "", "node": f"{number:02d}", "group": str(number)}[layout.number]
            sender, receivers = OPERATOR, ",".join(nodes)
            if layout.number == "node":
                sender, receivers = nodes[number - 1], OPERATOR
            lines.append(f"BO_ {identifier} {name}{suffix}: {layout.length} {sender}")
            remarks.append(f'CM_ BO_ {identifier} "{layout.description}";')
            if name in CYCLE:
                times.append(f'BA_ "GenMsgCycleTime" BO_ {identifier} {CYCLE[name]};')
            for entry in layout.signals:
                signal = entry.signal
                sign = "-" if signal.signed else "+"
                bits = f"{entry.start}|{signal.bits}@1{sign}"
                lines.append(
                    f" SG_ {entry.name} : {bits} ({signal.scale},0) [0|0] "
                    f'"{signal.unit}" {receivers}'
                )
                if signal.description:
                    remarks.append(f'CM_ SG_ {identifier} {entry.name} "{signal.description}";')
                if entry.is_symbol and entry.kind is not bool:
                    words = " ".join(f'{word.value} "{word.name}"' for word in entry.kind)
                    values.append(f"VAL_ {identifier} {entry.name} {words} ;")
                if entry.low == NOT_AVAILABLE:
                    values.append(f'VAL_ {identifier} {entry.name} {entry.low} "not available" ;')
            lines.append("")
    return "\n".join([*lines, *remarks, *times, *values, ""])


if __name__ == "__main__":
    FILE.write_text(dbc_text(), encoding="utf-8")
