"""Studies put together for readers: report.html, figures and tables in one folder."""

from laticauda.reports.claims import claims_chapter
from laticauda.reports.efficiency import efficiency_chapter
from laticauda.reports.experiments import Experiments, Results, paper_experiments
from laticauda.reports.reproduce import STUDIES, Reproduction, reproduce

__all__ = [
    "STUDIES",
    "Experiments",
    "Reproduction",
    "Results",
    "claims_chapter",
    "efficiency_chapter",
    "paper_experiments",
    "reproduce",
]
