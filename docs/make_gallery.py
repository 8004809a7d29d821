"""Make the gallery: docs/gallery.md and the pictures of its scenes, two of each, in images/gallery.

    python docs/make_gallery.py [SCENE...]

Draws all scenes, or those that are named, and writes the page. The start page has the small
pictures of some of them.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import der
import matplotlib.pyplot as plt
from der.plotting import style
from PIL import Image

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DOCS = Path(__file__).resolve().parent
CONFIGS = DOCS.parent / "configs"

#: Scenes of configs/, and the times at which a motion is drawn (otherwise `der plot` picks them).
SCENES: dict[str, list[float] | None] = {
    "helix_spring": None,
    "twisted_ring": [0.07],
    "spun_strip": [1.0, 1.5],
    "hanging_coil": None,
    "helical_buckling": [1200.0],
    "bent_cantilever_45": None,
    "gridshell": None,
    "sagging_net": None,
    "finger": [0.0, 0.3, 0.7],
    "four_bar_finger": [0.0, 0.12, 0.4],
    "gripper": [0.0, 0.2, 0.5],
    "falling_beam_21": None,
    "simply_supported_20kN": None,
    "hanging_cable": None,
    "roll_up": None,
    "natural_curvature": None,
    "elastica": None,
    "lee_frame": None,
    "snap_through_arch": None,
    "euler_buckling": None,
    "beam_modes": None,
    "beam_on_foundation": None,
}

PAGE = """\
# Gallery

Each picture is made by the commands below it, of a scene in `configs/`. This page is made by
`python docs/make_gallery.py`. Tutorials have more:
[a finger of three chambers](tutorials/finger.md), [a finger that learns](tutorials/learning.md).
"""

ENTRY = """
<a id="{name}"></a>

## {title}

![{title}](images/gallery/{name}.png)

{words}

<!-- no-test: the page is made by running all of these -->
```sh
der run configs/{name}.yaml --out runs/{name}
der plot runs/{name} --what shapes{times}
```

<details markdown="1">
<summary>configs/{name}.yaml</summary>

<!-- no-test: a scene of configs, which CI runs -->
```yaml
--8<-- "configs/{name}.yaml"
```

</details>
"""


def main() -> None:
    """Draw scenes and write the page."""
    plt.switch_backend("agg")
    folder = DOCS / "images" / "gallery"
    folder.mkdir(parents=True, exist_ok=True)
    for name in sys.argv[1:] or SCENES:
        with style():
            figure = der.run(CONFIGS / f"{name}.yaml").plot("shapes", times=SCENES[name])
            save(figure, folder / f"{name}.png", 110)
            make_small(figure)
            save(figure, folder / f"{name}_small.png", 100)
        plt.close(figure)
        print(f"docs/images/gallery/{name}.png")
    (DOCS / "gallery.md").write_text(PAGE + "".join(map(entry, SCENES)), encoding="utf-8")


def entry(name: str) -> str:
    """Return what the page says of a scene: its title, and the first paragraph of its comment."""
    path = CONFIGS / f"{name}.yaml"
    text = path.read_text(encoding="utf-8")
    comment = text[: text.index("\ntitle")].partition("\n#\n")[0]
    times = SCENES[name]
    return ENTRY.format(
        name=name,
        title=der.load(path).title,
        words="\n".join(line.removeprefix("#").strip() for line in comment.splitlines()),
        times="" if times is None else " --times " + " ".join(f"{time:g}" for time in times),
    )


def make_small(figure: Figure) -> None:
    """Leave nothing of a figure but the first of its shapes, in a frame of 4 to 3."""
    first, *others = figure.axes
    for axes in others:
        axes.remove()
    first.set_title("")
    legend = first.get_legend()
    if legend is not None:
        legend.remove()
    for text in list(first.texts):
        text.remove()
    first.set_axis_off()
    figure.set_layout_engine("none")
    figure.set_size_inches(3.2, 2.4)
    first.set_position((0.03, 0.03, 0.94, 0.94))


def save(figure: Figure, path: Path, dpi: int) -> None:
    """Write a picture in 64 colours, which are enough for a few tones of each."""
    figure.savefig(path, dpi=dpi)
    with Image.open(path) as image:
        image.convert("RGB").quantize(64, dither=Image.Dither.NONE).save(path, optimize=True)


if __name__ == "__main__":
    main()
