"""The first ten minutes with der, MuJoCo, diffrax and PyVista: to install each, and see a picture.

    python benchmarks/first_minutes.py [PACKAGE ...] [--der WHEEL]

Each package goes into a fresh environment by ``pip install``, without pip's cache, and runs a short
program that computes something and saves a picture of it. Where a package has no pictures,
matplotlib draws it and is installed too. The table has

- the seconds of the installation, download included, by the clock and of the processor;
- what the installation adds to an empty environment, on disk;
- the shared libraries that the program has loaded at its end, without those of Python itself, and
  how many of them are the system's;
- the lines of the program, and its seconds from the start of Python to the end.

Without ``--der``, der is built from the checkout: that takes minutes on all cores, or little where
its build folder is there already.
"""

from __future__ import annotations

import argparse
import math
import os
import resource
import subprocess
import sys
import tempfile
import time
import venv
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

ROOT = Path(__file__).parents[1]


@dataclass(frozen=True)
class Package:
    """A package, what pip is asked for, and a program that saves ``picture.png``."""

    title: str
    requirements: tuple[str, ...]  # none: what --der says
    program: str

    @property
    def lines(self) -> list[str]:
        """The lines of the program."""
        return self.program.strip().splitlines()


PACKAGES = {
    "der": Package(
        "der",
        (),
        """
import der
result = der.run("example:cantilever")
result.plot().savefig("picture.png")
""",
    ),
    "mujoco": Package(
        "MuJoCo",
        ("mujoco", "matplotlib"),
        """
import matplotlib.pyplot as plt, mujoco
model = mujoco.MjModel.from_xml_string('''<mujoco><worldbody><light pos="0 -1 3"/>
  <body pos="0 0 1"><joint axis="0 1 0"/>
    <geom type="capsule" fromto="0 0 0 .5 0 0" size=".02"/></body>
</worldbody></mujoco>''')
data = mujoco.MjData(model)
mujoco.mj_step(model, data, 500)
renderer = mujoco.Renderer(model)
renderer.update_scene(data)
plt.imsave("picture.png", renderer.render())
""",
    ),
    "diffrax": Package(
        "diffrax",
        ("diffrax", "matplotlib"),
        """
import diffrax, jax.numpy as jnp, matplotlib.pyplot as plt
term = diffrax.ODETerm(lambda t, y, args: jnp.array([y[1], -jnp.sin(y[0])]))
times = jnp.linspace(0, 10, 200)
start, saved = jnp.array([1.0, 0.0]), diffrax.SaveAt(ts=times)
solution = diffrax.diffeqsolve(term, diffrax.Tsit5(), 0, 10, 0.1, start, saveat=saved)
plt.plot(times, solution.ys[:, 0])
plt.savefig("picture.png")
""",
    ),
    "pyvista": Package(
        "PyVista",
        ("pyvista",),
        """
import pyvista
plotter = pyvista.Plotter(off_screen=True)
plotter.add_mesh(pyvista.Spline([[0, 0, 0], [1, 0, 0.2], [2, 0, 0]], 50).tube(0.05))
plotter.screenshot("picture.png")
""",
    ),
}

#: Runs at the end of each program, in the same process.
LIBRARIES = """
import sys
files = {line.split()[-1] for line in open("/proc/self/maps") if ".so" in line}
inside = {file for file in files if file.startswith(sys.prefix)}
python = {file for file in files if file.startswith(sys.base_prefix)} - inside
print(len(files - python), len(files - python - inside))
"""


@dataclass(frozen=True)
class Row:
    """The measurements of a package; times in seconds, the size in bytes."""

    title: str
    wall: float
    processor: float
    size: int
    lines: int
    picture: float = math.nan
    libraries: int = 0
    of_system: int = 0
    failure: str = ""  # why there is no picture


def measure(package: Package, der: Sequence[str]) -> Row:
    """Install a package into a fresh environment and draw its first picture."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        venv.create(folder / "env", with_pip=True)
        python = str(folder / "env" / "bin" / "python")
        empty = size_of(folder / "env")
        install = [python, "-m", "pip", "install", "-q", "--no-cache-dir"]
        wall, processor, _ = run([*install, *(package.requirements or der)], folder)
        size = size_of(folder / "env") - empty
        main = (package.requirements or ("der",))[0]
        told = f"import importlib.metadata as m; print(m.version({main!r}))"
        *_, version = run([python, "-c", told], folder)
        row = Row(f"{package.title} {version}", wall, processor, size, len(package.lines))
        program = folder / "program.py"
        program.write_text("\n".join(package.lines) + LIBRARIES, encoding="utf-8")
        try:
            picture, _, counts = run([python, str(program)], folder)
        except subprocess.CalledProcessError as error:
            return replace(row, failure=error.stderr.strip().splitlines()[-1])
        if not (folder / "picture.png").exists():
            return replace(row, failure="the program has saved none")
        libraries, of_system = map(int, counts.split())
        return replace(row, picture=picture, libraries=libraries, of_system=of_system)


def run(command: Sequence[str], folder: Path) -> tuple[float, float, str]:
    """Run a command; return its seconds by the clock and of the processor, and what it printed."""
    environment = os.environ | {
        "CCACHE_DISABLE": "1",
        "MUJOCO_GL": os.environ.get("MUJOCO_GL", "egl"),
    }
    environment.pop("PYTHONPATH", None)
    used, before = processor_time(), time.perf_counter()
    done = subprocess.run(
        command, cwd=folder, env=environment, text=True, capture_output=True, check=True
    )
    return time.perf_counter() - before, processor_time() - used, done.stdout.strip()


def processor_time() -> float:
    """Return the CPU seconds of all processes that this one has waited for."""
    spent = resource.getrusage(resource.RUSAGE_CHILDREN)
    return spent.ru_utime + spent.ru_stime


def size_of(folder: Path) -> int:
    """Return the bytes of all files in a folder."""
    return sum(file.lstat().st_size for file in folder.rglob("*") if not file.is_dir())


def table(rows: Sequence[Row]) -> str:
    """Return the rows as a table in Markdown."""
    heads = ["", "installed in", "of the processor", "on disk", "libraries, of the system"]
    heads += ["lines", "first picture"]
    lines = [f"| {' | '.join(heads)} |", "|---" * len(heads) + "|"]
    for row in rows:
        lines.append(
            f"| {row.title} | {row.wall:.0f} s | {row.processor:.0f} s | {row.size / 1e6:.0f} MB | "
            + (f"{row.libraries}, {row.of_system}" if not row.failure else "-")
            + f" | {row.lines} | {row.failure or f'{row.picture:.1f} s'} |"
        )
    return "\n".join(lines)


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure what is asked for and print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("packages", nargs="*", metavar="PACKAGE", help=", ".join(PACKAGES))
    parser.add_argument("--der", default=str(ROOT), metavar="WHEEL", help="instead of the checkout")
    options = parser.parse_args(arguments)
    unknown = [name for name in options.packages if name not in PACKAGES]
    if unknown:
        parser.error(f"there is no package {unknown[0]}; there are {', '.join(PACKAGES)}")
    rows = []
    for name in options.packages or PACKAGES:
        print(f"{PACKAGES[name].title} ...", file=sys.stderr)
        rows.append(measure(PACKAGES[name], [str(Path(options.der).resolve())]))
    print(table(rows))
    return 0


if __name__ == "__main__":
    sys.exit(main())
