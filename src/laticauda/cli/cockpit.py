"""`laticauda cockpit`: the live page on which a robot swims, until Ctrl-C."""

import sys
from pathlib import Path

from laticauda.cli.command import until_stopped
from laticauda.cli.scene import OfScenarioOrFile, warn_of_compiling
from laticauda.cli.shared_options import host_option, port_option
from laticauda.values import option, value_class


@value_class
class Cockpit(OfScenarioOrFile):
    """Serve a page on which the robot swims, until Ctrl-C; everything on it can be changed while the robot swims.

    It prints one line with the page's address, which contains a token if other computers can reach
    the page. Anyone who opens the page can use all of its controls.

    For example: laticauda cockpit --robot mamba-fin --port 8080
    """

    operated: str | None = option(
        "Show the robot of this recording, or folder, while it is operated", default=None
    )
    load: str | None = option(
        "Play back this trial or recording of an operation beside it", default=None
    )
    host: str = host_option("Address of the page")
    port: int = port_option(8080)

    def run(self) -> None:
        """Serve until Ctrl-C."""
        from laticauda.show.cockpit import Cockpit, Live, load_viser

        load_viser()
        scenario = self.scenario_to_run
        warn_of_compiling(scenario.environment, scenario.model, scenario.robot)
        cockpit = Cockpit(Live(scenario), host=self.host, port=self.port)
        if cockpit.door.warning:
            print(cockpit.door.warning, file=sys.stderr)
        with until_stopped(cockpit.close):
            if self.load is not None:
                cockpit.load(Path(self.load))
            if self.operated is not None:
                cockpit.operated.watch(Path(self.operated))
            cockpit.open()
            self.announce({"address": cockpit.address}, cockpit.address)
            cockpit.wait()
