"""The panel of a page: buttons, speed, sliders, and what the simulation tells."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from der._core import quantities
from der.film import speed_text
from der.playing.controls import Control
from der.playing.player import Player
from der.playing.stage import Request

#: Speeds on offer, against that at the start.
_SPEEDS = (0.01, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0)
#: A share of the speed that counts as the speed.
_REACHED = 0.95
_ENERGIES = ("kinetic", "stretch", "bend", "spring", "gravity")


class Panel:
    """Buttons, sliders and texts of a page.

    Parameters
    ----------
    server
        The server of viser.
    player
        The player.
    put
        Takes what buttons and sliders ask for.
    note
        Is said at the end.
    """

    def __init__(
        self, server: Any, player: Player, put: Callable[[Request], None], note: str
    ) -> None:
        self._player = player
        gui = server.gui
        gui.configure_theme(show_logo=False, show_share_button=False)
        gui.set_panel_label(player.simulation.scenario.title)
        self._status = gui.add_markdown("")
        self._pause = gui.add_button("Pause")
        _on(self._pause.on_click, put, lambda _: self._toggle())
        _on(gui.add_button("Step").on_click, put, lambda _: player.step())
        _on(gui.add_button("Reset").on_click, put, lambda _: self._reset())
        speeds = {speed_text(float(f"{player.speed * one:.3g}")): one for one in _SPEEDS}
        normal, names = player.speed, list(speeds)
        choice = gui.add_dropdown("Speed", names, initial_value=names[_SPEEDS.index(1.0)])
        _on(choice.on_update, put, lambda name: self._hurry(speeds[name] * normal))
        self._sliders: dict[Control, Any] = {}
        #: What follows the scene: nobody has moved its slider.
        self._untouched = set(player.controls)
        for control in player.controls:
            self._sliders[control] = slider = gui.add_slider(
                f"{control.name} {control.component} [{control.unit}]".replace(" []", ""),
                -control.reach,
                control.reach,
                control.step,
                0.0,
            )
            _on(slider.on_update, put, lambda value, control=control: self._set(control, value))
        self._values = gui.add_markdown("")
        gui.add_markdown(note)
        units = {one.name: one.unit for one in quantities()}
        output = player.simulation.scenario.to_dict().get("output") or {}
        self._units = {
            name: units[probe["quantity"]] for name, probe in (output.get("probes") or {}).items()
        }
        self.show()

    def show(self) -> None:
        """Show time, speed, values and failures."""
        player = self._player
        simulation = player.simulation
        state = f"**t = {simulation.time:.3f} s**, {speed_text(player.speed)}"
        if player.failure:
            state += f"\n\n**Failed.** {player.failure}\n\n*Reset* goes back to the start."
        elif player.paused:
            state += ", paused"
        elif player.share < _REACHED:
            state += f" asked for, {speed_text(player.share * player.speed)} reached"
        self._status.content = state
        self._pause.label = "Play" if player.paused else "Pause"
        for control in self._untouched:
            slider = self._sliders[control]
            slider.value = min(max(player.value(control), slider.min), slider.max)
        rows = [(name, value, self._units[name]) for name, value in simulation.probes.items()]
        energies = simulation.energies
        rows += [(f"{name} energy", getattr(energies, name), "J") for name in _ENERGIES]
        lines = [f"| {name} | {value:.4g} {unit} |" for name, value, unit in rows]
        self._values.content = "\n".join(["| | |", "|---|---|", *lines])

    def _set(self, control: Control, value: float) -> None:
        self._untouched.discard(control)
        self._player.set(control, value)

    def _hurry(self, speed: float) -> None:
        self._player.speed = speed

    def _toggle(self) -> None:
        self._player.paused = not self._player.paused

    def _reset(self) -> None:
        self._player.reset()
        self._untouched = set(self._player.controls)


def _on(
    listen: Callable[[Any], object], put: Callable[[Request], None], act: Callable[[Any], object]
) -> None:
    """Put what a visitor does with a part of the panel, with its new value."""

    async def react(event: Any) -> None:  # async: what comes later is done later
        if event.client is not None:  # else the program has set it
            value = event.target.value
            put(lambda: act(value))

    listen(react)
