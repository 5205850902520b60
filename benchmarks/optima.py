"""How far are published optima of Mamba's gaits from what the same model gives here?

Question: is the mean error within 1 % in speed and 1.1 % in net power, with the envelope (n-i)/(n-1) for eel-like?
The rows are in a file of one's own: see docs/validation.md, Published optima.

    python benchmarks/optima.py optima.csv [figure.png]

Last answer (40 optima):
                          envelope   speed: bias  mean worst   power: bias  mean worst [%]
    lateral undulation               1          -0.8   0.8   1.0          +0.8   0.8   5.1
    anguilliform motion    (n-i)/(n-1)          -0.9   0.9   1.0          +0.9   1.0   3.3
    eel-like motion        (n-i)/(n+1)          -7.3   7.3   9.0         -18.5  18.5  27.5
"""

import sys

import numpy as np

from laticauda.figures import save_figure
from laticauda.gaits import Anguilliform, EelLike
from laticauda.paper import load_repeats, optima_figure, run_optima


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
        envelope = {EelLike.words: "(n-i)/(n+1)", Anguilliform.words: "(n-i)/(n-1)"}.get(one.gait, "1")
        figures = [(np.mean(row), np.mean(np.abs(row)), np.max(np.abs(row))) for row in one.errors]
        columns = [f"{bias:>+14.1f}{mean:>6.1f}{worst:>6.1f}" for bias, mean, worst in figures]
        print(f"{one.gait:<20}{envelope:>14}{''.join(columns)}")
    if len(sys.argv) > 2:
        save_figure(optima_figure(found), sys.argv[2])


if __name__ == "__main__":
    main()
