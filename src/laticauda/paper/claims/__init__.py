"""The paper's claims, judged by the results of the studies, and the paper's misprints.

`claims.toml` holds the claims: what the paper says, a rule, the numbers that the rule is about, and
a template for the sentence that tells them. The modules:

- `table`: reads `claims.toml`.
- `printed_numbers`, `efficiency_numbers`, `side_numbers`, `following_numbers`: the numbers that it
  refers to by name, from the paper's tables and from each study.
- `rules`: whether numbers meet the parts of a rule.
- `sentences`: the sentences that tell the numbers.
- `judge`: the claims with their verdicts.
- `misprints`: misprints and contradictions.
"""

from laticauda.paper.claims.judge import (
    Claim,
    Verdict,
    count_verdicts,
    load_claims,
    summarize_verdicts,
)
from laticauda.paper.claims.misprints import Misprint, find_misprints
from laticauda.values import explain

__all__ = [
    "Claim",
    "Misprint",
    "Verdict",
    "count_verdicts",
    "find_misprints",
    "load_claims",
    "summarize_verdicts",
]

explain(globals())
