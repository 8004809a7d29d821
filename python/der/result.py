"""The result of a run: its data, and what can be done with them."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from der.exporting import ExportFormat, export
from der.html import card
from der.probe_series import make_probes
from der.progress import ProgressFunction
from der.run_data import RunData, Sections
from der.run_folder_writer import save_run
from der.tables import data_frame
from der.viewing import view

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

    from der._core import Recording, Scenario
    from der.plotting.overview import What


#: How many probes the picture in a notebook has.
_DRAWN = 3


@dataclass(frozen=True, eq=False)
class Result(RunData):
    """The recorded data of a run, with methods to draw, write and view them."""

    def plot(
        self,
        what: What = "overview",
        *,
        times: Sequence[float] | None = None,
        probes: Sequence[str] | None = None,
        views: Sequence[str] | None = None,
        scale: float = 1.0,
        title: str | None = None,
    ) -> Figure:
        """Draw the shapes coloured by time and the probes against time; see `der.plot`."""
        from der.plotting import plot  # here, because matplotlib takes long to load

        return plot(self, what, times=times, probes=probes, views=views, scale=scale, title=title)

    def animate(
        self,
        path: str | os.PathLike[str],
        *,
        fps: float = 25.0,
        speed: float | None = None,
        view: str | None = None,
        progress: ProgressFunction | None = None,
    ) -> Path:
        """Write an animation, GIF or MP4, true to time; see `der.animate`."""
        from der.animation import animate  # here, because matplotlib takes long to load

        return animate(self, path, fps=fps, speed=speed, view=view, progress=progress)

    def export(
        self,
        format: ExportFormat,
        out: str | os.PathLike[str],
        *,
        progress: ProgressFunction | None = None,
    ) -> list[Path]:
        """Write nodes, probes and quantities along rods for other programs; see `der.export`."""
        return export(self, format, out, progress=progress)

    def view(self, path: str | os.PathLike[str] | None = None, *, open: bool | None = None) -> Path:
        """Show an interactive 3D view, or write it as one HTML file; see `der.view`."""
        return view(self, path, open=open)

    def to_pandas(self) -> pd.DataFrame:
        """Return the probes as a table of pandas, with the times [s] of the frames as its index.

        Of a continuation the index has the load factors. ``attrs["units"]`` has the units of the
        columns.

        Raises
        ------
        ModuleNotFoundError
            Without pandas.
        """
        path = self.path
        index = {"time": self.times} if path is None else {"load factor": path.factor}
        columns = {name: np.asarray(probe) for name, probe in self.probes.items()}
        units = {name: probe.unit for name, probe in self.probes.items()}
        return data_frame(columns, index, units)

    def save(self, folder: str | os.PathLike[str]) -> Path:
        """Write a run folder that `der.open_run` reads, and return its path.

        It has ``results.h5``, ``summary.json`` and ``scene.yaml``, as der_run writes them, but no
        checkpoint: it cannot be resumed. Like der_run, it replaces an earlier run and nothing else.

        Raises
        ------
        DerError
            If the folder holds other things than a run, or another run is writing there.
        ValueError
            If the arrays are not of the shapes that the model and the times ask for.
        """
        return save_run(self, folder)

    def __repr__(self) -> str:
        """Return title, status and size in one line."""
        names = ", ".join(self.probes) or "none"
        return f"<der.Result of {self.scenario.title!r}: {self._size()}, probes: {names}>"

    def _repr_html_(self) -> str:
        courses = list(self.probes)[:_DRAWN] if len(self.times) > 1 else []
        what: What = "overview" if courses else "shapes"
        nothing = self.scenario.analysis == "buckling" and self.buckling is None
        has_shapes = len(self.times) > 0 and not nothing
        draw = partial(self.plot, what, probes=courses, title="") if has_shapes else None
        return card(self.scenario.title, self._size(), draw, [self.probes.table()])

    def _size(self) -> str:
        frames, nodes, _ = self.positions.shape
        return f"{self.status}, {frames} frame{'' if frames == 1 else 's'} of {nodes} nodes"


def to_result(
    scenario: Scenario, recording: Recording, probes: Sequence[str], summary: dict[str, Any]
) -> Result:
    """Return what the engine recorded as a result, with its `probes` in that order."""
    return Result(
        scenario=scenario,
        times=recording.times,
        steps=recording.steps,
        positions=recording.positions,
        velocities=recording.velocities,
        energies=recording.energies,
        work=recording.work,
        probes=make_probes(
            {name: recording.probes[name] for name in probes}, recording.probe_units, summary
        ),
        summary=summary,
        data=recording.data,
        sections=None if recording.sections is None else Sections(*recording.sections),
        turns=recording.turns,
    )
