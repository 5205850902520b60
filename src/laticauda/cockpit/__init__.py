"""The cockpit: a live page on which the robot swims; `Cockpit` is its server, `Live` its simulation without a page."""

from typing import TYPE_CHECKING

from laticauda.packaging import lazy_exports

if TYPE_CHECKING:
    from laticauda.cockpit.live import Live as Live
    from laticauda.cockpit.page import Cockpit as Cockpit
    from laticauda.cockpit.readouts import read_figures as read_figures

__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {
        "laticauda.cockpit.live": ["Live"],
        "laticauda.cockpit.page": ["Cockpit"],
        "laticauda.cockpit.readouts": ["read_figures"],
    },
    renamed={"numbers": "read_figures"},
)
