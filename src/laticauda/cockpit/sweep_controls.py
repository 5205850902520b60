"""The controls of a stored sweep: which two of its numbers span the map, and what the others are."""

from collections.abc import Callable
from typing import Any, NamedTuple

from laticauda.cockpit.chart import Chart
from laticauda.cockpit.files import received_sweep
from laticauda.cockpit.live import Live
from laticauda.cockpit.settings import Setting
from laticauda.cockpit.sweeps import StoredSweep
from laticauda.errors import LaticaudaError

HINT = "A sweep of `laticauda sweep`: its folder packed as .zip, or its Dataset as .nc"


class Choice(NamedTuple):
    """The sweep that is shown, how, and the handles of what its map does not span."""

    sweep: StoredSweep
    across: str
    up: str
    others: dict[str, Any]


class SweepControls:
    """The controls of one page's server.

    Args:
        gui: Of the page's server; the controls go where it is.
        live: What swims.
        refuse: Says on one page what is wrong.
        changed: Called when another sweep, or none, is to be shown.
    """

    def __init__(
        self, gui: Any, live: Live, refuse: Callable[[Any, Exception], None], changed: Callable[[], None]
    ) -> None:
        self._gui, self._live, self._refuse, self._changed = gui, live, refuse, changed
        self._choice: Choice | None = None
        self._upload = gui.add_upload_button("load a sweep", hint=HINT)
        self._upload.on_upload(self._load)
        self._folder = gui.add_folder("Sweep", visible=False)
        with self._folder:
            self._text = gui.add_markdown("")
            self._x = gui.add_dropdown("across", ("",))
            self._y = gui.add_dropdown("up", ("",))
            self._away = gui.add_button("back to the computed map", order=1e9)
        self._x.on_update(self._chosen)
        self._y.on_update(self._chosen)
        self._away.on_click(self._remove)

    @property
    def sweep(self) -> StoredSweep | None:
        """The one that is loaded, or None."""
        return None if self._choice is None else self._choice.sweep

    def show(self, sweep: StoredSweep) -> None:
        """Let a sweep be the map."""
        self._forget()
        names = sweep.spanning
        self._x.options = self._y.options = names
        self._x.value, self._y.value = across, up = names[0], names[1]
        with self._folder:
            others = {
                axis.name: self._gui.add_dropdown(
                    axis.label,
                    tuple(map(_word, axis.ticks)),
                    initial_value=_word(axis.nearest(self._live.setting)),
                    visible=axis.name not in (across, up),
                )
                for axis in (sweep.axes if sweep.is_grid else ())
            }
        self._choice = Choice(sweep, across, up, others)
        self._folder.visible = True
        self._changed()

    def chart(self, quantity: str) -> tuple[Chart, object] | None:
        """The map that is asked for, and what tells it from others; None without a sweep.

        Args:
            quantity: What the colors mean; the first one if the sweep has none of that name.
        """
        choice = self._choice
        if choice is None:
            return None
        sweep, x, y, others = choice
        quantity = quantity if quantity in sweep.values else next(iter(sweep.values))
        at = {name: handle.options.index(handle.value) for name, handle in others.items()}
        return sweep.chart(quantity, x, y, at), (sweep, quantity, x, y, tuple(at.items()))

    def note(self, setting: Setting) -> None:
        """Say what the sweep is of, and in what that is not what swims here."""
        sweep = self.sweep
        if sweep is None:
            return
        here = {
            "robot": setting.robot.name,
            "gait": setting.gait.kind,
            "environment": setting.environment.name,
            "joints": setting.joints,
        }
        of = ", ".join(value.replace("_", " ") for value in sweep.about.values())
        text = f"**{sweep.name}**: {of}. A click sets the numbers of a trial."
        other = [f"{name} {here[name]}" for name, value in sweep.about.items() if here[name] != value]
        self._text.content = text + (f" Here it is {', '.join(other)}." if other else "")

    def _chosen(self, event: Any) -> None:
        """After another axis was chosen; one that was on the other axis changes places with it."""
        choice = self._choice
        if event.client is None or choice is None:
            return
        x, y = self._x.value, self._y.value
        if x == y:
            x, y = (x, choice.across) if event.target is self._x else (choice.up, y)
            self._x.value, self._y.value = x, y
        for name, handle in choice.others.items():
            handle.visible = name not in (x, y)
        self._choice = choice._replace(across=x, up=y)

    def _load(self, event: Any) -> None:
        file = event.target.value
        try:
            self.show(received_sweep(file.name, file.content))
        except (ValueError, LaticaudaError) as error:
            self._refuse(event.client, error)

    def _remove(self, event: Any) -> None:
        self._forget()
        self._folder.visible = False
        self._changed()

    def _forget(self) -> None:
        choice, self._choice = self._choice, None
        for handle in () if choice is None else choice.others.values():
            handle.remove()


def _word(value: float) -> str:
    return f"{value:.6g}"
