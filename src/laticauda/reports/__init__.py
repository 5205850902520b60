"""Studies put together for readers: report.html, figures and tables in one folder."""

from laticauda.reports.reproduce import STUDIES, Reproduction, check_folder, reproduce

__all__ = ["STUDIES", "Reproduction", "check_folder", "reproduce"]
