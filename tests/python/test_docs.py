"""README and docs: links lead somewhere, generated pages are fresh, Python snippets run."""

import re
import shutil
from pathlib import Path

import der
import matplotlib.pyplot as plt
import pytest

ROOT = Path(__file__).parents[2]
PAGES = sorted([ROOT / "README.md", ROOT / "CHANGELOG.md", *(ROOT / "docs").glob("*.md")])

FENCED = re.compile(r"^```.*?^```$", flags=re.DOTALL | re.MULTILINE)
LINK = re.compile(r"\]\(\s*<?([^)\s>]+)>?[^)]*\)")
PYTHON = re.compile(r"^```python\n(.*?)^```$", flags=re.DOTALL | re.MULTILINE)
YAML = re.compile(r"^```yaml\n(.*?)^```$", flags=re.DOTALL | re.MULTILINE)


def name(page):
    return str(page.relative_to(ROOT))


def anchors(page):
    """What a link may name after its #: headings as GitHub numbers them, and explicit ids."""
    text = FENCED.sub("", page.read_text(encoding="utf-8"))
    found = set(re.findall(r'<a id="([^"]+)">', text))
    for heading in re.findall(r"^#+ (.+)$", text, flags=re.MULTILINE):
        words = re.sub(r"[^\w\- ]", "", heading.lower()).strip()
        found.add(words.replace(" ", "-"))
    return found


def links(page):
    text = re.sub(r"`[^`\n]*`", "", FENCED.sub("", page.read_text(encoding="utf-8")))
    return [link for link in LINK.findall(text) if not re.match(r"[a-z]+:", link)]


def run_snippets(page, folder, monkeypatch):
    """Run the Python snippets of a page, one after the other, beside the scenes."""
    (folder / "configs").symlink_to(ROOT / "configs")
    monkeypatch.chdir(folder)
    text = page.read_text(encoding="utf-8")
    names = {}
    count = 0
    for match in PYTHON.finditer(text):
        # The line numbers of an error are those of the page.
        padding = "\n" * text.count("\n", 0, match.start(1))
        exec(compile(padding + match[1], str(page), "exec"), names)
        count += 1
    plt.close("all")
    return count


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_relative_links_lead_somewhere(page):
    for link in links(page):
        path, _, anchor = link.partition("#")
        target = (page.parent / path).resolve() if path else page
        assert target.exists(), f"{name(page)} links to {link}, which does not exist"
        if anchor:
            assert anchor in anchors(target), f"{name(page)} links to {link}: no such heading"


def test_every_page_is_linked_from_the_readme():
    linked = {(ROOT / link.partition("#")[0]).resolve() for link in links(ROOT / "README.md")}
    assert [name(page) for page in PAGES if page.name != "README.md" and page not in linked] == []


def test_every_picture_is_shown():
    shown = {(page.parent / link).resolve() for page in PAGES for link in links(page)}
    pictures = (ROOT / "docs" / "images").glob("*.*")
    assert [name(picture) for picture in pictures if picture not in shown] == []


def test_scene_reference_is_what_the_reader_generates():
    """If not: der schema --markdown > docs/scene_reference.md."""
    written = (ROOT / "docs" / "scene_reference.md").read_text(encoding="utf-8")
    assert written.rstrip() == der.scene_reference().rstrip()


def test_steppers_page_has_every_integrator_with_its_order():
    text = (ROOT / "docs" / "steppers.md").read_text(encoding="utf-8")
    listed = re.findall(r"^\| `(\w+)` \| (\d) \|", text, flags=re.MULTILINE)
    assert listed == [(info.name, str(info.order)) for info in der.steppers()]


def test_files_that_the_pages_name_exist():
    """Paths in code quotes that begin with a folder of the checkout."""
    folders = "benchmarks|bindings|cmake|configs|cpp|docs|python|scripts|tests"
    quoted = re.compile(rf"`((?:{folders})/[\w./*-]+)`")
    for page in PAGES:
        for path in quoted.findall(page.read_text(encoding="utf-8")):
            assert any(ROOT.glob(path.rstrip("/"))), f"{name(page)} names {path}"


def test_tests_that_the_pages_name_exist():
    files = [*ROOT.glob("tests/validation/*.py"), *ROOT.glob("tests/python/*.py")]
    code = "\n".join(path.read_text(encoding="utf-8") for path in files)
    for page in PAGES:
        for test in re.findall(r"`(test_\w+)`", page.read_text(encoding="utf-8")):
            assert f"def {test}(" in code, f"{name(page)} names {test}"


def test_scenes_of_the_quick_start(tmp_path):
    text = (ROOT / "docs" / "quickstart.md").read_text(encoding="utf-8")
    scenes = YAML.findall(text)
    assert len(scenes) == 1
    path = tmp_path / "swing.yaml"
    path.write_text(scenes[0], encoding="utf-8")
    assert der.run(path).status == "completed"


def test_snippets_of_the_readme(tmp_path, monkeypatch, capsys):
    assert run_snippets(ROOT / "README.md", tmp_path, monkeypatch) == 1
    assert (tmp_path / "runs" / "tube_20000N" / "plot.png").exists()
    assert "2000 N: 0.037738 m" in capsys.readouterr().out


def test_snippets_of_the_quick_start(tmp_path, monkeypatch):
    assert run_snippets(ROOT / "docs" / "quickstart.md", tmp_path, monkeypatch) == 2
    assert (tmp_path / "runs" / "swing" / "shapes.png").exists()


def test_snippets_of_the_python_page(tmp_path, monkeypatch, capsys):
    pytest.importorskip("plotly")
    assert run_snippets(ROOT / "docs" / "python.md", tmp_path, monkeypatch) >= 10

    pictures = {"beam.png", "falling.png", "speed.png"}
    assert {path.name for path in tmp_path.glob("*.png")} == pictures
    printed = capsys.readouterr().out
    for comment in ("completed", "stopped", "diverged", "nods"):
        assert comment in printed


def test_snippets_of_the_verify_page(tmp_path, monkeypatch, capsys):
    assert run_snippets(ROOT / "docs" / "verify.md", tmp_path, monkeypatch) == 1
    assert "converged" in capsys.readouterr().out


def test_snippets_of_the_study_page(tmp_path, monkeypatch):
    assert run_snippets(ROOT / "docs" / "study.md", tmp_path, monkeypatch) == 1
    assert (tmp_path / "study.csv").exists()
    assert (tmp_path / "study.png").exists()


def test_snippets_of_the_looking_page(tmp_path, monkeypatch):
    for package in ("imageio_ffmpeg", "plotly", "pyevtk"):
        pytest.importorskip(package)
    assert run_snippets(ROOT / "docs" / "looking.md", tmp_path, monkeypatch) == 2
    made = {path.name for path in (tmp_path / "runs" / "tube").iterdir()}
    assert {"plot.png", "tube.gif", "tube.mp4", "view.html", "run.npz", "csv", "vtk"} <= made


@pytest.mark.parametrize(("page", "count"), [("statics", 1), ("modes", 2), ("continuation", 1)])
def test_statics_snippets_run(page, count, tmp_path, monkeypatch):
    assert run_snippets(ROOT / "docs" / f"{page}.md", tmp_path, monkeypatch) == count


def test_pictures_can_be_made(tmp_path, monkeypatch):
    """docs/make_figures.py draws all but those that take the peers, or a browser."""
    scripts = tmp_path / "docs"
    scripts.mkdir()
    (tmp_path / "configs").symlink_to(ROOT / "configs")
    shutil.copy(ROOT / "docs" / "make_figures.py", scripts)
    monkeypatch.syspath_prepend(scripts)
    import make_figures

    monkeypatch.setattr("sys.argv", ["make_figures.py"])
    make_figures.main()
    made = {path.name for path in (scripts / "images").iterdir()}
    assert made | {"peers.png", "view.png"} == {
        path.name for path in (ROOT / "docs" / "images").iterdir()
    }
