"""Options that commands of several families have: declared once, so that they read alike everywhere.

An option belongs here if commands in different modules, or for different purposes, have it in the
same sense; each function declares one field, and its argument is what differs. Groups of options
that go together are classes, which commands inherit:

- robot, gait, water, ground and model by name, and a scenario file: `laticauda.cli.scene`;
- files that are written of a trial, and its film: `laticauda.cli.trial_output`;
- ``--json``: `laticauda.cli.command`.

An option of one command, or of one family, stands in the class of that command. Numbers of a robot,
a gait or water are not declared in this package at all: they are fields of those values, and become
flags by themselves (`laticauda.cli.flags`). How a flag is read is its type's matter
(`laticauda.cli.flag_types`).
"""

from collections.abc import Sequence

from laticauda.values import BadArgument, option, quantity
from laticauda.values.tables import parse_columns

THIS_COMPUTER = "127.0.0.1"
"""Address under which a server is reached from this computer only."""


def scheduler_option() -> str | None:
    """Declare the cluster that runs trials."""
    return option("Run on a Dask cluster: its scheduler, such as tcp://host:8786", default=None)


def share_option(kept_in: str, whole: str) -> str | None:
    """Declare the share of a study that a command runs, as one job of an array.

    Args:
        kept_in: What holds a share: a folder or a table.
        whole: Option that names what holds the whole study.
    """
    text = (
        f"Run share K of N only, given as K/N, in a {kept_in} of its own beside {whole}, as one job of an array; "
        "--merge puts all shares together"
    )
    return option(text, default=None)


def merge_option(whole: str) -> bool:
    """Declare that a command puts shares together.

    Args:
        whole: Option that names what holds the whole study.
    """
    text = f"Put the shares that lie beside {whole} together in it, instead of running anything"
    return option(text, default=False)


def check_way_of_running(share: str | None, scheduler: str | None, *, merge: bool) -> None:
    """Refuse options of studies that contradict each other.

    Args:
        share: What `--share` says.
        scheduler: What `--scheduler` says.
        merge: Whether `--merge` is given.
    """
    if share is not None and merge:
        raise BadArgument("share", "must not be given together with --merge: first all shares")
    if merge and scheduler is not None:
        raise BadArgument("scheduler", "must not be given with --merge, which runs no trial")


def threads_option(text: str = "Trials to run in parallel") -> int | None:
    """Declare the number of trials that run at a time.

    Args:
        text: What it is the number of.
    """
    return quantity("", f"{text}; one per core if omitted", ge=1, default=None)


def base_option(otherwise: str) -> str | None:
    """Declare the parameter file from which an identification takes all that it does not identify.

    Args:
        otherwise: Where that is from without a file.
    """
    text = f"Parameter file for all else, with a joint law; else {otherwise}"
    return option(text, default=None)


def joint_law_option() -> str | None:
    """Declare the joint law of trials that an identification simulates."""
    text = "How joints follow the gait; if omitted, the base's law or prescribed"
    return option(text, default=None)


def column_option(file_option: str) -> tuple[str, ...]:
    """Declare the names of columns that a table calls otherwise than we do.

    Args:
        file_option: Option that gives the table.
    """
    text = f'Columns of {file_option} that the file calls otherwise, such as time="t [s]"'
    return option(text, default=())


def read_columns(words: Sequence[str], file: str | None, file_option: str) -> dict[str, str]:
    """Return the names of columns in a file by ours.

    Args:
        words: What was typed behind `--column`.
        file: The table; None if there is none.
        file_option: Name of the option that gives it, without hyphens before it.

    Raises:
        ValueError: If a word has another form, or there is no table.
    """
    if words and file is None:
        rule = f"must be given with --{file_option}: it says what that file calls its columns"
        raise BadArgument("column", rule)
    return parse_columns(words)


def host_option(subject: str) -> str:
    """Declare the address of a server.

    Args:
        subject: What has this address.
    """
    return option(f"{subject}; {THIS_COMPUTER}: this computer only", default=THIS_COMPUTER)


def port_option(default: int) -> int:
    """Declare the port of a server.

    Args:
        default: Port that it usually has.
    """
    return quantity("", "Its port; 0: any free one", ge=0, le=65535, default=default)
