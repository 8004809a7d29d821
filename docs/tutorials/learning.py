"""The tip of a soft finger learns to reach: the cross-entropy method over a vector environment.

python learning.py            # draws what was learned: learning.png, learning.gif
python learning.py --train    # learns it anew before that, in a few minutes: writes learning.json
"""

from __future__ import annotations

import argparse
import json
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import der
import matplotlib.pyplot as plt
import numpy as np
from der.gym import RodEnv, RodVectorEnv
from der.gym.finger_reach import FINGER, REACHING, curvatures, observe
from der.plotting import PALETTE, style
from numpy.typing import NDArray

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

ACTIONS = 20  # in an episode

SEEN, HIDDEN, DONE = 8, 8, 2
WEIGHTS = (SEEN + 1) * HIDDEN + (HIDDEN + 1) * DONE


def network(weights: Array, seen: Array) -> Array:
    """Return the actions of members, each by its own weights: a layer of HIDDEN between two."""
    inner, outer = np.split(weights, [(SEEN + 1) * HIDDEN], axis=1)
    inner = inner.reshape(-1, SEEN + 1, HIDDEN)
    outer = outer.reshape(-1, HIDDEN + 1, DONE)
    hidden = np.tanh(np.einsum("mi,mij->mj", seen, inner[:, 1:]) + inner[:, 0])
    return np.asarray(np.tanh(np.einsum("mi,mij->mj", hidden, outer[:, 1:]) + outer[:, 0]))


def rewards_of(envs: RodVectorEnv, weights: Array, seeds: list[int]) -> Array:
    """Play an episode in each environment; return the rewards, shape (ACTIONS, members)."""
    seen, _ = envs.reset(seed=seeds)
    rewards = np.full((ACTIONS, envs.num_envs), -20.0)  # the rest of an episode that failed
    going = np.ones(envs.num_envs, dtype=bool)
    for action in range(ACTIONS):
        seen, earned, terminated, _, _ = envs.step(network(weights, seen))
        going &= ~terminated
        rewards[action, going] = earned[going]
    return rewards


@dataclass
class Learned:
    """The weights of a network, and how they were found."""

    weights: Array
    distances: list[float]  # mean distance [cm] of each generation's mean, in new episodes


def save(learned: Learned, path: Path) -> None:
    """Write a JSON file."""
    rounded = [round(weight, 6) for weight in learned.weights.tolist()]
    text = json.dumps({"weights": rounded, "distances": learned.distances})
    path.write_text(text + "\n", encoding="utf-8")


def load(path: Path) -> Learned:
    """Read a JSON file."""
    read = json.loads(path.read_text(encoding="utf-8"))
    return Learned(np.array(read["weights"]), read["distances"])


def train(
    generations: int,
    candidates: int = 64,
    episodes: int = 8,
    seed: int = 0,
    threads: int | None = None,
) -> Learned:
    """Find weights by the cross-entropy method.

    Every generation draws candidates from a normal distribution, lets all play the same episodes
    side by side, and moves mean and deviation towards those of the best eighth.
    """
    generator = np.random.default_rng(seed)
    envs = RodVectorEnv(REACHING, candidates * episodes, threads)
    mean, deviation = np.zeros(WEIGHTS), np.full(WEIGHTS, 0.5)
    distances = []
    for generation in range(generations):
        weights = mean + deviation * generator.standard_normal((candidates, WEIGHTS))
        weights[0] = mean
        seeds = generator.integers(2**31, size=episodes).tolist()
        rewards = rewards_of(envs, np.repeat(weights, episodes, axis=0), seeds * candidates)
        scores = rewards.mean(axis=0).reshape(candidates, episodes).mean(axis=1)
        best = weights[np.argsort(-scores)[: candidates // 8]]
        mean = 0.3 * mean + 0.7 * best.mean(axis=0)
        # A deviation that vanishes early ends the search; this lower bound ends with it.
        least = 0.15 * (1.0 - generation / generations)
        deviation = np.maximum(0.3 * deviation + 0.7 * best.std(axis=0), least)
        distances.append(round(-float(scores[0]), 3))
        print(f"generation {generation + 1:3}: {distances[-1]:.2f} cm", flush=True)
    return Learned(mean, distances)


def distance_at_the_end(learned: Learned, episodes: int = 100) -> float:
    """Return the mean distance [cm] in the last quarter of new episodes."""
    envs = RodVectorEnv(REACHING, episodes)
    seeds = list(range(10**6, 10**6 + episodes))
    rewards = rewards_of(envs, np.tile(learned.weights, (episodes, 1)), seeds)
    return -float(rewards[-ACTIONS // 4 :].mean())


ROUND = np.array([[0.10, 0.02], [0.08, -0.05], [0.05, -0.08], [0.06, 0.05]])  # m: targets to show


@dataclass(frozen=True)
class Track:
    """A run to one target after the other: its start, and its state after every action."""

    times: Array  # s
    tips: Array  # m, (actions + 1, 2)
    targets: Array  # m, (actions + 1, 2)
    curvatures: Array  # 1/m, (actions + 1, 2)


def run(learned: Learned, targets: Array = ROUND) -> Track:
    """Let the finger reach one target after the other, one a second."""
    scene = {**FINGER, "time": {**FINGER["time"], "duration": len(targets)}}
    env = RodEnv(replace(REACHING, scene=scene))
    env.reset(seed=0)
    batch = env.batch
    rows = []
    for target in np.repeat(targets, ACTIONS, axis=0):
        batch.drawn[0] = target
        rows.append((batch.time[0], batch.positions[0, -1].copy(), target, curvatures(batch)[0]))
        env.step(network(learned.weights[np.newaxis], observe(batch))[0])
    rows.append((batch.time[0], batch.positions[0, -1].copy(), target, curvatures(batch)[0]))
    return Track(*(np.array(column) for column in zip(*rows, strict=True)))


def replay(track: Track) -> der.Result:
    """Run the scene with what the controller did as tables: a result to draw and to keep."""
    tables = [{"times": track.times, "values": values} for values in track.curvatures.T]
    actuation = [
        {**chamber, "natural_curvature": {key: value.tolist() for key, value in table.items()}}
        for chamber, table in zip(FINGER["actuation"], tables, strict=True)
    ]
    time = {**FINGER["time"], "duration": float(track.times[-1])}
    return der.run({**FINGER, "actuation": actuation, "time": time, "output": {"every": 0.05}})


def figure(learned: Learned, track: Track, result: der.Result) -> Figure:
    """Draw the finger at the end of each second, the distances, and how they were learned."""
    with style():
        figure = plt.figure(figsize=(9, 3.8), layout="constrained")
        left, right = figure.subfigures(1, 2, width_ratios=[1, 1.3], squeeze=False)[0]
        shapes = left.subplots()
        for number, target in enumerate(ROUND):
            frame = int(np.argmin(np.abs(result.times - (number + 1))))
            colour = PALETTE[number]
            shapes.plot(*100 * result.positions[frame].T, color=colour, linewidth=2.5)
            shapes.plot(*100 * target, "o", color=colour, fillstyle="none", markersize=9)
        shapes.set(aspect="equal", xlabel="x [cm]", ylabel="y [cm]")
        distance, learning = right.subplots(2, 1)
        apart = np.linalg.norm(track.tips - track.targets, axis=1)
        distance.plot(track.times, 100 * apart, color=PALETTE[0])
        for second in range(1, len(ROUND)):
            distance.axvline(second, color="0.8", linewidth=1)
        distance.set(xlabel="time [s]", ylabel="distance [cm]", ylim=(0, None))
        learning.plot(np.arange(1, len(learned.distances) + 1), learned.distances, color="0.3")
        learning.set(xlabel="generation", ylabel="mean distance [cm]", ylim=(0, None))
    return figure


def main() -> None:
    """Learn if asked, run what was learned, draw the pictures."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--train", action="store_true", help="learn anew, write learning.json")
    parser.add_argument("--generations", type=int, default=100, help="default: 100")
    options = parser.parse_args()
    learned = load(Path(__file__).with_name("learning.json"))
    if options.train:
        learned = train(options.generations)
        save(learned, Path("learning.json"))
    print(f"in new episodes: {distance_at_the_end(learned):.2f} cm in the last quarter")
    track = run(learned)
    result = replay(track)
    off = np.linalg.norm(result.positions[-1, -1] - track.tips[-1])
    print(f"replayed from tables: the tip ends {off:.0e} m from where it was")
    figure(learned, track, result).savefig("learning.png")
    result.animate("learning.gif", fps=10)


if __name__ == "__main__":
    main()
