"""What a robot did while another program stepped it, as a trial."""

from pathlib import Path

from laticauda.scenarios import Experiment, Scenario
from laticauda.trials import Trial
from laticauda.values import Log, concatenated, packaging

INTERVAL = 0.05
"""Time between two samples at least [s]."""
LONGEST = 3600.0
"""Duration from which nothing more is kept: a record is in memory [s]."""
STATUS = "Stepped by another program."
"""Status of the trial."""
ROUNDING = 1e-9
"""Time by which a sample may be too early [s]."""


class VehicleRecord:
    """Samples since the start, every twentieth of a second, for an hour at most.

    Args:
        scenario: The scenario that is stepped.
    """

    def __init__(self, scenario: Scenario) -> None:
        self._scenario = scenario
        self._samples: list[Log] = []
        self._next_time = INTERVAL

    def add(self, log: Log) -> None:
        """Keep the end of a step if it is time to; of the first step, also its begin.

        Args:
            log: Samples at the begin and at the end of the step.
        """
        if not self._samples:
            first_sample = log.at(slice(0, 1))
            self._samples.append(first_sample)
        time = float(log.time[-1])
        is_due = time >= self._next_time - ROUNDING
        if not is_due or time > LONGEST:
            return
        last_sample = log.at(slice(-1, None))
        self._samples.append(last_sample)
        self._next_time = time + INTERVAL

    def trial(self) -> Trial | None:
        """Return the run so far; None before its second sample."""
        if len(self._samples) < 2:
            return None
        scenario = self._scenario
        return Trial(
            **vars(concatenated(self._samples)),
            scenario=Experiment(
                robot=scenario.robot,
                gait=scenario.gait,
                environment=scenario.environment,
                model=scenario.model,
            ),
            version=packaging.__version__,
            status=STATUS,
            succeeded=True,
        )


def save_record(record: VehicleRecord, path: str | Path | None) -> None:
    """Write a record to a file, unless there is none or nothing happened.

    Args:
        record: The record.
        path: Path of the file; None: none.

    Raises:
        StorageFailed: If it cannot be written.
    """
    trial = record.trial()
    if path is not None and trial is not None:
        trial.save(path)
