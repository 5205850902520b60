"""Campaigns: one mission in many waters, from many starts, with sensors that fail; each by a seed.

`laticauda.missions.campaign_table` keeps the rows.
"""

import hashlib
import math
from collections.abc import Generator, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from laticauda.missions.campaign_table import CampaignTable, MissionRow, open_table
from laticauda.missions.running import MissionResult, run_missions
from laticauda.models.simulate import cluster, silent
from laticauda.robot import Water
from laticauda.scenarios import Scenario, Start, run_to_toml
from laticauda.sensing import Sensor, SensorFault
from laticauda.studies import GO_ON, Progress, Share, find_shares, list_shares
from laticauda.values import BadArgument, option, quantity, value_class
from laticauda.water.fluid.flow import Flow

LOWEST_WAVE = 1e-6
"""Height of waves at least [m]."""
NAME_LENGTH = 12
"""Digits of a campaign's name, which are enough to tell any two apart."""
NORMAL_QUANTILE = 1.959964
"""Quantile of the normal distribution for intervals of 95 % [-]."""


@value_class
class Conditions:
    """What differs between the runs of a campaign; each is drawn evenly up to these limits."""

    current: float = quantity("m/s", "Largest current, from any direction", ge=0.0, default=0.11)
    wave_height: float = quantity("m", "Largest height of waves", ge=0.0, default=0.1)
    wave_periods: tuple[float, float] = quantity(
        "s", "Shortest and longest period of waves", gt=0.0, default=(3.0, 6.0)
    )
    start_distance: float = quantity(
        "m", "How far the start is off along each axis", ge=0.0, default=0.15
    )
    start_angle: float = quantity(
        "rad", "How far the start is turned", ge=0.0, le=math.pi, default=math.radians(10.0)
    )
    dropout: float = quantity(
        "", "Share of all measurements that are lost", ge=0.0, le=1.0, default=0.05
    )
    failing: tuple[str, ...] = option("Sensors of which one fails in every run", default=())
    fault_begin: float = quantity("s", "When it fails at the latest", gt=0.0, default=240.0)
    fault_duration: tuple[float, float] = quantity(
        "s", "Shortest and longest time for which it fails", gt=0.0, default=(10.0, 40.0)
    )


@dataclass(frozen=True, kw_only=True)
class Draw:
    """What was drawn for one run."""

    seed: int
    current: float
    """Speed of the current [m/s]."""
    current_direction: float
    """Where it flows to [rad]."""
    wave_height: float
    """Height of the waves [m]."""
    wave_period: float
    """Their period [s]."""
    wave_direction: float
    """Where they run to [rad]."""
    wave_phase: float
    """Their phase [rad]."""
    start_offset: tuple[float, float]
    """How far the start is off along x and y [m]."""
    start_turn: float
    """How far it is turned [rad]."""
    fault: SensorFault
    """When and how a sensor fails."""
    failing: str
    """Which one; "": none."""


def draw_conditions(conditions: Conditions, seed: int) -> Draw:
    """Return what one run meets.

    Args:
        conditions: Limits.
        seed: What decides.
    """
    random = np.random.default_rng(seed)
    current = conditions.current * random.random()
    current_direction = 2.0 * math.pi * random.random()
    wave_height = max(conditions.wave_height * random.random(), LOWEST_WAVE)
    wave_period = float(random.uniform(*conditions.wave_periods))
    wave_direction = 2.0 * math.pi * random.random()
    wave_phase = 2.0 * math.pi * random.random()
    offset_x, offset_y = (conditions.start_distance * random.uniform(-1.0, 1.0, 2)).tolist()
    start_turn = conditions.start_angle * float(random.uniform(-1.0, 1.0))
    fault = _draw_fault(conditions, random)
    failing = ""
    if conditions.failing:
        failing = conditions.failing[int(random.integers(len(conditions.failing)))]
    return Draw(
        seed=seed,
        current=current,
        current_direction=current_direction,
        wave_height=wave_height,
        wave_period=wave_period,
        wave_direction=wave_direction,
        wave_phase=wave_phase,
        start_offset=(offset_x, offset_y),
        start_turn=start_turn,
        fault=fault,
        failing=failing,
    )


def _draw_fault(conditions: Conditions, random: np.random.Generator) -> SensorFault:
    """Return a time during which a sensor is silent or frozen."""
    begin = conditions.fault_begin * random.random()
    duration = float(random.uniform(*conditions.fault_duration))
    kind = "silent" if random.random() < 0.5 else "frozen"
    return SensorFault(begin=begin, end=begin + duration, kind=kind)


def change_scenario(scenario: Scenario, conditions: Conditions, draw: Draw) -> Scenario:
    """Return the mission under what was drawn.

    Args:
        scenario: The mission.
        conditions: Limits, of which the share of lost measurements counts.
        draw: What was drawn.
    """
    water = scenario.environment
    if not isinstance(water, Water) or not isinstance(scenario.start, Start):
        raise BadArgument("scenario", "must be in water, and not go on with another run")
    x, y = scenario.start.center_of_mass
    start = replace(
        scenario.start,
        center_of_mass=(x + draw.start_offset[0], y + draw.start_offset[1]),
        heading=scenario.start.heading + draw.start_turn,
    )
    sensors: list[Sensor] = []
    for sensor in scenario.model.sensors:
        faults = sensor.faults
        if sensor.name == draw.failing:
            faults = (*faults, draw.fault)
        changed = replace(sensor, seed=draw.seed, dropout=conditions.dropout, faults=faults)
        sensors.append(changed)
    return replace(
        scenario,
        environment=replace(water, current=_flow_of(draw)),
        start=start,
        model=replace(scenario.model, sensors=tuple(sensors)),
    )


def _flow_of(draw: Draw) -> Flow:
    """Return the current with the waves on it."""
    make_current: Any = Flow.named("uniform")
    make_waves: Any = Flow.named("waves")
    current: Flow = make_current(
        u=draw.current * math.cos(draw.current_direction),
        v=draw.current * math.sin(draw.current_direction),
    )
    waves: Flow = make_waves(
        height=draw.wave_height,
        period=draw.wave_period,
        direction=draw.wave_direction,
        phase=draw.wave_phase,
    )
    return current + waves


def name_of_campaign(scenario: Scenario, conditions: Conditions) -> str:
    """Return a short name that two campaigns share only if all their numbers are the same.

    Args:
        scenario: The mission.
        conditions: What differs between the runs.
    """
    text = f"{run_to_toml(scenario)}\n{conditions}"
    return hashlib.sha256(text.encode()).hexdigest()[:NAME_LENGTH]


def make_row(campaign: str, draw: Draw, result: MissionResult) -> MissionRow:
    """Return the row of a run.

    Args:
        campaign: The name of the campaign.
        draw: What was drawn.
        result: What came of it.
    """
    share_seen = math.nan
    if result.share_seen is not None:
        share_seen = result.share_seen
    reason = ""
    if result.changes:
        reason = result.changes[-1].reason
    return MissionRow(
        campaign=campaign,
        seed=draw.seed,
        current=draw.current,
        current_direction=draw.current_direction,
        wave_height=draw.wave_height,
        wave_period=draw.wave_period,
        failing=draw.failing,
        fault=draw.fault.kind,
        fault_begin=draw.fault.begin,
        fault_end=draw.fault.end,
        is_docked=int(result.is_docked),
        duration=result.duration,
        clearance=result.clearance,
        share_seen=share_seen,
        largest_error=result.largest_error,
        last_phase=result.last_phase,
        reason=reason,
    )


def run_campaign(
    scenario: Scenario,
    conditions: Conditions,
    seeds: Sequence[int],
    path: str | Path,
    *,
    at_once: int = 16,
    progress: Progress = silent,
    client: Any = None,
    share: Share | None = None,
) -> list[MissionRow]:
    """Run a mission with many seeds; a file holds the rows, and a stopped campaign goes on where it was.

    A run comes to the same row whoever computes it (on processors of one kind), and a finished
    table is sorted by seed: so it holds the same bytes after a kill, from a cluster, and from
    shares that were merged.

    Args:
        scenario: The mission.
        conditions: What differs.
        seeds: The seeds.
        path: CSV file of the rows.
        at_once: Runs that are computed side by side.
        progress: Called at the start and whenever runs are stored with their number and the total.
        client: A `dask.distributed.Client`: the runs are computed on its cluster. None computes
            them in this process.
        share: Only this share of the seeds, in a file of its own, see `Share.file`; all shares are
            put together by `merge_campaign`. None runs all of them.

    Returns:
        All rows of the file.

    Raises:
        ValueError: If the file is no table of this campaign, or another process writes to it.
        StorageFailed: If it cannot be written. Nothing that was stored is lost.
        ClusterFailed: If the cluster's scheduler goes away, or workers die repeatedly. Nothing that
            was stored is lost.
    """
    table_path = Path(path)
    if share is not None:
        seeds = seeds_of_share(share, seeds)
        table_path = share.file(table_path)
    with open_table(table_path) as table:
        table.check_campaign(name_of_campaign(scenario, conditions))
        stored_seeds = table.seeds
        missing_seeds = [seed for seed in seeds if seed not in stored_seeds]
        n_runs = len(seeds)
        n_stored = n_runs - len(missing_seeds)
        progress(n_stored, n_runs)
        with closing(_run_batches(scenario, conditions, missing_seeds, at_once, client)) as batches:
            for rows in batches:
                table.append(rows)
                n_stored += len(rows)
                progress(n_stored, n_runs)
        table.sort()
        return table.rows


def _run_batches(
    scenario: Scenario, conditions: Conditions, seeds: Sequence[int], at_once: int, client: Any
) -> Generator[list[MissionRow]]:
    """Yield the rows of some seeds at a time, in order of completion."""
    size = at_once
    if client is not None and seeds:
        # No thread of the cluster is to wait for others.
        n_threads = max(cluster.count_threads(client, GO_ON), 1)
        size = min(at_once, math.ceil(len(seeds) / n_threads))
    calls: list[tuple[Scenario, Conditions, Sequence[int]]] = []
    for begin in range(0, len(seeds), size):
        calls.append((scenario, conditions, seeds[begin : begin + size]))
    if client is None:
        for call in calls:
            yield run_seeds(*call)
        return
    for _, rows in cluster.call_on(client, run_seeds, enumerate(calls), GO_ON):
        yield rows


def run_seeds(scenario: Scenario, conditions: Conditions, seeds: Sequence[int]) -> list[MissionRow]:
    """Return the rows of some runs of a campaign.

    Args:
        scenario: The mission.
        conditions: What differs.
        seeds: The seeds of the runs.
    """
    draws = [draw_conditions(conditions, seed) for seed in seeds]
    results = run_missions([change_scenario(scenario, conditions, draw) for draw in draws])
    campaign = name_of_campaign(scenario, conditions)
    return [make_row(campaign, draw, result) for draw, result in zip(draws, results, strict=True)]


def seeds_of_share(share: Share, seeds: Sequence[int]) -> Sequence[int]:
    """Return the seeds of a share: every n-th, so that a larger campaign keeps the rows of a smaller one.

    Args:
        share: The share.
        seeds: All seeds of the campaign.
    """
    return seeds[share.number - 1 :: share.count]


@dataclass(frozen=True, kw_only=True)
class MergedCampaign:
    """What came of a merger of a campaign's shares."""

    rows: list[MissionRow]
    """All rows of the merged table."""
    n_done: int
    """Runs of the campaign that are in it."""
    unfinished: tuple[Share, ...]
    """Shares that are missing, or that are there, but not finished."""


def merge_campaign(path: str | Path, seeds: Sequence[int]) -> MergedCampaign:
    """Put the shares of a campaign together; what is there already is kept, and what is missing can follow.

    Args:
        path: CSV file of the whole campaign; the shares lie beside it, see `Share.file`.
        seeds: All seeds of the campaign.

    Raises:
        ValueError: If there is no share beside the file, one is no table of a campaign, or another
            process writes to one of them.
        StorageFailed: If the file cannot be written. Nothing that was stored is lost.
    """
    stored_shares = find_shares(path, suffix=Path(path).suffix)
    with open_table(Path(path)) as table:
        for stored_share in stored_shares:
            with open_table(stored_share.path) as share_table:
                _check_same_campaign(share_table, table)
                stored_seeds = table.seeds
                table.append([row for row in share_table.rows if row.seed not in stored_seeds])
        table.sort()
    merged_seeds = table.seeds
    unfinished: list[Share] = []
    for share in list_shares(stored_shares):
        if not merged_seeds.issuperset(seeds_of_share(share, seeds)):
            unfinished.append(share)
    n_done = len(merged_seeds.intersection(seeds))
    return MergedCampaign(rows=table.rows, n_done=n_done, unfinished=tuple(unfinished))


def _check_same_campaign(share_table: CampaignTable, table: CampaignTable) -> None:
    """Reject a share of another campaign than the rows before it."""
    if table.rows:
        share_table.check_campaign(table.rows[0].campaign)


@dataclass(frozen=True, kw_only=True)
class CampaignSummary:
    """What a campaign shows."""

    n_runs: int
    """Runs of the campaign."""
    n_docked: int
    """Runs that ended in the dock."""
    share_low: float
    """Lower end of the 95 % interval of Wilson for the share that docked."""
    share_high: float
    """Its upper end."""
    n_contacts: int
    """Runs in which the body went through something."""
    least_clearance: float
    """Smallest distance of any run [m]."""
    share_of_net_seen: float
    """Share of the net that was seen, in the mean of all runs."""
    n_seen_enough: int
    """Runs in which at least 90 % were seen."""
    causes: dict[str, int]
    """By the phase in which runs ended that did not dock and why it began, how many there were."""
    worst: tuple[int, ...]
    """Seeds of the ten worst runs: those that did not dock, then those that came nearest to something."""


ENOUGH_SEEN = 0.9
"""Share of the net that is to be seen [-]."""
N_WORST = 10
"""How many of the worst runs are named."""


def summarize_campaign(rows: Sequence[MissionRow]) -> CampaignSummary:
    """Return what a campaign shows.

    Args:
        rows: Its rows.
    """
    n_docked = sum(row.is_docked for row in rows)
    low, high = wilson_interval(n_docked, len(rows))
    causes: dict[str, int] = {}
    for row in rows:
        if not row.is_docked:
            cause = row.last_phase
            if row.reason:
                cause = f"{row.last_phase}: {row.reason}"
            causes[cause] = causes.get(cause, 0) + 1
    worst = sorted(rows, key=lambda row: (row.is_docked, row.clearance))
    return CampaignSummary(
        n_runs=len(rows),
        n_docked=n_docked,
        share_low=low,
        share_high=high,
        n_contacts=sum(row.clearance <= 0.0 for row in rows),
        least_clearance=min(row.clearance for row in rows),
        share_of_net_seen=float(np.mean([row.share_seen for row in rows])),
        n_seen_enough=sum(row.share_seen >= ENOUGH_SEEN for row in rows),
        causes=causes,
        worst=tuple(row.seed for row in worst[:N_WORST]),
    )


def wilson_interval(n_successes: int, n_runs: int) -> tuple[float, float]:
    """Return the 95 % interval of Wilson for the probability of success.

    Args:
        n_successes: Number of successes.
        n_runs: Number of runs.

    Example:
        >>> low, high = wilson_interval(95, 100)
        >>> round(low, 3), round(high, 3)
        (0.888, 0.978)
    """
    z2 = NORMAL_QUANTILE**2
    share = n_successes / n_runs
    middle = (share + 0.5 * z2 / n_runs) / (1.0 + z2 / n_runs)
    spread = math.sqrt(share * (1.0 - share) / n_runs + 0.25 * z2 / n_runs**2)
    half_width = NORMAL_QUANTILE * spread / (1.0 + z2 / n_runs)
    return middle - half_width, middle + half_width
