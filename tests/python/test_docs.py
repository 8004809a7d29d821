"""README and docs: links lead somewhere, generated pages are fresh, tutorials say what is so.

That every command and snippet runs is checked by scripts/check_docs.py, which .ci/run calls; here
is a test of that program.
"""

import importlib.util
import json
import re
import shutil
from pathlib import Path
from types import SimpleNamespace

import der
import matplotlib.pyplot as plt
import numpy as np
import pytest
from browsers import assert_no_errors, wait_for

ROOT = Path(__file__).parents[2]
PAGES = sorted([ROOT / "README.md", ROOT / "CHANGELOG.md", *(ROOT / "docs").rglob("*.md")])
DOCS = ROOT / "docs"
TUTORIALS = DOCS / "tutorials"

FENCED = re.compile(r"^```.*?^```$", flags=re.DOTALL | re.MULTILINE)
LINK = re.compile(r"\]\(\s*<?([^)\s>]+)>?[^)]*\)")
PYTHON = re.compile(r"^```python\n(.*?)^```$", flags=re.DOTALL | re.MULTILINE)


def name(page):
    return str(page.relative_to(ROOT))


def anchors(page):
    """The valid anchors of a page: headings as GitHub numbers them, and explicit ids."""
    text = FENCED.sub("", page.read_text(encoding="utf-8"))
    found = set(re.findall(r'<a id="([^"]+)">', text))
    for heading in re.findall(r"^#+ (.+)$", text, flags=re.MULTILINE):
        words = re.sub(r"[^\w\- ]", "", heading.lower()).strip()
        found.add(words.replace(" ", "-"))
    return found


def links(page):
    text = re.sub(r"`[^`\n]*`", "", FENCED.sub("", page.read_text(encoding="utf-8")))
    return [link for link in LINK.findall(text) if not re.match(r"[a-z]+:", link)]


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_relative_links_lead_somewhere(page):
    for link in links(page):
        path, _, anchor = link.partition("#")
        target = (page.parent / path).resolve() if path else page
        assert target.exists(), f"{name(page)} links to {link}, which does not exist"
        if anchor:
            assert anchor in anchors(target), f"{name(page)} links to {link}: no such heading"


def test_every_page_is_in_the_navigation_of_the_site():
    pages = {name(page).removeprefix("docs/") for page in PAGES if page.is_relative_to(DOCS)}
    text = (ROOT / "mkdocs.yml").read_text(encoding="utf-8")
    listed = re.findall(r"^ +- .*: ([\w/]+\.md)$", text, flags=re.MULTILINE)
    assert sorted(listed) == sorted(pages)


def test_every_picture_is_shown():
    shown = {(page.parent / link).resolve() for page in PAGES for link in links(page)}
    pictures = (ROOT / "docs" / "images").glob("*.*")
    assert [name(picture) for picture in pictures if picture not in shown] == []


def test_scene_reference_is_what_the_reader_generates():
    """If not: der schema --markdown > docs/scene_reference.md."""
    written = (ROOT / "docs" / "scene_reference.md").read_text(encoding="utf-8")
    assert written.rstrip() == der.scene_reference().rstrip()


def test_each_group_of_keys_has_an_example():
    """Those that stand within another group, or differ by a word from one, have it there."""
    text = (DOCS / "scene_reference.md").read_text(encoding="utf-8")
    groups = re.split(r'^<a id="[^"]+"></a>\n\n## ', text, flags=re.MULTILINE)[1:]
    without = {group.partition("\n")[0] for group in groups if "```yaml\n" not in group}
    assert without == {
        "Scene",
        "Cross-section",
        "Member of a joint",
        "Spring of a hinge",
        "Static analysis",
        "Modes analysis",
        "Buckling analysis",
        "Table of vectors in space",
        "Sine of vectors in space",
    }


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


@pytest.fixture
def check_docs(monkeypatch):
    monkeypatch.syspath_prepend(ROOT / "scripts")
    import check_docs

    return check_docs


SNIPPETS = """
Save this as `small.yaml`:

```yaml
title: A small rod
rods:
  - name: rod
    nodes: 5
    from: [0, 0]
    to: [1, 0]
    cross_section: {circle: {radius: 0.01}}
    material: {youngs_modulus: 1e7, density: 1000}
supports: [{rod: rod, at: start, clamp: true}]
loads: [{gravity: [0, -9.81]}]
analysis: static
```

```python
import der

shape = der.run("small.yaml")
```

```python
assert shape.positions.shape == (1, 5, 2)
print("second block")
```

```yaml
time: {duration: 1, step: 0.1}
time: {duration: 1, tolerance: 1e-3}
```

<!-- exit-code: 3 -->
```sh
test -d configs && test -f small.yaml && exit 3
```

<!-- no-test: it cannot work -->
```sh
false
```
"""


def checked(check_docs, text, tmp_path, capfd):
    page = tmp_path / "page.md"
    page.write_text(text, encoding="utf-8")
    code = check_docs.main([str(page)])
    return code, capfd.readouterr().out


def test_snippets_that_work(check_docs, tmp_path, capfd):
    code, printed = checked(check_docs, SNIPPETS, tmp_path, capfd)
    assert code == 0, printed
    assert "second block" in printed
    assert "left out: it cannot work" in printed
    assert printed.count(": ok (") == 5


@pytest.mark.parametrize(
    ("old", "new", "complaint"),
    [
        ("import der", "import derr", "No module named 'derr'"),
        ("(1, 5, 2)", "(1, 6, 2)", "AssertionError"),
        ("exit 3", "exit 4", "exit code 4 and not 3"),
        ("step: 0.1", "stepp: 0.1", "stepp"),
        ("nodes: 5", "nodes: 0", "nodes"),
        ("title: A small rod\n", "", "must be complete"),
    ],
)
def test_snippets_that_do_not_work(check_docs, tmp_path, capfd, old, new, complaint):
    text = SNIPPETS.replace(old, new, 1)
    code, printed = checked(check_docs, text, tmp_path, capfd)
    assert code == 1
    assert "FAILED" in printed
    assert complaint in printed


def test_snippets_do_not_inherit_from_the_program_that_runs_them(check_docs, tmp_path, capfd):
    """The program delays annotations; for a reader, a name in one that is not imported fails."""
    text = "```python\nnumbers: dict[str, Any] = {}\n```\n"
    code, printed = checked(check_docs, text, tmp_path, capfd)
    assert code == 1
    assert "name 'Any' is not defined" in printed


def test_a_snippet_is_left_out_for_a_reason_only(check_docs, tmp_path, capfd):
    with pytest.raises(SystemExit, match="say why"):
        checked(check_docs, "<!-- no-test -->\n```sh\nfalse\n```\n", tmp_path, capfd)


def test_python_of_the_readme(tmp_path, monkeypatch, capsys):
    (tmp_path / "configs").symlink_to(ROOT / "configs")
    monkeypatch.chdir(tmp_path)
    (code,) = PYTHON.findall((ROOT / "README.md").read_text(encoding="utf-8"))
    exec(compile(code, "README.md", "exec"), {})
    assert "2000 N: 0.037738 m" in capsys.readouterr().out
    plt.close("all")


@pytest.fixture
def tutorial(monkeypatch):
    monkeypatch.syspath_prepend(DOCS)
    return lambda module: importlib.import_module(f"tutorials.{module}")


@pytest.mark.parametrize(
    "module",
    ["falling_rod", "beam_study", "control", "two_links", "finger", "learning", "fitting"],
)
def test_code_of_a_tutorial_is_that_of_its_program(module):
    """Definitions are shown as they are; blocks that use them may be the page's own."""
    program = (TUTORIALS / f"{module}.py").read_text(encoding="utf-8")
    if module == "learning":  # its task is one of the package
        program += (ROOT / "python/der/gym/finger_reach.py").read_text(encoding="utf-8")
    page = (TUTORIALS / f"{module}.md").read_text(encoding="utf-8")
    for code in PYTHON.findall(page):
        if re.search(r"^(def|class|[A-Z_]+\b.*=) ?", code, flags=re.MULTILINE):
            assert code in program
    for scene in re.findall(r"^```yaml\n(.*?)^```$", page, flags=re.DOTALL | re.MULTILINE):
        assert scene == (TUTORIALS / f"{module}.yaml").read_text(encoding="utf-8")


@pytest.fixture
def make_notebooks(monkeypatch):
    monkeypatch.syspath_prepend(DOCS)
    return importlib.import_module("make_notebooks")


@pytest.mark.parametrize("page", ["beam_study", "control"])
def test_notebooks_are_their_pages_and_run(page, make_notebooks, tmp_path, monkeypatch, capsys):
    """If they are others: python docs/make_notebooks.py."""
    assert page in make_notebooks.PAGES
    text = (TUTORIALS / f"{page}.ipynb").read_text(encoding="utf-8")
    assert text == make_notebooks.notebook(page)
    assert f"({page}.ipynb)" in (TUTORIALS / f"{page}.md").read_text(encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    cells = json.loads(text)["cells"]
    code = ["".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"]
    assert len(code) >= 4
    names = {"__name__": "__main__"}
    for number, source in enumerate(code):
        exec(compile(source, f"{page}.ipynb, cell {number}", "exec"), names)
    printed = capsys.readouterr().out
    assert {"beam_study": "converged", "control": "off by 0."}[page] in printed


def test_search_runs_in_a_page_that_is_a_file(browser, tmp_path):
    """The site's stand-in for a worker takes messages before and after its script is loaded."""
    shim = (DOCS / "assets" / "iframe-worker.js").read_text(encoding="utf-8")
    twice = 'self.addEventListener("message", (event) => postMessage(2 * event.data))'
    (tmp_path / "twice.js").write_text(twice)
    use = (
        'const worker = new Worker("twice.js"); window.heard = [];'
        'worker.addEventListener("message", (event) => { heard.push(event.data);'
        "if (heard.length < 2) worker.postMessage(21); }); worker.postMessage(4);"
    )
    page = tmp_path / "page.html"
    page.write_text(f"<!DOCTYPE html><body><script>{shim}</script><script>{use}</script></body>")
    browser.get(page.as_uri())
    assert wait_for(browser, "heard.length == 2 && heard") == [8, 42]
    assert browser.execute_script("worker.terminate(); return frames.length") == 0
    assert_no_errors(browser)


def test_tutorial_of_the_falling_rod(tutorial):
    falling_rod = tutorial("falling_rod")
    result = der.run(falling_rod.SCENE)
    expected = falling_rod.terminal_velocity(result.scenario)
    assert expected == pytest.approx(-0.02434018, rel=1e-6)
    assert result.probes["v_mid"][-1] == pytest.approx(expected, rel=1e-4)
    ends, middle = result.positions[-1, [0, -1], 1], result.positions[-1, 5, 1]
    assert np.all(ends - middle > 0.005)  # it bends


def test_tutorial_of_the_beam(tutorial):
    beam_study = tutorial("beam_study")
    points = beam_study.study()
    assert beam_study.elastica(beam_study.EI / beam_study.LENGTH**2) == pytest.approx(
        0.3017207738 * beam_study.LENGTH, rel=1e-8
    )
    for point in points:
        assert point.verdict == "converged"
        # The ruler stretches, which the elastica does not: 1e-8 of its length and less.
        assert abs(point.found - point.exact) <= point.error_bar + 3e-9
        assert point.error_bar < 5e-4 * point.found
    assert points[-1].linear > 4 * points[-1].exact


def test_tutorial_of_control(tutorial):
    control = tutorial("control")
    with_feedback, without = control.run(control.PI()), control.run(control.open_loop)
    for start, end in ((4.0, control.PICKED_UP), (control.PICKED_UP + 2.0, 16.0)):
        assert with_feedback.error(start, end) < 1e-3
        assert without.error(start, end) > 0.05
    assert np.abs(np.diff(with_feedback.angles)).max() < 0.05  # a motor could do it


def test_tutorial_of_two_links(tutorial):
    two_links = tutorial("two_links")
    result = der.run(two_links.SCENE)
    # A small vibration is left at the end of the run.
    assert result.probes["servo_moment"][-1] == pytest.approx(two_links.balance(result), rel=1e-4)
    yielding, stiff = two_links.run(two_links.LIMIT), two_links.run(np.inf)
    heavy, light = np.searchsorted(yielding.times, [two_links.HEAVY[1] - 1e-9, 4.0 - 1e-9])
    assert yielding.probes["servo_moment"][heavy] == pytest.approx(two_links.LIMIT, rel=1e-2)
    assert stiff.probes["servo_moment"][heavy] > 1.2 * two_links.LIMIT
    for track in (yielding, stiff):
        assert track.probes["servo_angle"][light] == pytest.approx(two_links.CLOSED)
        assert track.probes["servo_moment"][light] == pytest.approx(
            result.probes["servo_moment"][-1], rel=5e-3
        )


def test_pictures_can_be_made(tmp_path, monkeypatch):
    """docs/make_figures.py draws all but those that take the peers, or a browser."""
    pytest.importorskip("gymnasium")
    scripts = tmp_path / "docs"
    scripts.mkdir()
    (tmp_path / "configs").symlink_to(ROOT / "configs")
    shutil.copy(DOCS / "make_figures.py", scripts)
    shutil.copytree(TUTORIALS, scripts / "tutorials")
    monkeypatch.syspath_prepend(scripts)
    import make_figures

    monkeypatch.setattr("sys.argv", ["make_figures.py"])
    make_figures.main()
    made = {path.name for path in (scripts / "images").iterdir()}
    browsers = {"view.png", "notebook.png", "play.png"}
    assert made | {"peers.png", "peers_strip.png"} | browsers == {
        path.name for path in (ROOT / "docs" / "images").glob("*.*")
    }


def test_tutorial_of_the_finger(tutorial):
    finger = tutorial("finger")
    inverse = finger.Inverse(points=12)
    assert inverse.error < 1e-8
    assert inverse.pressures.min() > 0.0
    # The slopes that the solver found, against a change of the pressures.
    simulation = der.Simulation(der.Scenario.from_dict(finger.FINGER))
    tips = []
    for change in ([0, 0, 0], [0.1, 0, -0.2]):
        finger.inflate(simulation, inverse.pressures[3] + change)
        simulation.equilibrium()
        tips.append(simulation.positions[-1].copy())
    moved = inverse.slopes[3] @ change
    assert tips[1] - tips[0] == pytest.approx(moved, abs=0.01 * np.linalg.norm(moved))
    with_feedback = finger.run(finger.Feedback(inverse))
    without = finger.run(finger.OpenLoop(inverse))
    assert max(with_feedback.error(lap) for lap in range(3)) < 1e-3
    assert without.error(1) > 5e-3
    assert abs(without.error(2) - without.error(0)) < 1e-4
    # The chambers' work is in the ledger, and tables are the same run as what was set.
    result = finger.replay(with_feedback)
    assert result.positions[-1, -1] == pytest.approx(with_feedback.tips[-1], abs=1e-12)
    assert result.work["actuation"][-1] > 0.0


def test_tutorial_of_learning(tutorial):
    pytest.importorskip("gymnasium")
    learning = tutorial("learning")
    learned = learning.load(TUTORIALS / "learning.json")
    assert learning.distance_at_the_end(learned, episodes=20) < 1.5  # cm
    track = learning.run(learned)
    for second in range(1, len(learning.ROUND) + 1):
        action = second * learning.ACTIONS
        apart = track.tips[action] - track.targets[action - 1]
        assert np.linalg.norm(apart) < 0.03
    # Tables are the same run as what the controller set.
    result = learning.replay(track)
    assert result.positions[-1, -1] == pytest.approx(track.tips[-1], abs=1e-12)
    # Learning finds the same whatever the number of threads, and it learns.
    again = [learning.train(6, candidates=24, episodes=2, threads=n) for n in (1, 2)]
    assert np.array_equal(again[0].weights, again[1].weights)
    untrained = learning.Learned(np.zeros(learning.WEIGHTS), [])
    assert learning.distance_at_the_end(again[0], 20) < learning.distance_at_the_end(untrained, 20)


def test_tutorial_of_fitting(tutorial):
    fitting = tutorial("fitting")
    # The slopes, against the change of the trace in another direction.
    change = 1e-3 * np.array([0.6, -0.8])
    _, slopes = fitting.side_by_side(tuple(np.log(fitting.TRUTH)))
    up, down = fitting.traces(fitting.TRUTH * np.exp([change, -change]))
    assert 0.5 * (up - down) == pytest.approx(slopes @ change, abs=1e-4 * np.abs(up - down).max())
    exact = fitting.exact_trace()
    found = fitting.fit(fitting.film(np.random.default_rng(0), exact))
    assert found.parameters == pytest.approx(fitting.TRUTH, rel=0.03)
    assert found.noise == pytest.approx(fitting.NOISE, rel=0.2)
    assert np.all(np.diff(found.interval(0.95), axis=0) > np.diff(found.interval(0.5), axis=0))
    # 95 % of 30 films are 28.5 +- 1.2; the spread has 13 % of uncertainty.
    fits = fitting.repeated(exact, films=30)
    assert np.all(fitting.coverage(fits) >= 25 / 30)
    spread = np.std(np.log([one.parameters for one in fits]), axis=0)
    assert spread == pytest.approx(np.sqrt(np.diag(found.covariance)), rel=0.35)


def test_the_page_of_failures_has_every_status():
    thrown = re.compile(r'Error\(\s*"([a-z_]+)"')
    found = {
        s for path in (ROOT / "cpp/src").rglob("*.cpp") for s in thrown.findall(path.read_text())
    }
    search = (ROOT / "cpp/src/statics/equilibrium/failure.cpp").read_text()
    found |= set(re.findall(r'return \{\s*"([a-z_]+)"', search))
    assert {"unstable_step", "model_error", "collapsed", "folded", "too_fine"} <= found
    page = (DOCS / "what_can_go_wrong.md").read_text(encoding="utf-8")
    assert [status for status in sorted(found) if f"| `{status}` |" not in page] == []


def test_formulas_are_set_and_code_is_left_alone():
    """The hook of the site: MathML in the places of formulas, in which no TeX is left."""
    pytest.importorskip("latex2mathml")
    formulas = load_module(DOCS / "formulas.py")
    page = SimpleNamespace(meta={})
    text = "So $x_1 + 1$ | `$HOME` and\n\n```sh\necho $A $B\n```\n\n$$\\frac{a}{b}$$\n"
    words = formulas.on_page_markdown(text, page)
    assert "`$HOME`" in words
    assert "echo $A $B" in words
    html = formulas.on_page_content(words, page)
    assert html.count("<math") == 2
    assert "<msub><mi>x</mi><mn>1</mn></msub>" in html
    assert 'display="block"><mrow><mfrac>' in html
    for path in DOCS.rglob("*.md"):
        formulas.on_page_markdown(path.read_text(encoding="utf-8"), page)
        wrong = [one for one in page.meta["formulas"] if "\\" in one or "$" in one]
        assert not wrong, f"{name(path)}: {wrong[0]}"


def test_the_gallery_is_fresh():
    """Its text is what the command writes; the pictures of all its scenes are there, twice."""
    gallery = load_module(DOCS / "make_gallery.py")
    written = gallery.PAGE + "".join(map(gallery.entry, gallery.SCENES))
    assert (DOCS / "gallery.md").read_text(encoding="utf-8") == written
    found = {path.name for path in (DOCS / "images" / "gallery").iterdir()}
    assert found == {f"{one}{end}.png" for one in gallery.SCENES for end in ("", "_small")}


def load_module(path):
    """The module of a file that is in no package."""
    spec = importlib.util.spec_from_file_location(path.stem, path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module
