"""Do the closed form and MuJoCo with water agree, and how does the difference fall with the step?

Question: is the spatial model (planar root, no gravity) within 0.3 % of the distance at 0.5 ms, and within 0.1 % after
Richardson extrapolation, for every case and every drive? Path: largest distance between the two paths over the distance
traveled in 30 s, the best rotation about the start taken out. The planar run has a quarter of the smallest step.

Last answer (2026-11-21):
ANSWER
"""

from laticauda.studies import parity, parity_cases

STEPS = {
    "prescribed": (0.05, 0.025, 0.0125, 0.001, 0.0005),
    "pd": (0.004, 0.002, 0.001, 0.0005),
    "servo": (0.004, 0.002, 0.001, 0.0005),
}


def main() -> None:
    """Print the table."""
    print(f"{'case':<10}{'joints':<12}{'dt [s]':>8}{'path':>10}{'Richardson':>12}{'rotation [rad]':>16}{'heading [rad]':>15}")
    for joints, steps in STEPS.items():
        for case in parity_cases():
            for row in parity(case, joints, steps):
                extrapolated = "-" if row.richardson is None else f"{row.richardson:.1e}"
                print(
                    f"{row.case:<10}{row.joints:<12}{row.dt:>8.4f}{row.path:>10.1e}{extrapolated:>12}"
                    f"{row.rotation:>16.1e}{row.heading:>15.1e}",
                    flush=True,
                )


if __name__ == "__main__":
    main()
