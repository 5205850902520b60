"""Random damage to files that programs wrote, and to folders of studies."""

import random
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from bad_inputs import pantry
from bad_inputs.attempt import Answer, Case, fault, judge_command

READ_BY: dict[str, str] = {
    **{f"trial.{ending}": f"trial show trial.{ending}" for ending in pantry.FORMATS},
    "recording.mcap": "replay recording.mcap",
    "flow.nc": "swim --duration 0.1 --current flow.toml",
    "scene.xml": "swim --duration 0.05 --model spatial --scene scene.xml",
}
"""Commands that read a good file."""


def damaged_bytes(rng: random.Random, content: bytes) -> bytes:
    """Return a file's content with random damage.

    Args:
        rng: Source of the damage.
        content: The good content, not empty.
    """
    data = bytearray(content)
    change = rng.choice(("cut", "flip", "flip", "fill", "grow", "empty"))
    if change == "cut":
        del data[rng.randrange(len(data)) :]
    elif change == "flip":
        for _ in range(rng.choice((1, 8, 200))):
            data[rng.randrange(len(data))] ^= 1 << rng.randrange(8)
    elif change == "fill":
        begin = rng.randrange(len(data))
        data[begin : begin + 64] = bytes([rng.choice((0, 255))]) * 64
    elif change == "grow":
        data += b"\xff" * 1000
    else:
        data.clear()
    return bytes(data)


def damaged(rng: random.Random, folder: Path) -> Iterator[Case]:
    """Damaged trials, recordings, flows on a grid and MJCF files, read by commands."""
    names = sorted(name for name in READ_BY if (folder / name).exists())
    while True:
        name = rng.choice(names)
        content = damaged_bytes(rng, (folder / name).read_bytes())

        words = tuple(READ_BY[name].split())

        def attack(
            name: str = name, content: bytes = content, words: tuple[str, ...] = words
        ) -> Answer:
            pantry.lay_out(folder, words)
            Path(name).write_bytes(content)
            return judge_command(*words, names=(name, "--"))

        yield Case("damaged", f"{READ_BY[name]}, {len(content)} bytes of {name}", attack)


STUDIES = (
    "sweep --duration 0.1 --vary amplitude-deg=10,20 --output out",
    "optimize --duration 0.5 --vary amplitude-deg=10:20 --budget 4 --population 4 --output out",
)
ODD_JSON = (
    "[" * 100_000,
    "{}",
    "[]",
    '{"shape": 3, "region": {}}',
    "nan",
    '{"shape": [-1], "region": [0]}',
)
ZIP_FIELDS = ((6, 1), (8, 99), (4, 99))
"""Bytes of an entry's head, and what is written there: it is encrypted, of an unknown method or version."""


@dataclass(frozen=True, kw_only=True)
class DamagedStudy:
    """A study whose folder is damaged before it goes on."""

    words: tuple[str, ...]
    damage: str
    """`bytes`, `zip` or `text`."""
    seed: float

    def __call__(self) -> Answer:
        """Run the study, damage one of its files, and run it again."""
        judge_command(*self.words)
        rng = random.Random(self.seed)
        files = sorted(
            path for path in Path("out").rglob("*") if path.suffix in (".json", ".npz", ".done")
        )
        if not files:
            return fault("the study wrote no file")
        file = rng.choice([path for path in files if path.stat().st_size])
        if self.damage == "text" and file.suffix == ".json":
            file.write_text(rng.choice(ODD_JSON))
        elif self.damage == "zip" and file.suffix == ".npz":
            file.write_bytes(_odd_zip(rng, file.read_bytes()))
        else:
            file.write_bytes(damaged_bytes(rng, file.read_bytes()))
        return judge_command(*self.words, names=("out", "--output", "folder"))


def _odd_zip(rng: random.Random, content: bytes) -> bytes:
    """Return a zip whose entries say that they are encrypted, or of a method or a version that nobody has."""
    data = bytearray(content)
    offset, number = rng.choice(ZIP_FIELDS)
    for mark, further in ((b"PK\x03\x04", 0), (b"PK\x01\x02", 2)):
        begin = data.find(mark)
        while begin >= 0:
            data[begin + offset + further] = number
            begin = data.find(mark, begin + 1)
    return bytes(data)


def folders(rng: random.Random, folder: Path) -> Iterator[Case]:
    """Damaged folders of sweeps and optimizations, whose zip may be encrypted or of an odd method."""
    while True:
        words = tuple(rng.choice(STUDIES).split())
        damage = rng.choice(("bytes", "zip", "text"))
        attack = DamagedStudy(words=words, damage=damage, seed=rng.random())
        yield Case("folders", f"{words[0]}, {damage}, {attack.seed}", attack)
