"""Make the font in which the docs show formulas: `python docs/make_font.py`, which `make docs` does.

Browsers have no font for formulas on every system. This is what the docs need of STIX Two Math
(under the SIL Open Font License 1.1, which the font's own records say), as it comes with ziamath,
under a name of its own.
"""

from importlib.util import find_spec
from pathlib import Path

from fontTools import subset

FONT = Path(__file__).parent / "made" / "formulas.woff"
RANGES = (
    (0x20, 0x7F),
    (0xA0, 0x100),
    (0x300, 0x339),  # accents
    (0x391, 0x3F6),
    (0x2010, 0x2064),
    (0x2113, 0x2114),
    (0x2190, 0x2300),  # arrows and operators
    (0x1D400, 0x1D468),  # bold and italic
    (0x1D6A8, 0x1D756),
)
FAMILY, FULL, POSTSCRIPT = 1, 4, 6


def make_font() -> None:
    """Write the font, if it is not there."""
    if FONT.exists():
        return
    spec = find_spec("ziamath")
    assert spec is not None
    assert spec.origin is not None
    options = subset.Options()
    options.flavor, options.layout_features, options.name_IDs = "woff", ["*"], ["*"]
    font = subset.load_font(
        str(Path(spec.origin).parent / "fonts" / "STIXTwoMath-Regular.ttf"), options
    )
    chosen = subset.Subsetter(options)
    chosen.populate(unicodes=[code for begin, end in RANGES for code in range(begin, end)])
    chosen.subset(font)
    for record in font["name"].names:
        if record.nameID in (FAMILY, FULL, POSTSCRIPT):
            record.string = "Formulas"
    FONT.parent.mkdir(exist_ok=True)
    subset.save_font(font, str(FONT), options)


if __name__ == "__main__":
    make_font()
