"""How far are published optima of Mamba's gaits from what the same model gives here?

Question: is the mean error within 1 % in speed and 1.1 % in net power, with the envelope
(n-i)/(n-1) for eel-like? The rows are in a file of one's own, with the columns of
`reproduce --repeats`, of the robot without its fin; P_avg_W is the net mechanical power: see
docs/validation.md, Published optima.

    python campaigns/optima.py optima.csv [figure.png]

Last answer (40 optima):
                          envelope   speed: bias  mean worst   power: bias  mean worst [%]
    lateral undulation               1          -0.8   0.8   1.0          +0.8   0.8   5.1
    anguilliform motion    (n-i)/(n-1)          -0.9   0.9   1.0          +0.9   1.0   3.3
    eel-like motion        (n-i)/(n+1)          -7.3   7.3   9.0         -18.5  18.5  27.5
"""

import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float
from matplotlib.figure import Figure

from laticauda.models.simulate import swim_many
from laticauda.motion.gaits import Anguilliform, EelLike, Envelope
from laticauda.paper import Repeat, load_repeats
from laticauda.robot import load_robot, load_water
from laticauda.show.figures import save_figure, style
from laticauda.show.reports.identify_axes import draw_parity
from laticauda.values.errors import BadArgument


@dataclass(frozen=True, kw_only=True, eq=False)
class Optima:
    """The optima of one kind of gait: as published, and as they swim here."""

    gait: str
    """What tables call it."""
    published: Float[np.ndarray, "2 n"]
    """Forward velocity (5) [m/s], and mean net power of the joints [W]."""
    simulated: Float[np.ndarray, "2 n"]
    """The same here."""

    @property
    def errors(self) -> Float[np.ndarray, "2 n"]:
        """Of velocity and power [%]."""
        return 100.0 * (self.simulated / self.published - 1.0)


def run_optima(rows: Sequence[Repeat], envelope: Envelope | None = None) -> tuple[Optima, ...]:
    """Swim published optima in one batch: ten links, textbook coefficients, `classic` added mass, pd joints, 30 s.

    Args:
        rows: Gait, velocity and power of every optimum.
        envelope: Of the eel-like ones; None takes `Anguilliform`.

    Returns:
        One entry per kind of gait.

    Raises:
        ValueError: If a row has a fin or no power.
    """
    if any(row.has_fin or row.power is None for row in rows):
        raise BadArgument("rows", "must be without fin and each have a power")
    eel = envelope or Anguilliform()
    gaits = [
        replace(row.gait, envelope=eel) if isinstance(row.gait.envelope, EelLike) else row.gait
        for row in rows
    ]
    water = replace(
        load_water("published-2015"), name="optima", normal_drag=2.0, added_mass_form="classic"
    )
    swum = swim_many(load_robot("mamba", n_links=10), gaits, 30.0, environments=water, joints="pd")
    simulated = np.array([swum.forward_velocity, swum.net_power])
    published = np.array(
        [[row.velocity[0], row.power[0] if row.power else np.nan] for row in rows]
    ).T
    kinds = np.array([gait.words for gait in gaits])
    return tuple(
        Optima(
            gait=str(kind),
            published=published[:, kinds == kind],
            simulated=simulated[:, kinds == kind],
        )
        for kind in dict.fromkeys(kinds)
    )


def optima_figure(found: Sequence[Optima]) -> Figure:
    """Simulated over published velocities and powers, which span decades.

    Args:
        found: What `run_optima` returned.
    """
    figure = style.new_figure(1.1 * style.DOUBLE_COLUMN, 0.55 * style.DOUBLE_COLUMN)
    quantities = ("forward velocity [m/s]", "net power [W]")
    for i, (ax, what) in enumerate(zip(figure.subplots(1, 2), quantities, strict=True)):
        points = {one.gait: np.stack((one.published[i], one.simulated[i])) for one in found}
        draw_parity(points, ax, quantity=what).set(
            xlabel=f"published {what}", ylabel=f"simulated {what}"
        )
    powers = np.concatenate([*points.values()], axis=1)
    ends = 0.8 * np.min(powers), 1.25 * np.max(powers)
    ax.set(xscale="log", yscale="log", xlim=ends, ylim=ends)
    style.add_legend(figure.axes[0], loc="upper left")
    return figure


def main() -> None:
    """Print the table; with a second argument, draw the figure into that file."""
    if len(sys.argv) < 2:
        print("Nothing was compared: give the file with the published rows.")
        return
    rows = load_repeats(sys.argv[1])
    found = run_optima(rows)
    others = [one for one in run_optima(rows, EelLike()) if one.gait == EelLike.words]
    heads = "".join(f"{what:>14}{'mean':>6}{'worst':>6}" for what in ("speed: bias", "power: bias"))
    print(f"{'':<20}{'envelope':>14}{heads} [%]")
    for one in (*found, *others):
        envelope = {EelLike.words: "(n-i)/(n+1)", Anguilliform.words: "(n-i)/(n-1)"}.get(
            one.gait, "1"
        )
        figures = [(np.mean(row), np.mean(np.abs(row)), np.max(np.abs(row))) for row in one.errors]
        columns = [f"{bias:>+14.1f}{mean:>6.1f}{worst:>6.1f}" for bias, mean, worst in figures]
        print(f"{one.gait:<20}{envelope:>14}{''.join(columns)}")
    if len(sys.argv) > 2:
        save_figure(optima_figure(found), sys.argv[2])


if __name__ == "__main__":
    main()
