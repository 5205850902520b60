"""Robots that swim on a web page without a server: the planar kernels and path following as WebAssembly."""

from laticauda.connect.web.exporting import export_web

__all__ = ["export_web"]
