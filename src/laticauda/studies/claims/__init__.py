"""The paper's claims, judged by what the studies found, and what the paper prints that cannot be."""

from laticauda.studies.claims.claim import Claim, Verdict
from laticauda.studies.claims.judge import claims
from laticauda.studies.claims.misprints import Misprint, misprints

__all__ = ["Claim", "Misprint", "Verdict", "claims", "misprints"]
