r"""Formulas in the docs, as MathML that is made when they are built: no script and no network is needed to read them.

`$c_t$` stands in a line, and a paragraph between lines of `$$` is set apart. It is TeX, with Greek
letters as they are, and `aligned` for several lines.
"""

import html
import re
from typing import Any
from xml.etree.ElementTree import Element, SubElement

from latex2mathml.converter import convert_to_element
from markdown import Markdown
from markdown.blockprocessors import BlockProcessor
from markdown.extensions import Extension
from markdown.inlinepatterns import InlineProcessor
from markdown.util import AtomicString

IN_LINE = r"(?<![\\$])\$(?![\s$])([^$]+?)(?<!\s)\$(?![\d$])"
APART = re.compile(r"^ {0,3}\$\$(.+?)\$\$\s*$", re.DOTALL)
# What is not in latex2mathml: names of columns that line up, and letters in bold that are no Latin
# ones.
ALIGNED = re.compile(r"\\(begin|end)\{aligned\}")
BOLD = re.compile(r"\\boldsymbol\{([\u03b1-\u03c9])\}")
PRIMES = re.compile("[\u2032\u2033\u2034]+")
CLOSING = (")", "]", "|", "&#x00029;", "&#x0005D;", "&#x0007C;")
FIRST_BOLD = 0x1D6C2 - 0x3B1


def formula(tex: str, display: str) -> Element:
    """TeX as an element of MathML."""
    tex = html.unescape(tex).strip()
    tex = tex.replace(r"\tag{", r"\qquad \tag{")
    known = BOLD.sub(
        lambda found: chr(ord(found[1]) + FIRST_BOLD), ALIGNED.sub(r"\\\1{split}", tex)
    )
    math = convert_to_element(known, display=display)
    math.set("alttext", tex)
    for parent in list(math.iter()):
        for place, element in reversed(list(enumerate(parent))):
            dress(parent, place, element)
    for element in math.iter():
        if (element.text or "").startswith("\\"):
            raise ValueError(f"{element.text} of the formula {tex!r} is not known.")
    return math


def dress(parent: Element, place: int, element: Element) -> None:
    """Mend what browsers would set too wide, too narrow or too high."""
    if element.tag in ("msup", "msubsup") and PRIMES.fullmatch(
        html.unescape(element[-1].text or "")
    ):
        primes = Element("mo", {"lspace": "0", "rspace": "0"})
        primes.text = AtomicString(html.unescape(element[-1].text or ""))
        row = Element("mrow")
        row.extend((element[0], primes))
        element.tag = "mrow" if element.tag == "msup" else "msub"
        element[:] = [row, *element[1:-1]]
        return
    if element.text is None:
        return
    element.text = AtomicString(html.unescape(element.text))  # no Markdown within it
    before = next((one for one in reversed(parent[:place]) if one.tag != "mspace"), None)
    if element.text in ("|", "/"):
        element.attrib.update({"lspace": "0.05em", "rspace": "0.05em"})
    elif (
        element.text in "+\u2212"
        and before is not None
        and before.tag == "mo"
        and before.text not in CLOSING
    ):
        element.set("form", "prefix")
    elif (
        element.tag in ("mi", "mo") and element.text.isalnum() and len(element.text) > 1
    ):  # sin, clip
        element.tag = "mi"
        after = parent[place + 1] if place + 1 < len(parent) else None
        if (
            parent.tag in ("mrow", "mtd")
            and after is not None
            and html.unescape(after.text or "") not in ("(", ")")
        ):
            parent.insert(place + 1, Element("mspace", {"width": "0.17em"}))


class InLine(InlineProcessor):
    """`$c_t$`."""

    def handleMatch(self, m: re.Match[str], data: str) -> tuple[Element, int, int]:  # noqa: N802
        """Take the dollars and what is between them."""
        return formula(self.unescape(m.group(1)), "inline"), m.start(0), m.end(0)


class Apart(BlockProcessor):
    """A paragraph between `$$`."""

    def test(self, parent: Element, block: str) -> bool:
        """Whether it is one."""
        return APART.match(block) is not None

    def run(self, parent: Element, blocks: list[str]) -> None:
        """Put the formula into a box of its own, which scrolls where it is too wide."""
        found = APART.match(blocks.pop(0))
        assert found is not None
        SubElement(parent, "div", {"class": "formula"}).append(formula(found.group(1), "block"))


class Mathematics(Extension):
    """Formulas between dollars."""

    def extendMarkdown(self, md: Markdown) -> None:  # noqa: N802
        """Come after code, before what Markdown means by underscores and backslashes."""
        md.inlinePatterns.register(InLine(IN_LINE, md), "formula", 185)
        md.parser.blockprocessors.register(Apart(md.parser), "formula", 95)


def makeExtension(**given: Any) -> Mathematics:  # noqa: N802
    """What Markdown asks for."""
    return Mathematics(**given)
