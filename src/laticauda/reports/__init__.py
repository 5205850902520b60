"""Studies put together for readers: report.html, figures and tables in one folder."""

from laticauda.reports.reproduce import STUDIES, Reproduction, reproduce

__all__ = ["STUDIES", "Reproduction", "reproduce"]
