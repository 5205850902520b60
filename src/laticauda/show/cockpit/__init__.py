"""The cockpit: a live page on which the robot swims; `Cockpit` is its server, `Live` its simulation without a page."""

from typing import TYPE_CHECKING

from laticauda.values.packaging import lazy_exports

if TYPE_CHECKING:
    from laticauda.show.cockpit.live import Live as Live
    from laticauda.show.cockpit.page import Cockpit as Cockpit
    from laticauda.show.cockpit.readouts import read_figures as read_figures

__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {
        "laticauda.show.cockpit.live": ["Live"],
        "laticauda.show.cockpit.page": ["Cockpit"],
        "laticauda.show.cockpit.readouts": ["read_figures"],
    },
    renamed={"numbers": "read_figures"},
)
