"""The figures of one trial as a table: their names, units and titles."""

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class Figure:
    """One figure of a run, as tables show it."""

    name: str
    """The property of `Trial` that it is."""
    unit: str
    """Its unit; "" for a pure number."""
    title: str
    """What it is, in a few words."""


FIGURES = (
    Figure(name="duration", unit="s", title="duration"),
    Figure(name="forward_velocity", unit="m/s", title="forward velocity, straight line over the whole run"),
    Figure(name="steady_velocity", unit="m/s", title="the same over whole gait cycles after the transient"),
    Figure(name="path_speed", unit="m/s", title="path length over time"),
    Figure(name="mean_power", unit="W", title="mean power, mechanical unless there is a power model"),
    Figure(name="mechanical_power", unit="W", title="mechanical power, mean of sum |u phi'|"),
    Figure(name="net_power", unit="W", title="mechanical power, net"),
    Figure(name="positive_power", unit="W", title="mechanical power, positive work only"),
    Figure(name="electrical_power", unit="W", title="electrical power above idle"),
    Figure(name="total_power", unit="W", title="electrical power with idle"),
    Figure(name="cost_of_transport", unit="", title="cost of transport: mean power / (weight * speed)"),
    Figure(name="joules_per_meter", unit="J/m", title="energy per meter, from mean power"),
    Figure(name="quasi_propulsive_efficiency", unit="", title="towing power of the straight robot / mechanical power"),
    Figure(name="linear_drag_share", unit="", title="share of the linear term in the axial drag"),
    Figure(name="course", unit="rad", title="direction of travel, steady part"),
    Figure(name="sideslip", unit="rad", title="course minus heading, steady part"),
    Figure(name="turning_rate", unit="rad/s", title="slope of the heading's cycle mean"),
    Figure(name="strouhal_number", unit="", title="Strouhal number of the trailing edge"),
)
"""All figures of a trial, in the order of a table."""


def figures(trial: object) -> tuple[dict[str, float | None], dict[str, str]]:
    """Every figure of `FIGURES` by name, None where it has no meaning for this run, and why that is so, by name.

    Args:
        trial: It has the figures as properties, which raise a ValueError that says why there is none.
    """
    values: dict[str, float | None] = {}
    reasons: dict[str, str] = {}
    for figure in FIGURES:
        try:
            values[figure.name] = float(getattr(trial, figure.name))
        except ValueError as reason:
            values[figure.name] = None
            reasons[figure.name] = str(reason)
    return values, reasons
