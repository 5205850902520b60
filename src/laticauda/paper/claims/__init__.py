"""The paper's claims, judged by the results of the studies, and the paper's misprints and contradictions."""

from laticauda.paper.claims.judge import Claim, Misprint, Verdict, load_claims, misprints

__all__ = ["Claim", "Misprint", "Verdict", "load_claims", "misprints"]
