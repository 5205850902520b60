"""Misprints of the paper, and places where it contradicts itself."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations

from laticauda.paper.claims import quantities
from laticauda.paper.claims.judge import percent, table
from laticauda.paper.measured import efficiency_trials, path_following_trials, printed_changes


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
    return (*_changes(), *_same_speed(), *_links(), *_power(), *in_words)


def _changes() -> Iterator[Misprint]:
    """Printed changes by the fin that the rows of the tables do not give."""
    for number, rows in ((1, efficiency_trials()), (2, path_following_trials())):
        for change in printed_changes(rows):
            for what, (printed, found) in change.misprints.items():
                name, unit = {"power": ("mean_power", "W"), "velocity": ("forward_velocity", "m/s")}[what]
                before, after = getattr(change.without, name), getattr(change.with_fin, name)
                own = f"from {before:g} to {after:g} {unit} in" if number == 1 else "from the numbers of"
                yield Misprint(
                    where=f"Table {number}, {change.with_fin.group}, case {change.with_fin.case}",
                    printed=f"Change of {what}: {percent(printed, '+.2f')}.",
                    instead=f"{percent(found, '+.2f')}, {own} the same table.",
                )


def _same_speed() -> Iterator[Misprint]:
    """Settings of one group with the same speed to four digits."""
    for one, other in combinations(efficiency_trials(), 2):
        if one.group == other.group and one.forward_velocity is not None:
            if one.forward_velocity == other.forward_velocity:
                yield Misprint(
                    where=f"Table 1, {one.group}",
                    printed=f"{one.forward_velocity:.4f} m/s at two settings, of which each is a maximum of its sweep.",
                    instead="One may have been copied from the other; nothing tells which.",
                )


def _links() -> Iterator[Misprint]:
    body = quantities.robots()
    yield Misprint(
        where="2",
        printed="20 links of {link:g} m.".format(**body),
        instead="That is {0:g} m, of which the fin is {printed_longer:.0f} % and not the 30 % of section 4.5. "
        "{n_links} links of {link:g} m, as in the authors' simulations, are {length:g} m ({longer:.0f} %), and "
        "{n_modules} modules of {module:g} m are {modules_length:g} m ({modules_longer:.0f} %).".format(
            20 * body["link"], **body
        ),
    )


def _power() -> Iterator[Misprint]:
    changes = quantities.tables()["power"]
    yield Misprint(
        where="5",
        printed="The fin costs relatively little more power, or even saves some.",
        instead=f"So says Table 1; in Table 2 the power rises by {min(changes):.0f} to {max(changes):.0f} %.",
    )
