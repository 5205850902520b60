"""Make the library of kernels with which single runs start without Numba, see `laticauda.models.planar.kernel_library`.

    python -m laticauda.connect.native.kernel_library

It is made by the installation (`build_hook.py`), and by this command after an edit of the kernels;
if the library is that of today's sources, nothing is done. It needs a C compiler. Where there is none, or no
such library for the system, Numba compiles the kernels when they are first needed.
"""

import hashlib
import sys
from pathlib import Path

from laticauda.connect.native import platforms
from laticauda.models.planar import kernel_library
from laticauda.values import MissingExtra, MissingProgram, files

FEATURES = ("avx", "avx2", "bmi", "bmi2", "f16c", "fma", "lzcnt", "movbe", "popcnt", "sse4.2")
"""Features of the processors that can use the library, the family x86-64-v3: most x86-64 processors since 2013.

`laticauda_fits_processor` in `kernels.c` looks for the same."""
PLATFORM = "linux64"
"""The only platform for which the library is made."""


def make_library(folder: Path) -> str:
    """Make the library in a folder unless it is there already; return why there is none, "" if there is one.

    Args:
        folder: Folder of the library, which is made.
    """
    contents = kernel_library.read_contents(folder)
    maker = _digest_of_maker()
    if contents is not None and contents.maker == maker:
        return ""
    platform = platforms.current_platform()
    if platform is None or platform.name != PLATFORM:
        return "none can be made for this system."
    # Numba is slow to import, and nothing may be left to do.
    from laticauda.connect.native.linking import LinkingFailed, find_compiler
    from laticauda.connect.native.usual_kernels import build_library

    try:
        find_compiler(platform)  # before compiling the kernels
        features = ",".join(f"+{feature}" for feature in FEATURES)
        library, contents = build_library(platform, features, maker)
    except (MissingProgram, MissingExtra, LinkingFailed) as error:
        return str(error)
    folder.mkdir(parents=True, exist_ok=True)
    # In this order, so that nobody takes the contents of one library for those of another.
    (folder / kernel_library.CONTENTS).unlink(missing_ok=True)
    files.write(folder / kernel_library.LIBRARY, library)
    files.write(folder / kernel_library.CONTENTS, contents.write())
    return ""


def _digest_of_maker() -> str:
    """Return the digest of what the library is made by, which is not needed to use it."""
    digest = hashlib.sha256()
    own = Path(__file__)
    for path in (own, own.with_name("usual_kernels.py"), platforms.C_FOLDER / "kernels.c"):
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


def main() -> None:
    """Make the library where the package looks for it, or say why not."""
    reason = make_library(kernel_library.FOLDER)
    if reason:
        sys.stderr.write(f"Without a library, the first run compiles its kernels: {reason}\n")


if __name__ == "__main__":
    main()
