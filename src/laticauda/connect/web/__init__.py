"""Robots that swim on a web page without a server: the planar kernels and path following as WebAssembly.

- `exporting`: writes the files of a page
- `sliders`: what can be set on a page, and in which ranges
- `robot_data`: the data of the robots to choose from
- `steering`: path following as a compiled function
- `page`: HTML, CSS and JavaScript of the page
"""

from laticauda.connect.web.exporting import export_web
from laticauda.values import explain

__all__ = ["export_web"]

explain(globals())
