"""Types of fields that are files, folders or words: how their flags are shown in the help, and read.

A field of such a type is declared like any other: ``save: TrialOutput = option("Write the trial", default=None)``.
An output carries a mark, `OutputFile`, by which it is checked before the work starts
(`laticauda.cli.output_files`). A field of the type `Internal` is no option, and a text whose default is
`REQUIRED` must be typed.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Any, Literal, TypeAlias, cast

import tyro
from tyro.constructors import PrimitiveConstructorSpec

Number: TypeAlias = int | Literal["*"]
"""How many words a flag takes; "*": any number."""


class BadFlag(Exception):
    """A flag that cannot be used; the message is the sentence that the user reads."""


@dataclass(frozen=True)
class OutputFile:
    """Mark for the name of a file that a command will write."""

    endings: tuple[str, ...] = ()
    """Allowed endings; if empty, those of the trial formats."""
    is_rendered: bool = False
    """Whether MuJoCo's renderer draws what is written."""


@dataclass(frozen=True)
class InternalMark:
    """Mark for a field that is no option."""


Internal = Annotated[Any, InternalMark()]
"""What a command knows of itself: no option, filled in while the command is read."""
REQUIRED = ""
"""Default of a text that must be typed, in a command that is read twice: `parse_command` asks for it.

Such a command is made once before its options are read, to hold the defaults of its numbers.
"""


def words_flag(
    *,
    n_words: Number,
    metavar: str,
    read: Callable[[list[str]], Any],
    show: Callable[[Any], list[str]] | None = None,
    choices: tuple[str, ...] | None = None,
) -> Any:
    """Return the specification of a flag that takes one or several words.

    Args:
        n_words: How many words it takes.
        metavar: What stands for them in the help.
        read: Function from the typed words to the value.
        show: Function from the default to its words in the help; None: `str` of it.
        choices: Accepted words; None: any.
    """
    return PrimitiveConstructorSpec[Any](
        nargs=n_words,
        metavar=metavar,
        instance_from_str=read,
        is_instance=lambda value: True,
        str_from_instance=show or show_default,
        choices=choices,
    )


def read_first(typed: list[str]) -> str:
    """Return the only word that was typed."""
    return typed[0]


def show_default(value: Any) -> list[str]:
    """Return the words of a default as the help shows them."""
    if isinstance(value, tuple):
        entries = [str(entry) for entry in cast("tuple[object, ...]", value)]
        return entries or ["none"]
    if value is None:
        return ["none"]
    return [str(value)]


def _path_flag(metavar: str, n_words: Number = 1) -> Any:
    """Return the specification of a flag that takes one or several names of files or folders."""

    def read(typed: list[str]) -> Any:
        if "" in typed:
            raise ValueError("must be the name of a file or a folder, got an empty text")
        if n_words == 1:
            return typed[0]
        return tuple(typed)

    return words_flag(n_words=n_words, metavar=metavar, read=read)


def _split_at_commas(typed: list[str]) -> tuple[str, ...]:
    return tuple(",".join(typed).split(","))


_NAMES_WITH_VALUES = words_flag(n_words="*", metavar="NAME=VALUES ...", read=tuple)
_COLUMN_NAMES = words_flag(n_words="*", metavar="NAME=HEADER ...", read=tuple)
_LISTED_NAMES = words_flag(n_words="*", metavar="NAME[,NAME...]", read=_split_at_commas)
_PRESET = words_flag(n_words=1, metavar="NAME|PATH", read=read_first)
_SCENARIO_FILE = words_flag(n_words=1, metavar="FILE", read=read_first)

# ---- flags: what is read -------------------------------------------------------------------------

File = Annotated[str | None, _path_flag("FILE")]
"""A file, or None."""
Files = Annotated[tuple[str, ...], _path_flag("FILE ...", "*")]
"""Any number of files."""
Words = Annotated[tuple[str, ...], _NAMES_WITH_VALUES]
"""Any number of words, most of them NAME=VALUES; the command reads them."""
ColumnNames = Annotated[tuple[str, ...], _COLUMN_NAMES]
"""Names of columns in a file by ours, NAME=HEADER (`laticauda.cli.shared_options.read_columns`)."""
NameList = Annotated[tuple[str, ...], _LISTED_NAMES]
"""Names, separated by commas or spaces."""

# ---- flags: what is written ----------------------------------------------------------------------

PICTURES = OutputFile((".png", ".pdf", ".svg"))
"""Mark for pictures and plots."""

RequiredFile = Annotated[str, _path_flag("FILE")]
"""A file that must be given; its mark says which endings it may have."""
TrialOutput = Annotated[File, OutputFile()]
"""A trial to be written, in any of its formats."""
PictureOutput = Annotated[File, PICTURES]
"""A picture to be written."""
VideoOutput = Annotated[File, OutputFile((".mp4",), is_rendered=True)]
"""A film in 3D to be written."""
FilmOutput = Annotated[File, OutputFile((".mp4", ".webp", ".gif"))]
"""A film seen from above to be written."""
TomlOutput = Annotated[File, OutputFile((".toml",))]
"""A TOML file to be written."""
Folder = Annotated[str, _path_flag("DIR")]
"""A folder."""
OptionalFolder = Annotated[str | None, _path_flag("DIR")]
"""A folder, or None."""

# ---- words without a flag, which stand behind the command ----------------------------------------

FileArgument = Annotated[str, tyro.conf.Positional, _path_flag("FILE")]
"""The file that the command is about."""
FileArguments = Annotated[tuple[str, ...], tyro.conf.Positional, _path_flag("FILES ...", "*")]
"""The files that the command is about."""
OutputArgument = Annotated[str, tyro.conf.Positional, _path_flag("OUTPUT")]
"""The file or folder that the command writes."""
PresetArgument = Annotated[str | None, tyro.conf.Positional, _PRESET]
"""A preset, or the path of a file."""
ScenarioArgument = Annotated[str | None, tyro.conf.Positional, _SCENARIO_FILE]
"""A scenario file, whose numbers the flags change."""
