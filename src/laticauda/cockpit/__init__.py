"""The cockpit: a live page where the robot swims. `Live` is its world without a page, `Cockpit` the page's server."""

from typing import TYPE_CHECKING, Any

from laticauda.cockpit.live import Live, Numbers
from laticauda.cockpit.settings import Setting

if TYPE_CHECKING:
    from laticauda.cockpit.page import Cockpit

__all__ = ["Cockpit", "Live", "Numbers", "Setting"]


def __getattr__(name: str) -> Any:
    # The page's parts are imported when they are first used.
    if name == "Cockpit":
        from laticauda.cockpit.page import Cockpit

        return Cockpit
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
