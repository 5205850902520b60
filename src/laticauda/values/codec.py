"""Conversion between values and the plain tables of TOML and JSON, based only on field types; it knows no classes.

`decode` is strict: anything unknown or unusable is rejected with the key and the rule. `encode` is
its inverse. A table has the fields of a class as keys, with these short forms:

- a number in rad or rad/s may be given in degrees, under its name with ``_deg`` or ``_deg_s``;
- where several classes are possible (a union, or an `Extensible` base), the key ``kind`` selects
  one; a text in place of the table is that kind with its defaults;
- entries of a list of a class that is `counted` may have a ``count``; keys that the class lists
  under that name may be lists, through which the ``count`` objects cycle.

Keys of older files are known, see `laticauda.values.former_keys`.
"""

from laticauda.values.decoding import (
    MOST_COUNTED as MOST_COUNTED,
    decode as decode,
    keeping_unknown as keeping_unknown,
    updated as updated,
)
from laticauda.values.encoding import encode as encode
from laticauda.values.file_tables import (
    FORMAT as FORMAT,
    BadKey as BadKey,
    Table as Table,
    arguments_of as arguments_of,
    check_keys as check_keys,
    keys_of as keys_of,
    merge_tables as merge_tables,
    stamped as stamped,
    table_of as table_of,
    take_kind as take_kind,
)
from laticauda.values.former_keys import with_new_names as with_new_names
