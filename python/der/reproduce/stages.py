"""Progress of work in stages that each tell their own."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from der.progress import ProgressFunction


class Stages:
    """Joins the progress of stages that follow each other into one.

    Parameters
    ----------
    weights
        About how long each stage takes against the others, in their order.
    progress
        Told what share of the whole is done; None if no one listens.
    begun
        Told the name of each stage once, when it first tells something.
    """

    def __init__(
        self,
        weights: Mapping[str, float],
        progress: ProgressFunction | None,
        begun: Callable[[str], None] | None = None,
    ) -> None:
        total = sum(weights.values())
        self._spans: dict[str, tuple[float, float]] = {}
        done = 0.0
        for name, weight in weights.items():
            self._spans[name] = (done / total, weight / total)
            done += weight
        self._progress = progress
        self._shown = 0.0
        self._begun = begun
        self._known: set[str] = set()

    def of(self, stage: str, part: int = 0, parts: int = 1) -> ProgressFunction:
        """Return what takes the progress of a stage, or of one of its equal parts."""
        start, span = self._spans[stage]

        def tell(share: float) -> None:
            if stage not in self._known:
                self._known.add(stage)
                if self._begun is not None:
                    self._begun(stage)
            # Never backwards: a stage may find more to do while it goes on.
            self._shown = max(self._shown, start + span * (part + share) / parts)
            if self._progress is not None:
                self._progress(min(self._shown, 1.0))

        return tell
