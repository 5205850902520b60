"""What there is to try: two short films of a robot, and the points that others tracked on a lamprey.

The films show a robot that swims, and glides, in a tank that was never built. They are rendered, by
`campaigns/example_films.py`, so that the truth is known: the coefficient of friction is 0.045. The
lamprey is a real one; its file says whose it is.
"""

from pathlib import Path

from laticauda.values import files

FOLDER = Path(__file__).parent / "example"
NAMES = ("swim.mp4", "glide.mp4", "tags.toml", "lamprey.csv")
"""What is in the folder."""


def write_example(folder: str | Path = ".") -> tuple[Path, ...]:
    """Write the films of the example, the file of their tags, and the points of a lamprey to a folder.

    Args:
        folder: The folder, which must exist.

    Returns:
        The paths of the files.

    Raises:
        StorageFailed: If they cannot be written.
    """
    paths: list[Path] = []
    for name in NAMES:
        path = Path(folder) / name
        files.write(path, (FOLDER / name).read_bytes())
        paths.append(path)
    return tuple(paths)
