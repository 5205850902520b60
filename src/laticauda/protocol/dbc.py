"""The text of `mamba.dbc`: every node has frames of its own, so the file is written by a program.

After a change: ``python -c "from laticauda.protocol import dbc; dbc.FILE.write_text(dbc.dbc_text())"``.
"""

from dataclasses import dataclass
from pathlib import Path

from laticauda.protocol.messages import N_GROUPS, N_NODES, PER_FRAME, NodeState, Order, Result

FILE = Path(__file__).with_name("mamba.dbc")
OPERATOR = "Operator"


@dataclass(frozen=True)
class Signal:
    """One number in a frame, least significant byte first."""

    name: str
    bits: int
    signed: bool = False
    scale: str = "1"
    unit: str = ""
    says: str = ""
    words: type[NodeState] | type[Order] | type[Result] | None = None


@dataclass(frozen=True)
class Layout:
    """One kind of frame."""

    name: str
    identifier: int
    signals: tuple[Signal, ...]
    says: str
    per_node: bool = False
    count: int = 1

    @property
    def length(self) -> int:
        """Bytes of data."""
        return sum(signal.bits for signal in self.signals) // 8


def _words(name: str, scale: str, unit: str, says: str) -> Signal:
    return Signal(name, 16, True, scale, unit, says)


FLAGS = (
    "Leak",
    "OverTemperature",
    "OverCurrent",
    "Stuck",
    "ReferencesLost",
    "EmergencyStopped",
    "NotCalibrated",
    "BusErrors",
)
LAYOUTS = (
    Layout("EmergencyStop", 0x001, (Signal("Reason", 8),), "All motors off until cleared."),
    Layout(
        "NodeCommand",
        0x010,
        (
            Signal("Node", 8, says="0: all nodes"),
            Signal("Order", 8, words=Order),
            _words("Angle", "0.0001", "rad", "SET_ZERO: what the present joint angle shall read"),
        ),
        "An order to one node or to all.",
    ),
    Layout(
        "References",
        0x100,
        tuple(_words(f"Angle{k + 1}", "0.0001", "rad", "reference angle") for k in range(PER_FRAME)),
        "Reference angles of four joints; they count from the next Sync on.",
        count=N_GROUPS,
    ),
    # Behind the references: were it of higher priority, it could overtake those that it is meant for.
    Layout("Sync", 0x180, (Signal("Counter", 16),), "References count from here; every node measures and answers."),
    Layout(
        "JointState",
        0x200,
        (
            _words("Angle", "0.0001", "rad", "joint angle"),
            _words("Rate", "0.001", "rad/s", "joint rate"),
            _words("Current", "0.001", "A", "motor current"),
            _words("Torque", "0.001", "Nm", "motor torque at the joint"),
        ),
        "The answer to every Sync.",
        per_node=True,
    ),
    Layout(
        "Loads",
        0x280,
        (
            _words("ForceAlong", "0.01", "N", "force/torque sensor; -32768: not available"),
            _words("ForceLeft", "0.01", "N", "force/torque sensor; -32768: not available"),
            _words("ForceUp", "0.01", "N", "force/torque sensor; -32768: not available"),
            _words("Torque", "0.001", "Nm", "force/torque sensor, about the joint's axis"),
        ),
        "The force/torque sensor.",
        per_node=True,
    ),
    Layout(
        "Acceleration",
        0x300,
        (
            _words("Along", "0.001", "m/s2", "accelerometer"),
            _words("Left", "0.001", "m/s2", "accelerometer"),
            _words("Up", "0.001", "m/s2", "accelerometer"),
        ),
        "The accelerometer.",
        per_node=True,
    ),
    Layout(
        "Heartbeat",
        0x700,
        (
            Signal("State", 8, words=NodeState),
            *(Signal(name, 1) for name in FLAGS),
            _words("Temperature", "0.1", "degC", "of the motor"),
            Signal("Voltage", 16, False, "0.01", "V", "of the supply"),
            Signal("ErrorCount", 8, says="transmit errors"),
            Signal("Counter", 8, says="one more every time"),
        ),
        "How a node is.",
        per_node=True,
    ),
    Layout(
        "CommandReply",
        0x780,
        (Signal("Order", 8), Signal("Result", 8, words=Result), Signal("State", 8, words=NodeState)),
        "The answer to a NodeCommand.",
        per_node=True,
    ),
)


def frames() -> list[tuple[int, str, str, Layout]]:
    """Identifier, name and sender of every frame there is."""
    found: list[tuple[int, str, str, Layout]] = []
    for layout in LAYOUTS:
        if layout.per_node:
            found += [(layout.identifier + i, f"{layout.name}{i:02d}", node(i), layout) for i in range(1, N_NODES + 1)]
        elif layout.count > 1:
            found += [(layout.identifier + k, f"{layout.name}{k}", OPERATOR, layout) for k in range(layout.count)]
        else:
            found.append((layout.identifier, layout.name, OPERATOR, layout))
    return found


def node(number: int) -> str:
    """The name of a node in the file."""
    return f"Node{number:02d}"


def dbc_text() -> str:
    """The file's text."""
    nodes = [OPERATOR, *(node(i) for i in range(1, N_NODES + 1))]
    lines = ['VERSION "1"', "", "NS_ :", "", "BS_:", "", "BU_: " + " ".join(nodes), ""]
    remarks = [
        'CM_ "The CAN bus of the swimming snake robot Mamba: 1 Mbit/s, 11-bit identifiers, node 1 at the tail.";'
    ]
    values: list[str] = []
    for identifier, name, sender, layout in frames():
        lines.append(f"BO_ {identifier} {name}: {layout.length} {sender}")
        remarks.append(f'CM_ BO_ {identifier} "{layout.says}";')
        hears = OPERATOR if layout.per_node else ",".join(nodes[1:])
        start = 0
        for signal in layout.signals:
            lines.append(f" SG_ {signal.name} : {start}|{signal.bits}@1{_range(signal)} {hears}")
            if signal.says:
                remarks.append(f'CM_ SG_ {identifier} {signal.name} "{signal.says}";')
            if signal.words is not None:
                words = " ".join(f'{word.value} "{word.name}"' for word in signal.words)
                values.append(f"VAL_ {identifier} {signal.name} {words} ;")
            start += signal.bits
        lines.append("")
    return "\n".join([*lines, *remarks, *values, ""])


def _range(signal: Signal) -> str:
    return f'{"-" if signal.signed else "+"} ({signal.scale},0) [0|0] "{signal.unit}"'
