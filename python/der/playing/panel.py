"""The panel of a page: buttons, speed, sliders, and what the simulation tells."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from der._core import quantities
from der.film import speed_text
from der.playing.controls import Control
from der.playing.player import Player
from der.playing.stage import Put

#: Speeds on offer, against that at the start.
_SPEEDS = (0.01, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0)
#: A share of the speed that counts as the speed.
_REACHED = 0.95


class Panel:
    """Buttons, sliders and texts beside the stage; `note` is said at the end."""

    def __init__(self, server: Any, player: Player, put: Put, note: str) -> None:
        self._player, gui = player, server.gui
        gui.configure_theme(show_logo=False, show_share_button=False)
        gui.set_panel_label(player.simulation.scenario.title)
        self._status = gui.add_markdown("")
        self._pause = gui.add_button("Pause")
        _on(self._pause.on_click, put, lambda _: setattr(player, "paused", not player.paused))
        _on(gui.add_button("Step").on_click, put, lambda _: player.step())
        _on(gui.add_button("Reset").on_click, put, lambda _: self._reset())
        speeds = [float(f"{player.speed * one:.3g}") for one in _SPEEDS]
        named = dict(zip(map(speed_text, speeds), speeds, strict=True))
        choice = gui.add_dropdown("Speed", list(named), initial_value=speed_text(player.speed))
        _on(choice.on_update, put, lambda name: setattr(player, "speed", named[name]))
        self._sliders = {}
        #: What follows the scene: nobody has moved its slider.
        self._untouched = set(player.controls)
        for control in player.controls:
            label = control.path.replace(".", " ") + (f" [{control.unit}]" if control.unit else "")
            least, reach, step = control.least, control.reach, control.step
            self._sliders[control] = slider = gui.add_slider(label, least, reach, step, 0.0)
            _on(slider.on_update, put, partial(self._set, control))
        self._values = gui.add_markdown("")
        gui.add_markdown(note)
        units = {one.name: one.unit for one in quantities()}
        probes = (player.simulation.scenario.to_dict().get("output") or {}).get("probes") or {}
        self._units = {name: units[probe["quantity"]] for name, probe in probes.items()}

    def show(self) -> None:
        """Show time, speed, values and failures."""
        player, simulation = self._player, self._player.simulation
        state = f"**t = {simulation.time:.4g} s**, {speed_text(player.speed)}"
        if player.failure:
            state = f"**Failed.** {player.failure}\n\n*Reset* goes back to the start."
        elif player.paused:
            state += ", paused"
        elif player.share < _REACHED:
            state += f" asked for, {player.share:.0%} of it reached"
        self._status.content = state
        self._pause.label = "Play" if player.paused else "Pause"
        for control in self._untouched:
            value = min(max(player.value(control), control.least), control.reach)
            # What is set anew takes what a visitor is about to type.
            if self._sliders[control].value != value:
                self._sliders[control].value = value
        rows = [(name, value, self._units[name]) for name, value in simulation.probes.items()]
        energies = simulation.energies
        rows += [
            ("kinetic energy", energies.kinetic, "J"),
            ("elastic energy", energies.elastic, "J"),
        ]
        lines = [f"| {name} | {value:.4g} {unit} |" for name, value, unit in rows]
        self._values.content = "\n".join(["| | |", "|---|---|", *lines])

    def _set(self, control: Control, value: float) -> None:
        self._untouched.discard(control)
        # While a visitor types into its box, a slider also gives what is beyond its ends.
        self._player.set(control, min(max(value, control.least), control.reach))

    def _reset(self) -> None:
        self._player.reset()
        self._untouched = set(self._player.controls)


def _on(listen: Callable[[Any], object], put: Put, act: Callable[[Any], object]) -> None:
    """Put what a visitor does with a part of the panel, with its new value."""

    async def react(event: Any) -> None:  # async: what comes later is done later
        if event.client is not None:  # else the program has set it
            value = event.target.value
            put(lambda: act(value))

    listen(react)
