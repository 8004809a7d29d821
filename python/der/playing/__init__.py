"""A running simulation in the browser: what can be set has a slider, and the mouse pulls rods."""

from __future__ import annotations

import io
import time
import webbrowser
from contextlib import redirect_stdout
from queue import SimpleQueue
from typing import Any

from der.arguments import whole_number
from der.errors import DerError
from der.scenario import SceneLike

_FRAME = 1.0 / 30.0  # [s]
_COMPUTING = 0.8  # most of a frame; the rest is for the page
_TEXT_EVERY = 6  # frames
_NAP = 1.0  # most that goes by in a frame [s]: a machine that sleeps misses the rest
#: How long the page may be gone [s]: while it loads again it is.
_GONE = 3.0


def play(scene: SceneLike, *, port: int = 8080, open: bool = False) -> None:
    """Play a scene in the browser, until its page is closed.

    It prints the address, which is for browsers of this machine.

    Parameters
    ----------
    scene
        As `Simulation` takes it, with a ``time``. It goes on after its duration.
    port
        Of the address; if it is taken, the next one that is free.
    open
        Whether to show the page in a browser.

    Raises
    ------
    ModuleNotFoundError
        Without the package viser.
    ValueError
        If the scene has no time, or the port is none.
    SceneError, DerError
        Where the scene cannot be simulated.
    """
    try:
        import viser
    except ModuleNotFoundError:
        raise ModuleNotFoundError(
            "der play requires the package viser: pip install 'der[live]'"
        ) from None
    from der.playing.player import Player  # here: takes long to load

    port = whole_number("port", port, 1, 65535)
    player = Player(scene)
    with redirect_stdout(io.StringIO()):  # it prints a table
        server = viser.ViserServer(host="127.0.0.1", port=port, verbose=False)
    try:
        address = f"http://localhost:{server.get_port()}"
        print(f"{address} (ends when the page is closed, and with Ctrl-C)", flush=True)
        if open:
            webbrowser.open(address)
        _serve(server, player)
    finally:
        with redirect_stdout(io.StringIO()):  # it says so
            server.stop()


def _serve(server: Any, player: Any) -> None:
    """Show frames until the last visitor has gone."""
    from der.playing.panel import Panel
    from der.playing.stage import Stage

    requests: SimpleQueue[Any] = SimpleQueue()  # the page asks in threads of its own
    stage = Stage(server, player, requests.put)
    note = f"Drag a rod to pull it. The grid has cells of {stage.cell:g} m."
    if stage.magnified > 1.05:
        note += f" Rods are shown up to {stage.magnified:.2g} times as thick as they are."
    panel = Panel(server, player, requests.put, note)
    seen, before, frame = None, time.monotonic(), 0
    while seen is None or before - seen < _GONE:
        visitors = server.get_clients()
        while not requests.empty():
            try:
                requests.get()()
            except DerError as error:  # such as a curvature too sharp for the mesh
                for visitor in visitors.values():
                    visitor.add_notification("This cannot be set", str(error))
        now = time.monotonic()
        if visitors:
            seen = now
            player.advance(min(now - before, _NAP), _COMPUTING * _FRAME)
            stage.show()
            if frame % _TEXT_EVERY == 0:
                panel.show()
        before, frame = now, frame + 1
        time.sleep(max(0.002, now + _FRAME - time.monotonic()))
