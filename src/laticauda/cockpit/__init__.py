"""The cockpit: a live page where the robot swims. `Live` is its world without a page, `Cockpit` the page's server."""

from typing import TYPE_CHECKING

from laticauda.packaging import lazy_exports

if TYPE_CHECKING:
    from laticauda.cockpit.live import Live as Live, Numbers as Numbers
    from laticauda.cockpit.page import Cockpit as Cockpit
    from laticauda.cockpit.settings import Setting as Setting

__getattr__, __dir__, __all__ = lazy_exports()
