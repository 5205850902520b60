"""What all else is made of: declared quantities, values as tables, files, extension points, errors."""

from typing import TYPE_CHECKING

from laticauda.values.packaging import lazy_exports

if TYPE_CHECKING:
    from laticauda.values.access import LOCAL as LOCAL, ServerAccess as ServerAccess
    from laticauda.values.angles import (
        from_quaternion as from_quaternion,
        to_quaternion as to_quaternion,
        wrap_to_pi as wrap_to_pi,
        wrapped as wrapped,
    )
    from laticauda.values.annotations import (
        Annotation as Annotation,
        TupleAnnotation as TupleAnnotation,
        is_tuple as is_tuple,
    )
    from laticauda.values.arguments import explain as explain
    from laticauda.values.checks import (
        check_choice as check_choice,
        check_finite as check_finite,
        check_flag as check_flag,
        check_hostname as check_hostname,
        check_instance as check_instance,
        check_label as check_label,
        check_not_empty as check_not_empty,
        check_not_negative as check_not_negative,
        check_positive as check_positive,
        check_text as check_text,
        check_whole_number as check_whole_number,
        check_within as check_within,
        show_value as show_value,
        suggest_nearest as suggest_nearest,
    )
    from laticauda.values.codec import (
        BadKey as BadKey,
        Table as Table,
        decode as decode,
        encode as encode,
        keys_of as keys_of,
        stamped as stamped,
        take_kind as take_kind,
    )
    from laticauda.values.display_units import (
        DisplayUnit as DisplayUnit,
        display_unit as display_unit,
    )
    from laticauda.values.errors import (
        BadArgument as BadArgument,
        ClusterFailed as ClusterFailed,
        ImplausibleWarning as ImplausibleWarning,
        InfeasibleWarning as InfeasibleWarning,
        LaticaudaError as LaticaudaError,
        MissingExtra as MissingExtra,
        MissingProgram as MissingProgram,
        RobotFileError as RobotFileError,
        RunFailed as RunFailed,
        SimulationFailed as SimulationFailed,
        SkippedRowsWarning as SkippedRowsWarning,
        StorageFailed as StorageFailed,
        StoredResultsWarning as StoredResultsWarning,
        TableWarning as TableWarning,
        TrialFileError as TrialFileError,
        UnitWarning as UnitWarning,
        as_sentence as as_sentence,
    )
    from laticauda.values.misnamed import Suggesting as Suggesting, hint_at as hint_at
    from laticauda.values.named_arguments import by_name_only as by_name_only
    from laticauda.values.notices import warn_caller as warn_caller
    from laticauda.values.extensions import (
        Extensible as Extensible,
        Unknown as Unknown,
        name_of as name_of,
    )
    from laticauda.values.fast_values import make_quickly as make_quickly
    from laticauda.values.files import (
        csv_text as csv_text,
        is_full as is_full,
        local as local,
        locked as locked,
        parse_toml as parse_toml,
        read_text as read_text,
        read_toml as read_toml,
        to_json as to_json,
        to_plain as to_plain,
        write as write,
    )
    from laticauda.values.formulas import (
        Formula as Formula,
        Law as Law,
        MOST_NUMBERS as MOST_NUMBERS,
        OfFunction as OfFunction,
    )
    from laticauda.values.hdf5 import HDF5_SIGNATURE as HDF5_SIGNATURE, check_heaps as check_heaps
    from laticauda.values.interrupts import defer_interrupts as defer_interrupts
    from laticauda.values.optional import (
        load_mujoco as load_mujoco,
        optional_import as optional_import,
    )
    from laticauda.values.packaging import (
        __version__ as __version__,
        lazy_exports as lazy_exports,
        renamed_names as renamed_names,
    )
    from laticauda.values.quantities import (
        Check as Check,
        Field as Field,
        LARGEST as LARGEST,
        Quantity as Quantity,
        check_items as check_items,
        check_one_among as check_one_among,
        describe_field as describe_field,
        describe_fields as describe_fields,
        docstring_without_fields as docstring_without_fields,
        fields_of as fields_of,
        hints_of as hints_of,
        html_table as html_table,
        option as option,
        quantities_of as quantities_of,
        quantity as quantity,
        show_call as show_call,
        texts_of as texts_of,
        value_class as value_class,
    )
    from laticauda.values.scalars import (
        first_lane as first_lane,
        magnitude as magnitude,
        table_address as table_address,
        table_row as table_row,
        tanh as tanh,
        where as where,
    )
    from laticauda.values.tables.opening import read_columns as read_columns, read_rows as read_rows
    from laticauda.values.sums import add_up as add_up
    from laticauda.values.series import (
        DIRECTIONS as DIRECTIONS,
        REQUESTED_SERIES as REQUESTED_SERIES,
        LINK_FORCE as LINK_FORCE,
        Log as Log,
        OPTIONAL_SERIES as OPTIONAL_SERIES,
        SERIES as SERIES,
        SIGNAL as SIGNAL,
        Series as Series,
        as_floats as as_floats,
        concatenated as concatenated,
        log_of as log_of,
    )

__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {},
    plain={
        "laticauda.values.access": ["LOCAL", "ServerAccess"],
        "laticauda.values.angles": ["from_quaternion", "to_quaternion", "wrap_to_pi", "wrapped"],
        "laticauda.values.annotations": ["Annotation", "TupleAnnotation", "is_tuple"],
        "laticauda.values.arguments": ["explain"],
        "laticauda.values.checks": [
            "check_choice",
            "check_finite",
            "check_flag",
            "check_hostname",
            "check_instance",
            "check_label",
            "check_not_empty",
            "check_not_negative",
            "check_positive",
            "check_text",
            "check_whole_number",
            "check_within",
            "show_value",
            "suggest_nearest",
        ],
        "laticauda.values.codec": [
            "BadKey",
            "Table",
            "decode",
            "encode",
            "keys_of",
            "stamped",
            "take_kind",
        ],
        "laticauda.values.display_units": ["DisplayUnit", "display_unit"],
        "laticauda.values.errors": [
            "BadArgument",
            "ClusterFailed",
            "ImplausibleWarning",
            "InfeasibleWarning",
            "LaticaudaError",
            "MissingExtra",
            "MissingProgram",
            "RobotFileError",
            "RunFailed",
            "SimulationFailed",
            "SkippedRowsWarning",
            "StorageFailed",
            "StoredResultsWarning",
            "TableWarning",
            "TrialFileError",
            "UnitWarning",
            "as_sentence",
        ],
        "laticauda.values.misnamed": ["Suggesting", "hint_at"],
        "laticauda.values.named_arguments": ["by_name_only"],
        "laticauda.values.notices": ["warn_caller"],
        "laticauda.values.extensions": ["Extensible", "Unknown", "name_of"],
        "laticauda.values.fast_values": ["make_quickly"],
        "laticauda.values.files": [
            "csv_text",
            "is_full",
            "local",
            "locked",
            "parse_toml",
            "read_text",
            "read_toml",
            "to_json",
            "to_plain",
            "write",
        ],
        "laticauda.values.formulas": ["Formula", "Law", "MOST_NUMBERS", "OfFunction"],
        "laticauda.values.hdf5": ["HDF5_SIGNATURE", "check_heaps"],
        "laticauda.values.interrupts": ["defer_interrupts"],
        "laticauda.values.optional": ["load_mujoco", "optional_import"],
        "laticauda.values.packaging": ["__version__", "lazy_exports", "renamed_names"],
        "laticauda.values.quantities": [
            "Check",
            "Field",
            "LARGEST",
            "Quantity",
            "check_items",
            "check_one_among",
            "describe_field",
            "describe_fields",
            "docstring_without_fields",
            "fields_of",
            "hints_of",
            "html_table",
            "option",
            "quantities_of",
            "quantity",
            "show_call",
            "texts_of",
            "value_class",
        ],
        "laticauda.values.scalars": [
            "first_lane",
            "magnitude",
            "table_address",
            "table_row",
            "tanh",
            "where",
        ],
        "laticauda.values.tables.opening": ["read_columns", "read_rows"],
        "laticauda.values.sums": ["add_up"],
        "laticauda.values.series": [
            "DIRECTIONS",
            "REQUESTED_SERIES",
            "LINK_FORCE",
            "Log",
            "OPTIONAL_SERIES",
            "SERIES",
            "SIGNAL",
            "Series",
            "as_floats",
            "concatenated",
            "log_of",
        ],
    },
)
