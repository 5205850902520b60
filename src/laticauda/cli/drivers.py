"""`laticauda drivers`: the available drivers, and the data from one of them alone."""

from collections.abc import Sequence
from typing import Any

from laticauda.cli import command, tables
from laticauda.tank.operate import Connection, drivers
from laticauda.tank.operate.drivers.contract import listen
from laticauda.values import BadArgument, option, quantity, value_class


@value_class
class Drivers(command.Command):
    """List the device drivers, or try one alone: connect, listen, print what arrives, how often, and how old it is.

    Nothing moves: modules only measure. The exit status is 1 if nothing arrives or the driver
    reports a fault.

    For example: laticauda drivers --mocap qtm@127.0.0.1:22223
    """

    bus: str | None = option(
        "Try this bus of modules: [DRIVER@]ADDRESS, as in a trial file", default=None
    )
    mocap: str | None = option("Try this motion capture: [DRIVER@]ADDRESS", default=None)
    body: str | None = option(
        "Its body, as in a trial file; if omitted, the only one", default=None
    )
    meter: str | None = option("Try this power meter: [DRIVER@]ADDRESS", default=None)
    stop: str | None = option("Try this emergency-stop input: [DRIVER@]ADDRESS", default=None)
    sensors: str | None = option(
        "Try the robot's own sensors: [DRIVER@]ADDRESS, such as 127.0.0.1:22224", default=None
    )
    duration: float = quantity("s", "How long to listen", gt=0.0, le=3600.0, default=5.0)

    def run(self) -> command.Outcome:
        """List the drivers, or try one."""
        addresses: dict[str, str] = {}
        for kind in drivers.KINDS:
            address = getattr(self, kind)
            if address is not None:
                addresses[kind] = address
        if not addresses:
            return _list_drivers()
        kind, *further_kinds = addresses
        if further_kinds:
            rule = f"must not be given with --{kind}: drivers are tried one at a time"
            raise BadArgument(further_kinds[0], rule)
        return self._try_driver(kind, addresses[kind])

    def _try_driver(self, kind: str, address: str) -> command.Outcome:
        clock = drivers.Clock()
        connection = Connection(mocap_body=self.body or "").at(**{kind: address})
        with connection.opened(kind, clock) as driver:
            samples, longest_call = listen(driver, clock, self.duration)
            end = clock.now()
            trouble = driver.trouble
        rows = [
            self._row_of(source, samples, end)
            for source in sorted({sample.what for sample in samples})
        ]
        problem = trouble or _problem_with(kind, has_data=bool(rows))
        return command.Outcome(
            facts={"heard": rows, "longest_call": longest_call, "trouble": trouble},
            text=tables.format_table(rows),
            problem=problem,
            succeeded=not problem,
        )

    def _row_of(self, source: str, samples: Sequence[Any], end: float) -> dict[str, Any]:
        """Return how often samples of a source came, and the last one."""
        from_source = [sample for sample in samples if sample.what == source]
        last = from_source[-1]
        return {
            "what": source,
            "count": len(from_source),
            "rate [1/s]": len(from_source) / self.duration,
            "age [s]": end - last.time,
            "last": " ".join(repr(last.value).split()),
        }


def _list_drivers() -> command.Outcome:
    names = {kind: base.names() for kind, base in drivers.KINDS.items()}
    rows = [(kind, ", ".join(listed)) for kind, listed in names.items()]
    return command.Outcome(facts=names, text=tables.align_columns(rows))


def _problem_with(kind: str, *, has_data: bool) -> str:
    """Return what is wrong with what arrived; a stop input is silent unless it is active."""
    if kind == "stop":
        if has_data:
            return "The stop is active."
        return ""
    if has_data:
        return ""
    return "No data."
