"""Misprints of the paper, and places where it contradicts itself."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations

from laticauda.gaits import GAIT_WORDS
from laticauda.paper.claims.judge import percent, table
from laticauda.paper.following_settings import path_following_settings
from laticauda.paper.measured import efficiency_trials, measured_trial
from laticauda.paper.settings import Group, efficiency_settings
from laticauda.paper.table1 import is_misprint, percent_change
from laticauda.paper.table2 import table2_changes
from laticauda.robot import load_robot


@dataclass(frozen=True, kw_only=True)
class Misprint:
    """One thing that is printed and cannot be meant, or that the paper says otherwise elsewhere."""

    where: str
    """The section, table or figure."""
    printed: str
    """What is printed."""
    instead: str
    """What it should be, or what it contradicts, and how that is known."""


def misprints() -> tuple[Misprint, ...]:
    """Misprints and contradictions of the paper; what numbers tell is recomputed from its tables."""
    in_words = (Misprint(**entry) for entry in table()["misprints"])
    return (*_table1(), *_table2(), *_same_speed(), *_links(), *_power(), *in_words)


def _table1() -> Iterator[Misprint]:
    groups = efficiency_settings().groups
    for group in groups:
        bare = next(other for other in groups if other.gait == group.gait and not other.has_fin)
        for index, printed in enumerate(group.printed_power_change):
            yield from _change(bare, group, index, "mean_power", printed)
        for index, printed in enumerate(group.printed_velocity_change):
            yield from _change(bare, group, index, "forward_velocity", printed)


def _change(bare: Group, group: Group, index: int, name: str, printed: float | None) -> Iterator[Misprint]:
    """A printed change of Table 1 that its own rows do not give."""
    trials = measured_trial(bare.cases[index], False), measured_trial(group.cases[index], group.has_fin)
    before, after = (None if trial is None else getattr(trial, name) for trial in trials)
    if before is None or after is None or printed is None:
        return
    found = percent_change(before, after)
    if is_misprint(printed, found):
        what = {"mean_power": "power", "forward_velocity": "velocity"}[name]
        unit = {"mean_power": "W", "forward_velocity": "m/s"}[name]
        yield Misprint(
            where=f"Table 1, {group.name}, case {index + 1}",
            printed=f"Change of {what}: {percent(printed, '+.2f')}.",
            instead=f"{percent(found, '+.2f')}, from {before:g} to {after:g} {unit} in the same table.",
        )


def _table2() -> Iterator[Misprint]:
    changes = iter(table2_changes())
    for group in path_following_settings().groups:
        if not group.has_fin:
            continue
        pairs = zip(group.printed_velocity_change, group.printed_power_change, strict=True)
        for case, (printed, found) in enumerate(zip(pairs, changes, strict=False), start=1):
            for what, shown, value in zip(("velocity", "power"), printed, found, strict=True):
                if shown is not None and is_misprint(shown, value):
                    yield Misprint(
                        where=f"Table 2, {group.name}, case {case}",
                        printed=f"Change of {what}: {percent(shown, '+.2f')}.",
                        instead=f"{percent(value, '+.2f')}, from the numbers of the same table.",
                    )


def _same_speed() -> Iterator[Misprint]:
    """Settings of one group with the same speed to four digits."""
    for one, other in combinations(efficiency_trials(), 2):
        same_group = (one.gait.kind, one.has_fin) == (other.gait.kind, other.has_fin)
        if same_group and one.forward_velocity is not None and one.forward_velocity == other.forward_velocity:
            yield Misprint(
                where=f"Table 1, {GAIT_WORDS[one.gait.kind]}, {'with' if one.has_fin else 'without'} fin",
                printed=f"{one.forward_velocity:.4f} m/s at two settings, of which each is a maximum of its sweep.",
                instead="One may have been copied from the other; nothing tells which.",
            )


def _links() -> Iterator[Misprint]:
    robot, modules = load_robot("mamba-fin"), load_robot("mamba-modules-fin")
    assert robot.caudal_fin is not None
    link, fin = robot.modules[0].length, robot.caudal_fin.length
    yield Misprint(
        where="2",
        printed=f"20 links of {link:g} m.",
        instead=f"That is {20 * link:g} m, of which the fin is {100 * fin / (20 * link):.0f} % and not the 30 % of "
        f"section 4.5. {robot.n_links} links of {link:g} m, as in the authors' simulations, are {robot.length:g} m "
        f"({100 * fin / robot.length:.0f} %), and {modules.n_links} modules of {modules.modules[0].length:g} m are "
        f"{modules.length:g} m ({100 * fin / modules.length:.0f} %).",
    )


def _power() -> Iterator[Misprint]:
    changes = [power for _, power in table2_changes()]
    yield Misprint(
        where="5",
        printed="The fin costs relatively little more power, or even saves some.",
        instead=f"So says Table 1; in Table 2 the power rises by {min(changes):.0f} to {max(changes):.0f} %.",
    )
