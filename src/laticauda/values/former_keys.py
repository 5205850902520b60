"""Keys of older files: a table is brought to the current keys before it is read.

A class may list the keys of older files in `former`, each with its current place ("" for none), or
provide a function that converts such a table to the current form. Those of version 0.1 are in
`FORMER_KEYS`, by class name.
"""

from collections.abc import Callable, Mapping

from laticauda.values.file_tables import Table

FORMER_KEYS = {
    "Water": {
        "linear_drag": "drag.linear",
        "quadratic_drag": "drag.quadratic",
        "reference_speed": "drag.reference_speed",
        "sway_friction": "drag.sway_friction",
    },
    "Ground": {"regularization_speed": "friction.regularization_speed"},
    "ViscousFriction": {"regularization_speed": ""},  # it did not use it
}
"""Keys of version 0.1 with their current places, "" for none, by name of the class that a table describes."""


def with_new_names(kind: type, table: Table) -> Table:
    """Return a table of an older file with the current keys, for an object of class `kind`.

    Args:
        kind: Class that the table describes; its `former`, if any, defines the changes.
        table: Table as in the file.
    """
    of_version_0_1 = FORMER_KEYS.get(kind.__name__, {})
    former: Mapping[str, str] | Callable[[Table], Table] = getattr(kind, "former", of_version_0_1)
    if callable(former):
        return former(table)
    for former_key in former.keys() & table.keys():
        table = dict(table)
        value = table.pop(former_key)
        _put_unless_there(table, former[former_key], value)
    return table


def _put_unless_there(table: Table, place: str, value: object) -> None:
    """Put a value at its place in a table, unless there already is another one.

    Args:
        table: The table, which is changed; the tables in it are replaced by changed copies.
        place: Path to the key, such as ``drag.linear``; "" for none.
        value: The value.
    """
    *steps, last = place.split(".")
    for step in steps:
        part = table.get(step, {})
        if isinstance(part, str):  # short for a table that holds its kind alone
            part = {"kind": part}
        table[step] = dict(part)
        table = table[step]
    if last:
        table.setdefault(last, value)
