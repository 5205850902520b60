"""`laticauda drivers`: the available drivers, and the data from one of them alone."""

from laticauda.cli import command, tables
from laticauda.tank.operate import drivers
from laticauda.tank.operate.drivers.contract import listen
from laticauda.tank.operate.settings import Connection
from laticauda.values.errors import BadArgument
from laticauda.values.quantities import option, quantity, value_class


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
    duration: float = quantity("s", "How long to listen", gt=0.0, le=3600.0, default=5.0)

    def run(self) -> command.Outcome:
        """List the drivers, or try one."""
        wanted = {
            kind: typed for kind in drivers.KINDS if (typed := getattr(self, kind)) is not None
        }
        if not wanted:
            known = {kind: base.names() for kind, base in drivers.KINDS.items()}
            lines = tables.aligned([(kind, ", ".join(names)) for kind, names in known.items()])
            return command.Outcome(facts=known, text=lines)
        (kind, *others), clock = wanted, drivers.Clock()
        if others:
            raise BadArgument(
                others[0], f"must not be given with --{kind}: drivers are tried one at a time"
            )
        with Connection(mocap_body=self.body or "").at(**wanted).opened(kind, clock) as driver:
            heard, longest = listen(driver, clock, self.duration)
            now, trouble = clock.now(), driver.trouble
        rows = [
            {"what": what, "count": len(mine), "rate [1/s]": len(mine) / self.duration}
            | {"age [s]": now - mine[-1].time, "last": " ".join(repr(mine[-1].value).split())}
            for what in sorted({one.what for one in heard})
            if (mine := [one for one in heard if one.what == what])
        ]
        wrong = trouble or (
            ""
            if bool(rows) != (kind == "stop")
            else "No data."
            if not rows
            else "The stop is active."
        )
        facts = {"heard": rows, "longest_call": longest, "trouble": trouble}
        return command.Outcome(
            facts=facts, text=tables.format_table(rows), problem=wrong, succeeded=not wrong
        )
