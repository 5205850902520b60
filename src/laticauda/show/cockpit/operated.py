"""A robot that somebody else operates, shown from the operation's recording as it is written; nothing is sent."""

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from laticauda.scenarios import interfaces
from laticauda.show.cockpit.bodies import Body
from laticauda.show.cockpit.feed import SPAN, Feed
from laticauda.show.cockpit.lines import Trail
from laticauda.show.cockpit.scene import Scene
from laticauda.show.cockpit.shapes import Color
from laticauda.tank.operate import Header
from laticauda.values import series

if TYPE_CHECKING:
    from laticauda.control.estimation import Estimate

TRAIL: Color = (250, 120, 80)
EXPLANATION = (
    "The robot that `laticauda operate` moves, as recorded; read-only. "
    "`laticauda cockpit --operated FOLDER` shows the newest one in a folder."
)


class OperatedRobot:
    """Picture of an operated robot, and the text next to it.

    Args:
        gui: GUI of the page's server; the controls are added at its current position.
        viser_scene: Scene of the same server.
        scene: The scene with the simulated robot.
    """

    def __init__(self, gui: Any, viser_scene: Any, scene: Scene) -> None:
        self._scene = scene
        self._feed: Feed | None = None
        self._header: Header | None = None
        self._body = Body(viser_scene, "operated")
        self._trail = Trail(viser_scene, "/operated trail", TRAIL)
        gui.add_markdown(EXPLANATION)
        self._alone = gui.add_checkbox("hide the simulated robot", True)
        self._text = gui.add_markdown("")

    def watch(self, place: Path) -> None:
        """Show the recording at a `place`, or the newest in a folder, from now on."""
        self._feed = Feed(place)

    def show(self, *, with_text: bool) -> np.ndarray | None:
        """Update the picture; return the position of the robot, or None if it is unknown [m].

        Args:
            with_text: Whether to also update the numbers and extend the trail.
        """
        feed = self._feed
        if feed is None:
            return None
        trouble = feed.update()
        estimate = feed.estimate
        header = feed.header
        if estimate is None or header is None:
            if with_text:
                self._text.content = f"**{trouble}**"
            return None
        self._body.show(header.run.robot.planar(), _sample_of(estimate, feed.fin_angle))
        self._scene.set_visible(not self._alone.value)
        if with_text:
            self._extend_trail(header, estimate)
            self._text.content = _format_operation(feed, estimate, trouble)
        return estimate.center_of_mass

    def _extend_trail(self, header: Header, estimate: "Estimate") -> None:
        is_another_run = header is not self._header
        if is_another_run:
            self._header = header
            self._trail.forget()
        self._trail.grow(estimate.center_of_mass)
        self._trail.draw()


def _format_operation(feed: Feed, estimate: "Estimate", trouble: str) -> str:
    """Return position, speed, latest events and what is wrong, as Markdown."""
    x, y = estimate.center_of_mass
    speed = "..."
    if math.isfinite(feed.speed):
        speed = f"{feed.speed:.3f} m/s"
    largest_angle = float(np.max(np.abs(estimate.joint_angle), initial=0.0))
    rows = {
        "place": f"{x:z.2f}, {y:z.2f} m",
        "heading": f"{math.degrees(estimate.heading):z.1f} deg",
        f"speed over {SPAN:g} s": speed,
        "joints": f"up to {math.degrees(largest_angle):.0f} deg",
    }
    if feed.fin_angle:
        rows["fin"] = f"{math.degrees(feed.fin_angle):z.0f} deg"
    lines = [f"| {estimate.status} | |", "|:--|--:|"]
    lines += [f"| {name} | **{value}** |" for name, value in rows.items()]
    lines.append("")
    lines += [f"- {event}" for event in feed.events]
    if trouble:
        lines += ["", f"**{trouble}**"]
    return "\n".join(lines)


def _sample_of(estimate: "Estimate", fin_angle: float) -> series.Log:
    """Convert an estimate to a sample to draw, without motor data, but with the angle of a driven fin [rad]."""
    fields: dict[str, Any] = {}
    for name in interfaces.Observation.__dataclass_fields__:
        if name in series.Log.__dataclass_fields__:
            fields[name] = np.asarray(getattr(estimate, name))
    for name in ("center_of_mass", "center_of_mass_velocity"):
        fields[name] = fields[name][:2]
    no_data = np.zeros_like(estimate.joint_angle)
    return series.Log(
        **fields,
        joint_angle_ref=no_data,
        joint_torque=no_data,
        work=np.zeros(3),
        signals={"fin_angle_0": np.asarray(fin_angle)},
    )
