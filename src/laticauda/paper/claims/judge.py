"""All claims of the paper, judged by the studies that there are."""

from collections.abc import Mapping

from laticauda.paper.claims import agreement, fin, following, links, trends
from laticauda.paper.claims.claim import Claim, Statement
from laticauda.paper.efficiency import EfficiencyStudy
from laticauda.paper.links import LinksStudy
from laticauda.paper.parity import ParityStudy
from laticauda.paper.path_following import PathFollowingStudy
from laticauda.paper.side_trials import SideTrials

THEMES = {
    "The fin": fin.STATEMENTS,
    "More links": links.STATEMENTS,
    "Agreement of simulation and robot": agreement.STATEMENTS,
    "Trends, and what the models leave out": trends.STATEMENTS,
    "Path following": following.STATEMENTS,
}
STUDIES = {
    "efficiency": "the efficiency study",
    "following": "the path-following study",
    "links": "the links study",
    "side": "the side trials",
    "parity": "the comparison with the 3D model (reproduce with the model spatial)",
}


def claims(
    efficiency: EfficiencyStudy | None = None,
    following: PathFollowingStudy | None = None,
    links: LinksStudy | None = None,
    side: SideTrials | None = None,
    parity: ParityStudy | None = None,
) -> tuple[Claim, ...]:
    """What the paper's results, remarks and conclusions claim, and what the studies say to it.

    The studies are those of the paper's settings: all its groups, cases and sweeps.

    Args:
        efficiency: What `run_efficiency` returned; None leaves the claims that need it untested, as for the others.
        following: What `run_path_following` returned.
        links: What `run_links` returned.
        side: What `run_side_trials` returned.
        parity: What `run_parity` returned.
    """
    studies = {"efficiency": efficiency, "following": following, "links": links, "side": side, "parity": parity}
    return tuple(_judged(theme, statement, studies) for theme, statements in THEMES.items() for statement in statements)


def _judged(theme: str, statement: Statement, studies: Mapping[str, object]) -> Claim:
    missing = [STUDIES[name] for name in statement.needs if studies[name] is None]
    if missing:
        found, verdict = f"Not run: {', '.join(missing)}.", "not tested here"
    else:
        found, verdict = statement.judge(*(studies[name] for name in statement.needs))
    return Claim(
        key=statement.key,
        theme=theme,
        where=statement.where,
        paper=statement.paper,
        found=found,
        rule=statement.rule,
        verdict=verdict,
    )
