"""Scenes that are played: the player without a page, and its page in a browser."""

import io
import re
import signal
import subprocess
import sys
import threading
import time

import der
import numpy as np
import pytest
from browsers import REQUIRED, assert_no_errors, wait_for
from der.playing.controls import controls_of, with_names
from der.playing.player import Player
from PIL import Image


@pytest.fixture
def swing(swing):
    """The rod that swings, at its own speed."""
    swing["time"]["duration"] = 1
    return swing


@pytest.fixture
def still(swing):
    """A rod that nothing moves, with a load that can be set."""
    push = {"rod": "arm", "at": "end", "force": [0, 0]}
    swing["loads"] = [{"name": "push", "point_force": push}, {"damping": {"coefficient": 0.5}}]
    return swing


def control(player, path):
    return next(one for one in player.controls if one.path == path)


def play_for(player, seconds):
    for _ in range(round(30 * seconds)):
        player.advance(1 / 30, budget=10.0)


def test_time_goes_with_the_clock(swing):
    player = Player(swing)
    play_for(player, 1.1)
    assert player.simulation.time == pytest.approx(1.1, abs=0.0021), "beyond the duration"
    player.speed = 0.1
    play_for(player, 0.5)
    assert player.simulation.time == pytest.approx(1.15, abs=0.0021)
    assert player.share == pytest.approx(1.0)
    reference = der.Simulation(swing)
    reference.step(player.simulation.step_count)
    np.testing.assert_array_equal(player.simulation.positions, reference.positions)


def test_steps_of_no_fixed_length(swing):
    swing["time"] = {"duration": 1, "tolerance": 1e-2}
    player = Player(swing)
    play_for(player, 0.4)
    assert 0.4 <= player.simulation.time < 0.5
    player.grab(np.array([1.0, 0.0]))
    player.drag(np.array([0.0, 0.5]))
    play_for(player, 0.4)
    assert player.failure == ""


def test_what_is_not_reached_is_not_made_up_for(swing):
    player = Player(swing)
    for _ in range(60):
        player.advance(1 / 30, budget=0.0)
    assert player.simulation.time == 0.0
    assert player.share < 0.01
    play_for(player, 0.1)
    assert player.simulation.time == pytest.approx(0.1, abs=0.0041)


def test_pause_step_and_reset(swing):
    player = Player(swing)
    player.step()
    assert (player.paused, player.simulation.step_count) == (True, 1)
    play_for(player, 0.1)
    assert player.simulation.step_count == 1
    player.paused = False
    play_for(player, 0.1)
    assert player.simulation.time == pytest.approx(0.102, abs=0.0021)
    player.reset()
    assert player.simulation.time == 0.0
    play_for(player, 0.1)
    assert player.simulation.time == pytest.approx(0.1, abs=0.0021)


def test_values_are_set_and_reset(still):
    player = Player(still)
    push = control(player, "push.y")
    player.set(push, -0.02)
    play_for(player, 0.5)
    assert player.value(push) == pytest.approx(-0.02)
    assert player.simulation.positions[-1, 1] < -0.001
    player.reset()
    assert player.value(push) == 0.0


def test_names_for_what_has_none(swing):
    swing["supports"][0]["prescribe"] = {"y": 0, "angle": {"times": [0, 1], "values": [0, 2]}}
    force = {"rod": "arm", "at": "end", "force": [0, 0]}
    swing["loads"] += [{"point_force": force}, {"name": "support", "point_force": force}]
    swing["loads"] += [{"point_force": force}, {"damping": {"coefficient": 0.1}}]
    simulation = der.Simulation(with_names(der.Scenario.from_dict(swing)))
    assert list(simulation.names) == [
        "support_2",
        "gravity",
        "point_force",
        "support",
        "point_force_2",
    ]
    reaches = {one.path: (one.reach, one.unit) for one in controls_of(simulation)}
    assert reaches["support_2.angle"] == (4.0, "rad"), "twice the largest value"
    assert reaches["support_2.y"] == (pytest.approx(0.3), "m"), "what is seen"
    assert reaches["gravity.x"] == reaches["gravity.y"] == (19.7, "m/s^2")


def test_sliders_of_servos_and_tendons(swing):
    arm = swing["rods"][0]
    hand = {**arm, "name": "hand", "from": arm["to"], "to": [arm["to"][0], arm["to"][1] - 0.1]}
    swing["rods"].append(hand)
    pin = [{"rod": "arm", "at": "end"}, {"rod": "hand", "at": "start"}]
    servo = {"angle": {"times": [0, 1], "values": [0, 1.5]}}
    swing["joints"] = [
        {"name": "wrist", "kind": "hinge", "of": pin, "prescribe": servo},
        {"name": "root", "of": [{"rod": "arm", "at": "start"}]},
        {"name": "tip", "of": [{"rod": "hand", "at": "end"}]},
    ]
    swing["springs"] = [{"name": "tendon", "between": ["root", "tip"], "stiffness": 1}]
    simulation = der.Simulation(with_names(der.Scenario.from_dict(swing)))
    sliders = {one.path: one for one in controls_of(simulation)}
    assert (sliders["wrist.angle"].least, sliders["wrist.angle"].reach) == (-3.0, 3.0)
    length = np.linalg.norm(np.subtract(hand["to"], arm["from"]))
    tendon = sliders["tendon.rest_length"]
    assert tendon.least == 0.0
    assert tendon.reach == pytest.approx(2 * length, rel=0.05)
    assert tendon.unit == "m"


@pytest.mark.parametrize("name", ["finger", "spun_strip", "simply_supported", "falling_beam_3"])
@pytest.mark.filterwarnings("ignore::der.DerWarning")
def test_a_hand_pulls_and_lets_go(name):
    """Wherever it pulls, and however long steps are, it drives no oscillations."""
    player = Player(f"example:{name}")
    simulation = player.simulation
    start = simulation.positions.copy()
    free = np.unique(simulation.free_dofs[simulation.free_dofs < start.size] // start.shape[1])
    size = np.ptp(start, axis=0).max()
    for node in (free[len(free) // 2], free[-1]):
        player.reset()
        player.grab(start[node] + 1e-6 * size)
        assert player.pulled is not None
        assert player.pulled[0] == node
        player.drag(start[node] + 0.1 * size)
        play_for(player, 3.0)
        assert player.failure == ""
        player.release()
        play_for(player, 0.2)
        assert (player.failure, player.pulled) == ("", None)


def test_a_pulled_rod_goes_where_the_hand_is(still):
    player = Player(still)
    player.grab(np.array([1.0, 0.02]))
    player.drag(np.array([1.0, 0.3]))
    play_for(player, 4.0)
    assert 0.1 < player.simulation.positions[-1, 1] < 0.3
    player.release()
    play_for(player, 8.0)
    assert abs(player.simulation.positions[-1, 1]) < 0.01


def test_a_held_node_is_not_pulled(still):
    player = Player(still)
    player.grab(np.array([0.0, 0.0]))
    assert player.pulled is None
    player.drag(np.array([0.0, 0.1]))
    play_for(player, 0.1)
    assert np.all(player.simulation.positions[:, 1] == 0.0)


def test_a_failure_is_said_and_can_be_reset():
    player = Player("example:falling_beam_3_explicit_unstable")
    player.grab(player.simulation.positions[0])
    play_for(player, 0.5)
    assert "diverged" in player.failure
    assert player.pulled is None
    at = player.simulation.time
    player.step()
    assert player.simulation.time == at
    player.reset()
    assert (player.failure, player.simulation.time) == ("", 0.0)


def test_a_static_scene_has_no_motion():
    with pytest.raises(ValueError, match=r"'static' does not move: .*give it 'time"):
        Player("example:cantilever")


@pytest.mark.usefixtures("viser")
def test_a_port_that_is_none(swing):
    with pytest.raises(ValueError, match="port must be a whole number of at least 1 and at most"):
        der.play(swing, port=70000)


def test_without_viser(swing, monkeypatch):
    monkeypatch.setitem(sys.modules, "viser", None)
    with pytest.raises(ModuleNotFoundError, match=re.escape("pip install 'der[live]'")):
        der.play(swing)


@pytest.fixture
def viser():
    if not REQUIRED:
        pytest.importorskip("viser")


COMMAND = [sys.executable, "-m", "der", "play"]


@pytest.mark.usefixtures("viser")
def test_ctrl_c_ends_the_command():
    command = [*COMMAND, "example:finger", "--port", "8931"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        assert process.stdout.readline().startswith(b"http://localhost:89")
        process.send_signal(signal.SIGINT)
        out, error = process.communicate(timeout=120)
    assert (process.returncode, out, error) == (130, b"", b"interrupted\n")


def test_command_says_what_a_scene_lacks():
    done = subprocess.run([*COMMAND, "example:cantilever"], capture_output=True, text=True)
    assert done.returncode == 1
    assert done.stderr.startswith("error: ")


@pytest.mark.usefixtures("viser")
def test_page(browser, still, monkeypatch, capfd):
    """Buttons, sliders and the mouse of the page act on the player, and it ends with the page."""
    from selenium.webdriver.common.action_chains import ActionChains
    from selenium.webdriver.common.keys import Keys

    players = []
    monkeypatch.setattr(
        "der.playing.player.Player", lambda scene: players.append(Player(scene)) or players[0]
    )
    thread = threading.Thread(target=der.play, args=(still,), kwargs={"port": 8941})
    thread.start()

    def until(happens):
        end = time.monotonic() + 120
        while not happens():
            assert time.monotonic() < end
            assert thread.is_alive()
            time.sleep(0.05)

    address = ""
    while not address:
        address = capfd.readouterr().out.partition(" ")[0]
        assert thread.is_alive()
    browser.get(address)
    text = "document.body.innerText"
    wait_for(browser, f"{text}.includes('Swinging rod') && {text}.includes('t = ')", 180)
    (player,) = players
    simulation = player.simulation

    def button(name):
        browser.find_element("xpath", f"//button[normalize-space()='{name}']").click()

    # The rod goes through the middle of the page, with its tip half a length to the right.
    canvas = browser.find_element("css selector", "canvas")
    scale = canvas.rect["height"] / (2 * 2.2 * np.tan(np.radians(20)))
    hand = ActionChains(browser, duration=50)
    hand.move_to_element_with_offset(canvas, round(0.3 * scale), 0).click_and_hold()
    for _ in range(4):
        hand.move_by_offset(0, -round(0.05 * scale))
    hand.perform()
    until(lambda: player.pulled is not None)
    node = player.pulled[0]
    assert node == 8, "the nearest one"
    until(lambda: player.pulled[1][1] > 0.1)
    until(lambda: simulation.positions[node, 1] > 0.01)
    picture = Image.open(io.BytesIO(browser.get_screenshot_as_png())).convert("RGB")
    red, _, blue = np.moveaxis(np.asarray(picture, dtype=int), -1, 0)
    assert 0.0 < (red > blue + 100).mean() < 0.02, "the hand and its line are small"
    ActionChains(browser).release().perform()
    until(lambda: player.pulled is None)

    button("Pause")
    until(lambda: player.paused)
    steps = simulation.step_count
    button("Step")
    until(lambda: simulation.step_count == steps + 1)
    button("Reset")
    until(lambda: simulation.step_count == 0)
    slider = browser.find_elements("css selector", "[role=slider]")[1]
    slider.send_keys(Keys.ARROW_RIGHT * 5)
    button("Play")
    until(lambda: simulation.value("push.y") == pytest.approx(0.05))
    box = browser.find_elements("css selector", "input[inputmode=decimal]")[1]
    reach = control(player, "push.y").reach
    for text, value in (("-1.25", -1.25), ("98", reach), ("0.5", 0.5)):
        box.send_keys(Keys.CONTROL + "a")
        box.send_keys(text)
        until(lambda value=value: simulation.value("push.y") == pytest.approx(value))
    assert_no_errors(browser, but="inside passive event listener")  # of viser's own page
    browser.get("about:blank")
    thread.join(120)
    assert not thread.is_alive(), "the page is closed"
