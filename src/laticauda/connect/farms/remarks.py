"""What is not taken as it is, in words, while an animat is read."""

from collections.abc import Sequence

import numpy as np

ALIKE = 1e-3
"""Relative difference up to which the numbers of all joints are one [-]."""


class Remarks(list[str]):
    """Remarks, in the order in which they were made."""

    def add_count(
        self,
        count: int,
        kind: str,
    ) -> None:
        """Add a remark on several of a kind, unless there are none.

        Args:
            count: How many there are.
            kind: What they are.
        """
        if count:
            self.append(f"{count} {kind}")

    def add_mean(
        self,
        name: str,
        values: Sequence[float],
        unit: str,
    ) -> float:
        """Return the mean of what all joints should have alike; say so if they have not.

        Args:
            name: What it is.
            values: Its values, at least one.
            unit: Their unit.
        """
        low = min(values)
        high = max(values)
        if high - low > ALIKE * max(abs(low), abs(high)):
            span = f"{low:.4g} to {high:.4g} {unit}".strip()
            self.append(f"{name} that differs along the body, {span}: its mean is taken")
        return float(np.mean(values))
