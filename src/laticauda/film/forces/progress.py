"""Progress of an inverse: shares of its parts in the whole."""

from collections.abc import Callable

SHARE_OF_FIT = 0.3
"""Share of the fit of the chain in the time that an inverse takes."""


def ignore_progress(_share: float) -> None:
    """Do nothing with the share of the work that is done."""


def part_of_progress(
    report: Callable[[float], object], begin: float, end: float
) -> Callable[[float], None]:
    """Return a callback for the share of a part of the work.

    Args:
        report: Callback for the share of all of it.
        begin: Share of the whole at which the part begins.
        end: Share at which it ends.
    """

    def report_part(share: float) -> None:
        report(begin + (end - begin) * share)

    return report_part
