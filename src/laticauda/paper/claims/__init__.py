"""The paper's claims, judged by what the studies found, and what the paper prints that cannot be."""

from laticauda.paper.claims.judge import Claim, Misprint, Verdict, claims, misprints

__all__ = ["Claim", "Misprint", "Verdict", "claims", "misprints"]
