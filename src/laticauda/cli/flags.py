"""What commands import to declare their options, and to ask how they are spelled and what was typed.

- `flag_types`: types of fields that are files, folders or words;
- `flag_names`: which fields are options, how each is spelled, and whether it was typed;
- `declared_flags`: `parse_command`, which makes a command of the words that were typed;
- `number_flags`: flags that take numbers, in the unit that people type;
- `wave_flags`: flags of a gait's optional waves;
- `shared_options`: options that several families of commands have.
"""

from laticauda.cli.declared_flags import parse_command as parse_command, wrap_text as wrap_text
from laticauda.cli.flag_names import (
    Options as Options,
    is_declared as is_declared,
    marks_of as marks_of,
    options_of as options_of,
    parts_of as parts_of,
    spell_field as spell_field,
    spell_fields_in as spell_fields_in,
    spell_flag as spell_flag,
    spell_option as spell_option,
    spell_part_of_file as spell_part_of_file,
    spell_typed_flag as spell_typed_flag,
    was_typed as was_typed,
)
from laticauda.cli.flag_types import (
    PICTURES as PICTURES,
    REQUIRED as REQUIRED,
    BadFlag as BadFlag,
    ColumnNames as ColumnNames,
    File as File,
    FileArgument as FileArgument,
    FileArguments as FileArguments,
    Files as Files,
    FilmOutput as FilmOutput,
    Folder as Folder,
    Internal as Internal,
    NameList as NameList,
    OptionalFolder as OptionalFolder,
    OutputArgument as OutputArgument,
    OutputFile as OutputFile,
    PictureOutput as PictureOutput,
    PresetArgument as PresetArgument,
    RequiredFile as RequiredFile,
    ScenarioArgument as ScenarioArgument,
    TomlOutput as TomlOutput,
    TrialOutput as TrialOutput,
    VideoOutput as VideoOutput,
    Words as Words,
)
from laticauda.cli.number_flags import accept_objects as accept_objects
from laticauda.values.packaging import renamed_names

# Names of 0.2, for one release.
__getattr__ = renamed_names(
    __name__,
    {
        "Input": "FileArgument",
        "Inputs": "FileArguments",
        "Listed": "NameList",
        "Made": "RequiredFile",
        "Mp4": "VideoOutput",
        "Output": "OutputArgument",
        "Picture": "PictureOutput",
        "Place": "OptionalFolder",
        "Preset": "PresetArgument",
        "ScenarioFile": "ScenarioArgument",
        "Stored": "TrialOutput",
        "Toml": "TomlOutput",
        "read": "parse_command",
    },
)
