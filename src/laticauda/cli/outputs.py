"""Files that a command will write: refused before the work is done, and not after."""

import os
from collections.abc import Sequence
from pathlib import Path

from laticauda.errors import BadArgument


def check_output(option: str, path: str | None, suffixes: Sequence[str]) -> None:
    """Refuse a file that cannot be written.

    Args:
        option: Name of the option.
        path: What was given; None is fine.
        suffixes: What the file's name may end in.

    Raises:
        ValueError: If it ends otherwise, its folder does not exist, it is a folder, or may not be written.
    """
    if path is None:
        return
    file = Path(path)
    if file.suffix.lower() not in suffixes:
        raise BadArgument(option, f"must be a file that ends in {' or '.join(suffixes)}, got {path}")
    if not file.parent.is_dir():
        raise BadArgument(option, f"must be a file in a folder that exists, got {path}")
    if file.is_dir():
        raise BadArgument(option, f"must be a file, got the folder {path}")
    # A new file is put in the place of an old one, so the folder counts.
    if not os.access(file.parent, os.W_OK) or (file.exists() and not os.access(file, os.W_OK)):
        raise BadArgument(option, f"must be a file that may be written, got {path}: permission denied")
