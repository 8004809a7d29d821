"""Interactive views: what the page holds, and what a browser makes of it, offline."""

import base64
import io
import json
import re
import subprocess
import sys
import time
from dataclasses import replace

import der
import numpy as np
import pytest
from browsers import assert_no_errors, wait_for
from der.fields import fields_of, rod_fields
from der.viewing.payload import make_payload
from PIL import Image


def unpack(text, *shape):
    return np.frombuffer(base64.b64decode(text), "<f4").reshape(shape)


def payload_of(page):
    text = page.read_text(encoding="utf-8")
    found = re.search(r'<script id="data" type="application/json">(.*?)</script>', text, re.DOTALL)
    return json.loads(found[1])


def test_page_holds_the_run_and_nothing_from_elsewhere(swing, tmp_path):
    swing["title"] = "Swing </script><b>&amp; <!--<script>"
    result = der.run(swing)
    page = result.view(tmp_path / "view.html")
    assert page.stat().st_size < 1.0e6, "Plotly is packed"
    data = payload_of(page)
    assert data["title"] == swing["title"]
    count = len(result.times)
    (rod,) = data["rods"]
    positions = unpack(rod["positions"], count, 11, 3)
    assert positions[:, :, :2] == pytest.approx(result.positions, abs=1e-6)
    assert np.all(positions[:, :, 2] == 0.0)
    assert np.linalg.norm(rod["outline"], axis=1) == pytest.approx(np.full(16, 0.01))
    assert unpack(rod["directors"], 3).tolist() == [0.0, 0.0, 1.0], "the same everywhere"
    (fields,) = rod_fields(result)
    for name, values in fields.at_nodes.items():
        scale = np.abs(values).max()
        assert unpack(rod["fields"][name], count, 11) == pytest.approx(values, abs=1e-6 * scale)
        assert data["fields"][name]["high"] == pytest.approx(values.max())
    assert data["captions"][3] == "t = 0.03 s"
    (probe,) = data["probes"]
    assert (probe["name"], probe["unit"]) == ("tip", "m")
    assert probe["values"] == list(result.probes["tip"])
    assert (probe["low"], probe["high"]) == (min(probe["values"]), max(probe["values"]))
    assert data["supports"][0]["kind"] == "clamp"
    # A script or style from elsewhere would need one of these.
    before = page.read_text(encoding="utf-8").partition('<script id="data"')[0]
    assert "src=" not in before
    assert re.findall(r'href="(?!data:)', before) == []


def test_supports_and_spheres(tube, spheres):
    pin, roller = make_payload(der.run(tube))["supports"]
    assert (pin["kind"], roller["kind"]) == ("pin", "roller")
    assert pin["down"] == roller["down"] == [0.0, -1.0, 0.0]
    assert (pin["place"], roller["place"]) == (0, 20)
    data = make_payload(der.run(spheres))
    assert data["rods"][0]["spheres"] == [(0, 0.005), (1, 0.025), (2, 0.005)]
    assert data["low"][2] < -0.025 < 0.025 < data["high"][2], "spheres have a depth"


def test_clamps_turn_as_they_are_prescribed_to(swing):
    still = make_payload(der.run(swing))
    assert still["supports"][0]["tangents"] == [[1.0, 0.0, 0.0]], "once, whatever the rod does"
    swing["supports"][0]["prescribe"] = {"angle": {"times": [0, 0.2], "values": [0, 1]}}
    result = der.run(swing)
    (clamp,) = make_payload(result)["supports"]
    angles = 5.0 * result.times
    turned = np.column_stack([np.cos(angles), np.sin(angles), np.zeros_like(angles)])
    assert np.array(clamp["tangents"]) == pytest.approx(turned, abs=1e-12)


@pytest.mark.parametrize(
    ("start", "length", "titles", "metres"),
    [
        (0.0, 1.0, ["x [m]", "y [m]"], 1.0),
        (0.0, 2e-5, ["x [µm]", "y [µm]"], 1e-6),
        (1e6, 1.0, ["x - 1000000 [m]", "y [m]"], 1.0),
        (-3.0, 5e-3, ["x + 3000 [mm]", "y [mm]"], 1e-3),
    ],
)
def test_lengths_are_those_of_the_axes(swing, start, length, titles, metres):
    rod = swing["rods"][0]
    rod |= {"from": [start, 0], "to": [start + length, 0]}
    rod["cross_section"] = {"circle": {"radius": 0.01 * length}}
    del swing["time"], swing["output"]["every"], swing["loads"]
    swing["analysis"] = "static"
    result = der.run(swing)
    data = make_payload(result)
    assert data["axes"][:2] == titles
    origin = start if abs(start) > 100 * length else 0.0
    drawn = unpack(data["rods"][0]["positions"], 2, 11, 3)[-1, :, 0].astype(np.float64)
    assert origin + metres * drawn == pytest.approx(result.positions[-1, :, 0], abs=1e-6 * length)
    outline = np.array(data["rods"][0]["outline"])
    assert outline.max() == pytest.approx(0.01 * length / metres)
    assert 0.0 < data["high"][0] - length / metres < 0.5 * length / metres


def spring_supports(tube):
    tube["supports"] = [
        {"rod": "beam", "at": "start", "fix": ["x", "y"], "spring": {"rotational_stiffness": 50.0}},
        {"rod": "beam", "at": "end", "spring": {"stiffness": [2e4, 1e4]}},
        {"rod": "beam", "at": 0.31, "spring": {"stiffness": [0, 3e3]}},
    ]
    return tube


def test_springs(tube):
    turning, end, between = make_payload(der.run(spring_supports(tube)))["springs"]
    assert (turning["along"], turning["turns"]) == ([], True)
    assert (end["nodes"], end["weights"], end["turns"]) == ([20], [1.0], False)
    assert end["along"] == [[1, 0, 0], [0, -1, 0]], "away from the rod, and to the ground"
    assert between["along"] == [[0, -1, 0]]
    assert between["nodes"] == [4, 5, 6, 7, 8, 9]


def test_loads_and_gravity(tube):
    table = {"times": [0, 0.1], "values": [[0, -1000], [0, -2000]]}
    tube["loads"] = [
        {"gravity": [0, -9.81]},
        {"point_force": {"rod": "beam", "at": 0.76, "force": table}},
        {"moment": {"rod": "beam", "at": "end", "moment": -3}},
        {"distributed_force": {"rod": "beam", "force": [2, 0], "to": 0.5}},
    ]
    data = make_payload(der.run(tube))
    assert data["note"] == "gravity (0, -9.81) m/s²"
    first, last = (data["loads"][data["load_set"][frame]] for frame in (0, -1))
    assert first[0] | {"share": 0} == {
        **{"kind": "force", "rod": 0, "place": 15, "share": 0},
        **{"along": [0, -1, 0], "text": "1 kN"},
    }
    assert first[0]["share"] == pytest.approx(0.2)
    assert last[0]["text"] == "2 kN"
    assert (last[1]["along"], last[1]["text"]) == ([0, 0, -1], "3 N m")
    assert (last[1]["place"], last[1]["share"]) == (19, 1.0)
    assert [load["text"] for load in last[2:] if load["text"]] == ["2 N/m"]
    assert data["load_set"][5:] == [data["load_set"][5]] * (len(data["load_set"]) - 5)


def test_failed_runs_say_so(unstable):
    with pytest.raises(der.DivergedError) as caught:
        der.run(unstable)
    result = caught.value.result
    note = make_payload(result)["note"]
    assert note.startswith(f"diverged at t = {result.times[-1]:g} s, gravity")


def test_rounding_is_not_coloured(swing):
    """A straight rod that nothing loads, turned so that its coordinates are not round."""
    swing["rods"][0]["to"] = [0.3, 0.7]
    swing["loads"] = [{"point_force": {"rod": "arm", "at": "end", "force": [0.3e-9, 0.7e-9]}}]
    result = der.run(swing)
    (fields,) = rod_fields(result)
    assert 0.0 < np.abs(fields.at_nodes["curvature"]).max() < 1e-9, "rounding"
    data = make_payload(result)["fields"]
    quantities = fields_of(result.model)
    assert list(data) == list(quantities)
    for name, quantity in quantities.items():
        low, high = data[name]["low"], data[name]["high"]
        if quantity.kind == "tangent":  # constant, but not 0: rounding is less than the range
            assert high - low == pytest.approx(0.02 * abs(fields.at_nodes[name][0, 0])), name
        else:
            assert (low, high) == (-1.0, 1.0), name


def test_small_quantities_are_coloured(swing):
    """A micro-rod under a piconewton has small numbers, but they are no noise."""
    swing["rods"][0] |= {"to": [1e-5, 0], "cross_section": {"circle": {"radius": 1e-7}}}
    swing["loads"] = [{"point_force": {"rod": "arm", "at": "end", "force": [1e-12, -1e-12]}}]
    del swing["time"], swing["output"]["every"]
    swing["analysis"] = "static"
    result = der.run(swing)
    (fields,) = rod_fields(result)
    data = make_payload(result)["fields"]
    assert data["tension"]["high"] == pytest.approx(fields.at_nodes["tension"].max())
    assert data["curvature"]["low"] == pytest.approx(fields.at_nodes["curvature"].min())


def test_static_modes_and_paths(tube):
    data = make_payload(der.equilibrium(tube))
    assert data["captions"] == ["undeformed", "equilibrium"]
    assert data["probes"] == []
    assert data["quantity"] == "curvature"
    assert (data["start"], data["times"], data["speeds"]) == (1, None, [])
    assert "speed" not in data["fields"]
    path = der.continuation(tube)
    data = make_payload(path)
    assert data["chapters"][0]["title"] == "branch 0"
    assert data["captions"][-1] == "load factor 1, stable"
    del tube["time"], tube["output"]["every"]
    for analysis, words in (("modes", "Hz"), ("buckling", "load factor")):
        tube["loads"] = [{"point_force": {"rod": "beam", "at": "end", "force": [-1, 0]}}]
        tube["analysis"] = {analysis: {"count": 2}}
        data = make_payload(der.run(tube))
        assert [chapter["loops"] for chapter in data["chapters"]] == [True, True]
        assert words in data["chapters"][1]["title"]
        assert data["fields"] == {}
        assert data["quantity"] == ""


def test_run_with_one_frame(swing):
    whole = der.run(swing)
    single = replace(
        whole,
        times=whole.times[:1],
        positions=whole.positions[:1],
        velocities=whole.velocities[:1],
        turns=whole.turns[:1],
    )
    assert make_payload(single)["captions"] == ["t = 0 s"]
    none = replace(single, times=whole.times[:0])
    with pytest.raises(ValueError, match="no frame to show"):
        make_payload(none)


def test_rods_in_space(helix):
    result = der.run(helix)
    data = make_payload(result)
    assert not data["flat"]
    assert [axis[0] for axis in data["axes"]] == ["x", "y", "z"]
    assert "twist" in data["fields"]
    (clamp,) = data["supports"]
    assert (clamp["kind"], clamp["tangents"]) == ("clamp", [[1.0, 0.0, 0.0]])
    assert unpack(data["rods"][0]["positions"], len(result.times), 9, 3) == pytest.approx(
        result.positions, abs=1e-6
    )
    shape = result.scenario.to_dict()["rods"][0]["cross_section"]["rectangle"]
    corners = 0.5 * np.array([shape["width"], shape["height"]])
    assert np.abs(data["rods"][0]["outline"]) == pytest.approx(np.tile(corners, (8, 1)))
    directors = unpack(data["rods"][0]["directors"], len(result.times), 9, 3)
    assert directors[:, [0, -1]] == pytest.approx(result.directors[:, [0, -1]], abs=1e-6)


def test_an_equilibrium_in_space_starts_as_it_is_drawn(helix):
    """The undeformed shape has the sections of the drawing, the equilibrium its own."""
    del helix["time"]
    helix["analysis"] = "static"
    result = der.run(helix)
    directors = unpack(make_payload(result)["rods"][0]["directors"], 2, 9, 3)
    drawn = der.Simulation(result.scenario).directors
    assert directors[:, 0] == pytest.approx(np.stack([drawn[0], result.directors[-1, 0]]), abs=1e-6)
    assert np.abs(directors[1] - directors[0]).max() > 0.1


def test_long_runs_leave_out_frames(swing, monkeypatch):
    result = der.run(swing)
    monkeypatch.setattr("der.viewing.payload._BUDGET", 11 * 6 * 5)
    data = make_payload(result)
    kept = len(data["captions"])
    assert 4 <= kept <= 7
    assert data["note"].startswith(f"{kept} of 21 saved frames")
    assert data["times"][-1] == result.times[-1]
    assert data["chapters"][0]["last"] == kept - 1


def test_command(swing, tmp_path):
    folder = tmp_path / "run"
    der.run(swing, out=folder)
    command = [sys.executable, "-m", "der", "view", str(folder)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert done.stdout == f"{folder / 'view.html'}\n"
    assert payload_of(folder / "view.html")["title"] == swing["title"]


def test_open_shows_it_in_a_browser(swing, tmp_path, monkeypatch):
    shown = []
    monkeypatch.setattr("webbrowser.open", shown.append)
    page = der.view(der.run(swing), tmp_path / "a b.html", open=True)
    assert shown == [page.as_uri()]


def open_page(browser, page):
    browser.get(page.as_uri())
    wait_for(browser, "document.body.classList.contains('ready')")


def screenshot(browser):
    return np.asarray(Image.open(io.BytesIO(browser.get_screenshot_as_png())).convert("RGB"))


def rod_pixels(picture):
    """Where a picture has saturated colours, as rods and their colour bar have; the bar is left."""
    picture = picture[60:-80, : int(0.62 * picture.shape[1])].astype(int)
    return np.argwhere(np.ptp(picture, axis=2) > 40)


def move_slider(browser, frame):
    browser.execute_script(
        "const s = document.getElementById('slider'); s.value = arguments[0];"
        "s.dispatchEvent(new Event('input'))",
        frame,
    )


def drawn_line(browser, rods=1):
    """Centre lines as Plotly has them, and the values of their colours."""
    line = browser.execute_script(
        "const t = document.getElementById('scene').data[0]; return [t.x, t.y, t.z, t.line.color]"
    )
    return np.array([list(values)[: -rods or None] for values in line], dtype=float)


def test_browser_draws_the_run(browser, swing, tmp_path):
    result = der.run(swing)
    (fields,) = rod_fields(result)
    open_page(browser, result.view(tmp_path / "view.html"))
    assert browser.title == "Swinging rod"
    first = screenshot(browser)
    lit = rod_pixels(first)
    assert np.ptp(lit[:, 1]) > 300, "the rod spans much of the window"
    drawn = drawn_line(browser)[:2].T
    assert drawn == pytest.approx(result.positions[0], abs=1e-6)

    move_slider(browser, 20)
    wait_for(browser, "document.getElementById('caption').textContent == 't = 0.20 s'")
    line = drawn_line(browser)
    drawn = line[:2].T
    assert drawn == pytest.approx(result.positions[20], abs=1e-6)
    assert line[3] == pytest.approx(fields.at_nodes["curvature"][20], rel=1e-5, abs=1e-6)
    end = time.monotonic() + 20
    while rod_pixels(second := screenshot(browser))[:, 0].max() < lit[:, 0].max() + 10:
        assert time.monotonic() < end, "the tip does not fall on the screen"
        time.sleep(0.1)
    for name, picture in (("first", first), ("second", second)):
        Image.fromarray(picture).save(tmp_path / f"{name}.png")  # kept by pytest for a look

    browser.execute_script(
        "const s = document.getElementById('quantity'); s.value = 'tension';"
        "s.dispatchEvent(new Event('change'))"
    )
    assert drawn_line(browser)[3] == pytest.approx(
        fields.at_nodes["tension"][20], rel=1e-5, abs=1e-6
    )
    bar = "document.querySelector('#scene .cbtitle text, #scene [class*=cb] text.cbtitle') "
    bar += "|| document.querySelector('#scene [class*=cbtitle]')"
    assert "tension" in wait_for(browser, f"({bar})?.textContent")
    mesh = browser.execute_script(
        "const t = document.getElementById('scene').data[1]; return [t.x, t.y, t.z, t.intensity]"
    )
    x, y, z, _ = np.array(mesh)
    assert np.ptp(z) == pytest.approx(0.02, rel=0.05), "the tube is as thick as the rod"
    assert [x.min(), y.min()] == pytest.approx(result.positions[20].min(axis=0), abs=0.011)
    assert_no_errors(browser)


def test_browser_keeps_clamps_upright(browser, swing, tmp_path):
    """The wall stays across the tangent that is held, however the first edge turns."""
    swing["rods"][0]["material"]["youngs_modulus"] = 1e4
    swing["rods"][0]["nodes"] = 5
    result = der.run(swing)
    first_edge = result.positions[-1, 1] - result.positions[-1, 0]
    assert first_edge[1] < -0.1 * first_edge[0]
    open_page(browser, result.view(tmp_path / "view.html"))
    move_slider(browser, 20)
    wait_for(browser, "document.getElementById('caption').textContent == 't = 0.20 s'")
    wall = browser.execute_script(
        "const t = document.getElementById('scene').data[3]; return [t.x, t.y]"
    )
    x, y = np.array(wall)
    size = payload_of(tmp_path / "view.html")["symbol"]
    assert [x.min(), x.max()] == pytest.approx([-0.24 * size, 0.0], abs=1e-6)
    assert [y.min(), y.max()] == pytest.approx([-size, size])


def test_browser_titles_axes_beside_their_ticks(browser, spheres, tmp_path):
    open_page(browser, der.run(spheres).view(tmp_path / "view.html"))
    Image.fromarray(screenshot(browser)).save(tmp_path / "axes.png")
    shown = labels(browser)
    right, top = shown["x [m]"], shown["y [m]"]
    width = browser.execute_script("return document.getElementById('scene').clientWidth")
    assert 0.3 * width < right["x"] < 0.9 * width
    assert top["y"] < right["y"]
    assert top["x"] < right["x"]
    placed, ranges = browser.execute_script(
        "const s = document.getElementById('scene')._fullLayout.scene;"
        "return [s.annotations.map((one) => [one.x, one.y]), [s.xaxis.range, s.yaxis.range]]"
    )
    for place in placed:  # on an end, rounding decides whether Plotly draws it
        assert all(low < value < high for value, (low, high) in zip(place, ranges, strict=True))


def test_browser_plays(browser, swing, tmp_path):
    open_page(browser, der.run(swing).view(tmp_path / "view.html"))
    play = browser.find_element("id", "play")
    play.click()
    wait_for(browser, "Number(document.getElementById('slider').value) == 20", 120)
    wait_for(browser, "document.getElementById('play').textContent == 'Play'")
    assert browser.find_element("id", "caption").text == "t = 0.20 s"
    assert_no_errors(browser)


def test_browser_follows_keys_and_probes(browser, swing, tmp_path):
    """Keys go through the frames, a probe shows and seeks them, and `f` fits the view."""
    from selenium.webdriver.common.action_chains import ActionChains
    from selenium.webdriver.common.keys import Keys

    result = der.run(swing)
    open_page(browser, result.view(tmp_path / "view.html"))
    tip = np.asarray(result.probes["tip"])
    text = "document.querySelector('#probes figcaption').innerText"

    def at(frame):
        wait_for(browser, f"document.getElementById('slider').value == {frame}")
        name, value = browser.execute_script(f"return {text}").split("\n")
        assert name == "tip [m]"
        assert float(value) == pytest.approx(tip[frame], rel=1e-3, abs=1e-9)
        path = browser.find_element("css selector", "#probes .cursor").get_attribute("d")
        assert float(path[1:].split()[0]) == pytest.approx(100 * result.times[frame] / 0.2)

    def press(*keys):
        ActionChains(browser).send_keys(*keys).perform()

    browser.find_element("id", "slider").click()  # which has the focus then
    press("r", *[Keys.ARROW_RIGHT] * 7, Keys.ARROW_LEFT)
    at(6)
    chart = browser.find_element("css selector", "#probes svg")
    ActionChains(browser).move_to_element(chart).click().perform()
    at(10)
    press(" ")
    wait_for(browser, "document.getElementById('slider').value == 20", 120)
    press("r")
    at(0)
    assert browser.find_element("id", "play").text == "Play"

    camera = "document.getElementById('scene')._fullLayout.scene.camera.eye"
    before = browser.execute_script(f"return {camera}")
    scene = browser.find_element("id", "scene")
    ActionChains(browser).drag_and_drop_by_offset(scene, 80, 40).perform()
    wait_for(browser, f"{camera}.x != {before['x']}")
    press(Keys.ARROW_RIGHT)
    at(1)
    assert browser.execute_script(f"return {camera}")["x"] != before["x"], "it stays there"
    press("f")
    wait_for(browser, f"{camera}.x == {before['x']} && {camera}.z == {before['z']}")

    page = screenshot(browser)[5, 5]
    browser.execute_cdp_cmd(
        "Emulation.setEmulatedMedia",
        {"features": [{"name": "prefers-color-scheme", "value": "dark"}]},
    )
    wait_for(browser, "document.getElementById('scene')._fullLayout.paper_bgcolor == '#25282d'")
    assert page.min() > 250
    assert screenshot(browser)[5, 5].max() < 60
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": []})
    assert_no_errors(browser)


def test_browser_keeps_scale_and_axes(browser, spheres, tmp_path):
    open_page(browser, der.run(spheres).view(tmp_path / "view.html"))

    def scene():
        return browser.execute_script(
            "const s = document.getElementById('scene')._fullLayout.scene;"
            "return [s.xaxis.range, s.yaxis.range, s.zaxis.range,"
            " [s.aspectratio.x, s.aspectratio.y, s.aspectratio.z]]"
        )

    *ranges, ratio = before = scene()
    sizes = np.ptp(ranges, axis=1)
    assert np.array(ratio) / sizes == pytest.approx(np.full(3, ratio[0] / sizes[0]))
    move_slider(browser, 50)
    wait_for(browser, "document.getElementById('caption').textContent == 't = 0.50 s'")
    for now, then in zip(scene(), before, strict=True):
        assert now == pytest.approx(then)
    ball = browser.execute_script("return document.getElementById('scene').data[2].x")
    assert np.ptp(ball) == pytest.approx(0.11, abs=0.002)
    assert len(ball) > 3 * 800, "no corners are seen"
    assert_no_errors(browser)


def test_browser_draws_loads_and_supports(browser, tube, tmp_path):
    result = der.equilibrium(tube)
    open_page(browser, result.view(tmp_path / "view.html"))
    supports, arrow = browser.execute_script(
        "const [a, b] = document.getElementById('scene').data.slice(3);"
        "return [[a.x, a.y], [b.x, b.y]]"
    )
    assert labels(browser)["2 kN"]["height"] > 10
    x, y = np.array(arrow)
    place = np.array(
        [np.interp(0.75, result.rods[0].arc_lengths, c) for c in result.positions[-1].T]
    )
    assert [x[y.argmin()], y.min()] == pytest.approx(place, abs=1e-6), "its tip is at the point"
    x, y = np.array(supports)
    assert y.max() == pytest.approx(0.0, abs=1e-6), "they stand below the ends"
    assert [x.min(), x.max()] == pytest.approx(
        [0, result.positions[-1, -1, 0]], abs=2 * payload_of(tmp_path / "view.html")["symbol"]
    )
    assert_no_errors(browser)


def test_browser_draws_actuated_stretches(browser, swing, tmp_path):
    """A sleeve around the stretch, and its value above the scene."""
    table = {"times": [0, 0.1, 0.2], "values": [0, 1, -4]}
    part = {"name": "bend", "rod": "arm", "from": 0.35, "to": 0.75}
    swing["actuation"] = [{**part, "natural_curvature": table}]
    swing["loads"] = []
    open_page(browser, der.run(swing).view(tmp_path / "view.html"))
    legend = "document.getElementById('legend').textContent"
    assert browser.execute_script(f"return {legend}") == "bend: curvature 0 1/m"
    sleeve = "document.getElementById('scene').data.at(-2)"
    x = np.array(browser.execute_script(f"return {sleeve}.x"))
    assert [x.min(), x.max()] == pytest.approx([0.35, 0.75], abs=1e-6)
    move_slider(browser, 20)
    wait_for(browser, f"{legend} == 'bend: curvature -4 1/m'")
    values = browser.execute_script(f"return {sleeve}.intensity")
    assert set(values) == {-1}
    assert_no_errors(browser)


def labels(browser):
    """Places on the screen [pixels] of the texts in the scene besides ticks, by text."""
    return browser.execute_script(
        "const found = {};"
        "for (const one of document.querySelectorAll('#scene .annotation-text, #scene text')) {"
        "  const { x, y, width, height } = one.getBoundingClientRect();"
        "  if (one.textContent && width) found[one.textContent] = { x, y, width, height }; }"
        "return found"
    )


def test_browser_keeps_labels_readable_when_they_change(browser, swing, tmp_path):
    force = {"times": [0, 0.2], "values": [[0, 0], [0, -0.2]]}
    swing["loads"] = [{"point_force": {"rod": "arm", "at": "end", "force": force}}]
    open_page(browser, der.run(swing).view(tmp_path / "view.html"))
    assert not [text for text in labels(browser) if text.endswith("N")]
    before = None
    for frame, text in ((5, "50 mN"), (12, "120 mN"), (20, "200 mN")):
        move_slider(browser, frame)
        caption = f"t = {frame / 100:.2f} s"
        wait_for(browser, f"document.getElementById('caption').textContent == '{caption}'")
        end = time.monotonic() + 20
        while text not in (shown := labels(browser)):
            assert time.monotonic() < end, shown
            time.sleep(0.05)
        assert [one for one in shown if one.endswith("N")] == [text]
        assert shown[text]["height"] > 10
        before = before or shown[text]
        assert shown[text]["height"] == pytest.approx(before["height"], abs=1.5)
    Image.fromarray(screenshot(browser)).save(tmp_path / "labels.png")
    assert_no_errors(browser)


def test_browser_draws_springs(browser, tube, tmp_path):
    result = der.equilibrium(spring_supports(tube))
    open_page(browser, result.view(tmp_path / "view.html"))
    drawn = browser.execute_script(
        "const t = document.getElementById('scene').data.at(-1); return [t.x, t.y]"
    )
    x, y = np.array(drawn, dtype=float)  # NaN where the pen is lifted
    strokes = np.split(np.column_stack([x, y]), np.flatnonzero(np.isnan(x)))
    starts = [stroke[~np.isnan(stroke[:, 0])][0] for stroke in strokes[:-1]]
    last = result.positions[-1]
    assert starts[0] == pytest.approx(last[0], abs=1e-6), "the spiral"
    assert starts[1] == pytest.approx(last[-1], abs=1e-6)
    assert starts[2] == pytest.approx(last[-1], abs=1e-6)
    arc = result.rods[0].arc_lengths
    place = [np.interp(0.31, arc, column) for column in last.T]
    assert starts[3] == pytest.approx(place, abs=1e-3), "between two nodes"
    assert len(starts) == 4
    size = payload_of(tmp_path / "view.html")["symbol"]
    ground = browser.execute_script(
        "const t = document.getElementById('scene').data[3]; return [t.x, t.y]"
    )
    x, y = np.array(ground)
    assert x.max() == pytest.approx(last[-1, 0] + 3.16 * size), "the wall of the spring along x"
    assert y.min() == pytest.approx(min(place[1], last[-1, 1]) - 3.16 * size, abs=1e-3)
    assert_no_errors(browser)


def test_browser_switches_modes(browser, swing, tmp_path):
    del swing["time"], swing["output"]["every"]
    swing["analysis"] = {"modes": {"count": 2}}
    result = der.run(swing)
    open_page(browser, result.view(tmp_path / "view.html"))
    browser.execute_script(
        "const s = document.getElementById('chapter'); s.value = '1';"
        "s.dispatchEvent(new Event('change'))"
    )
    move_slider(browser, 24 + 6)  # a quarter of a swing
    caption = wait_for(browser, "document.getElementById('caption').textContent")
    assert caption.startswith("mode 2")
    line = browser.execute_script(
        "const t = document.getElementById('scene').data[0]; return [t.x, t.y]"
    )
    moved = np.array([values[:-1] for values in line], float).T - result.positions[-1]
    shape = result.modes.shapes[1]
    assert moved / np.abs(moved).max() == pytest.approx(shape / np.abs(shape).max(), abs=1e-4)
    assert browser.find_element("id", "quantity").is_displayed() is False
    assert_no_errors(browser)


def test_browser_without_webgl_says_so(browser, swing, tmp_path):
    """Without WebGL there is a message in place of an empty page."""
    page = der.run(swing).view(tmp_path / "view.html")
    text = page.read_text(encoding="utf-8")
    no_webgl = "<script>HTMLCanvasElement.prototype.getContext = () => null;</script>"
    page.write_text(text.replace('<script id="data"', no_webgl + '<script id="data"'), "utf-8")
    browser.get(page.as_uri())
    shown = wait_for(browser, "document.getElementById('scene').textContent")
    assert "needs WebGL" in shown
    assert browser.find_element("id", "play").is_displayed() is False
    assert_no_errors(browser)
