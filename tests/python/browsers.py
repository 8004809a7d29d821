"""Pages in a browser without a window; `browser` of conftest.py is one."""

import os
import time

import pytest

REQUIRED = os.environ.get("DER_REQUIRE_BROWSER") == "1"
# Without a screen and a graphics processor; nothing reaches out to the network.
FLAGS = (
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--enable-unsafe-swiftshader",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--window-size=1000,700",
)


def missing(what):
    message = f"the page was not tried in a browser: no {what}"
    if REQUIRED:
        pytest.fail(message)
    pytest.skip(message)


def wait_for(browser, script, seconds=60):
    """Wait until a script returns something true, and return that."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        found = browser.execute_script(f"return {script}")
        if found:
            return found
        time.sleep(0.05)
    pytest.fail(f"in vain: {script}; console: {browser.get_log('browser')}")
    return None


def assert_no_errors(browser, but=None):
    severe = [entry for entry in browser.get_log("browser") if entry["level"] == "SEVERE"]
    assert [entry for entry in severe if but is None or but not in entry["message"]] == []
