"""Which values the parameters of the members have: products, lists side by side, and samples."""

from __future__ import annotations

import itertools
import json
import math
from collections.abc import Collection, Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from der.arguments import check_varied, read_number, whole_number
from der.sweeps.values import MOST_VALUES, Range, Values, as_values, stored

#: The values of a member's parameters, in the order of the paths.
Member = tuple[Any, ...]
#: Members of a product, at most: the cheapest that there are take days on a core.
MOST_MEMBERS = 1_000_000_000
Sampling = Literal["sobol", "lhs"]


@dataclass(frozen=True)
class Design:
    """The members of a sweep, made one by one.

    Attributes
    ----------
    paths
        The parameters, as `Scenario.with_` names them.
    values
        What each goes through.
    zipped
        Whether the values are taken side by side; otherwise each with each, the last parameter
        first.
    sampling
        ``sobol`` or ``lhs``, a sample of the ranges; None without.
    samples, seed
        How many, and where they start.
    """

    paths: tuple[str, ...]
    values: tuple[Values, ...]
    zipped: bool = False
    sampling: Sampling | None = None
    samples: int = 0
    seed: int = 0

    def __len__(self) -> int:
        """Return the number of members; two with the same values are one."""
        return self.count()

    def __iter__(self) -> Iterator[Member]:
        """Yield the members in their order; those of a product are never all in memory."""
        return itertools.product(*self._unique_lists) if self._is_product else iter(self._listed)

    def count(self) -> int:
        """Return the number of members, also of a product that is too large for `len`."""
        return math.prod(map(len, self._unique_lists)) if self._is_product else len(self._listed)

    def members_that_differ_in(self, numbers: Collection[int]) -> Iterator[Member]:
        """Yield at least one member for each set of values that some parameters have together.

        A product may have many more members than it has such sets.
        """
        if not self._is_product:
            return iter(self._listed)
        return itertools.product(
            *(own if i in numbers else own[:1] for i, own in enumerate(self._unique_lists))
        )

    def count_among(self, rows: Collection[tuple[Any, ...]]) -> int:
        """Return how many of these rows, with values as they are `stored`, are members.

        It takes the time of the rows: a product may have a thousand times as many members.
        """
        if self._is_product:
            columns = [set(map(stored, own)) for own in self._unique_lists]
            return sum(all(map(set.__contains__, columns, row)) for row in rows)
        members = {tuple(map(stored, member)) for member in self._listed}
        return sum(row in members for row in rows)

    def repeats(self) -> list[str]:
        """Return in words what is given more than once, which is one member all the same."""
        if self._is_product:
            counts = [
                (f"{path}: {len(own)} values", len(own), len(unique))
                for path, own, unique in zip(
                    self.paths, self.lists(), self._unique_lists, strict=True
                )
            ]
        elif self.sampling is None:
            given = len(self.lists()[0])
            counts = [(f"{given} values side by side", given, len(self))]
        else:
            counts = [(f"{self.samples} points of the sample", self.samples, len(self))]
        return [
            f"{what}, {different} distinct: each is taken once"
            for what, given, different in counts
            if different < given
        ]

    def to_json(self) -> str:
        """Return a text that tells this design from any other."""
        values = [
            [v.low, v.high, v.log, *filter(None, [v.unit])]
            if isinstance(v, Range)
            else list(map(stored, v))
            for v in self.values
        ]
        own: dict[str, Any] = {"paths": self.paths, "values": values, "zipped": self.zipped}
        if self.sampling is not None:
            own |= {"sampling": self.sampling, "samples": self.samples, "seed": self.seed}
        return json.dumps(own)

    def lists(self) -> list[tuple[Any, ...]]:
        """Return the values of all parameters that are no ranges."""
        return [values for values in self.values if not isinstance(values, Range)]

    @property
    def _is_product(self) -> bool:
        return not self.zipped and self.sampling is None

    @cached_property
    def _unique_lists(self) -> list[Sequence[Any]]:
        return list(map(_unique_values, self.lists()))

    @cached_property
    def _listed(self) -> list[Member]:
        """The members that are taken side by side, or sampled."""
        if self.sampling is None:
            members: Iterable[Member] = zip(*self.lists(), strict=True)
        else:
            members = map(self._sampled, self._shares())
        return _unique((tuple(map(stored, member)), member) for member in members)

    def _shares(self) -> NDArray[np.float64]:
        """Return the points of the sample in the unit cube, shape (samples, parameters)."""
        from scipy.stats import qmc  # here, because it takes long to load

        engine = qmc.Sobol if self.sampling == "sobol" else qmc.LatinHypercube
        sample = engine(len(self.paths), seed=np.random.default_rng(self.seed))
        return np.asarray(sample.random(self.samples))

    def _sampled(self, shares: NDArray[np.float64]) -> Member:
        return tuple(
            values.at(share)
            if isinstance(values, Range)
            else values[min(int(share * len(values)), len(values) - 1)]
            for values, share in zip(self.values, shares.tolist(), strict=True)
        )


def make_design(
    vary: Mapping[str, str | Iterable[Any]],
    *,
    zipped: bool = False,
    sample: str | None = None,
    seed: int = 0,
) -> Design:
    """Check what a sweep is asked for, and return its members.

    `vary` has by parameter its values, as `as_values` takes them; the others are those of
    `der.sweep`. In a sample, each value of a list has an equal share.
    """
    check_varied(vary)
    seed = whole_number("seed", seed, 0)
    if not vary:
        raise ValueError("nothing is varied: name a parameter and its values")
    values = {path: _values_of(path, given) for path, given in vary.items()}
    if sample is not None:
        if zipped:
            raise ValueError("a sample takes no values side by side: leave out zip or sample")
        sampling, samples = _parse_sample(sample)
        return Design(tuple(values), tuple(values.values()), False, sampling, samples, seed)
    if seed != 0:
        raise ValueError("a seed is where a sample starts: add one, as sobol:256, or leave it out")
    for path, own in values.items():
        if isinstance(own, Range):
            raise ValueError(
                f"{path}: {own} is a range to sample from: add the number of "
                f"values, as {own}:11, or sample with sobol:N or lhs:N"
            )
    design = Design(tuple(values), tuple(values.values()), zipped)
    if not zipped:
        _check_product(design)
    lengths = {path: len(own) for path, own in zip(design.paths, design.lists(), strict=True)}
    if zipped and len(set(lengths.values())) > 1:
        counts = ", ".join(f"{path} has {count}" for path, count in lengths.items())
        raise ValueError(f"values side by side are as many for each parameter: {counts}")
    return design


def _check_product(design: Design) -> None:
    """Refuse a product that is a slip: nobody waits for its members."""
    if (count := design.count()) > MOST_MEMBERS:
        raise ValueError(
            f"each value with each of the others are {count} members, and a sweep has at most "
            f"{MOST_MEMBERS}: give fewer values, or take a sample of them with sobol:N or lhs:N "
            "(--sample, sample=)"
        )


def _unique(keyed: Iterable[tuple[Hashable, Any]]) -> list[Any]:
    """Return the values with different keys; the first stands for all that have its key.

    Where a number is given as 20 and as 20.0 the whole number stays, which fits wherever the other
    one does.
    """
    kept: dict[Hashable, Any] = {}
    for key, value in keyed:
        if key not in kept or (isinstance(value, int) and isinstance(kept[key], float)):
            kept[key] = value
    return list(kept.values())


def _unique_values(values: tuple[Any, ...]) -> Sequence[Any]:
    """Return the values of a parameter without those that are there already."""
    # To look at each of millions of numbers takes seconds.
    if set(map(type, values)) <= {int, float} and len(set(values)) == len(values):
        return values
    return _unique((stored(value), value) for value in values)


def _values_of(path: str, given: str | Iterable[Any]) -> Values:
    try:
        return as_values(given)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None


def _parse_sample(text: str) -> tuple[Sampling, int]:
    name, _, count = str(text).partition(":")
    for sampling in get_args(Sampling):
        samples = read_number(count) if name == sampling else None
        if isinstance(samples, int) and samples > 0:
            if samples > MOST_VALUES:
                raise ValueError(f"'{text}': a sample has at most {MOST_VALUES} points")
            return sampling, samples
    raise ValueError(f"'{text}' is no sample: write sobol:256 or lhs:100")
