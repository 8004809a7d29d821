"""Screenshots of the site, a view and a scene that is played, as a desktop and a phone show them.

    python docs/screenshots.py [FOLDER]

The site is that of `scripts/docs`, in `build/site`. FOLDER is `build/screenshots` if none is named.
The pictures are there to be looked at.
"""

from __future__ import annotations

import base64
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import der

ROOT = Path(__file__).parents[1]
#: Width and height [CSS pixels].
SCREENS = {"desktop": (1280, 900), "phone": (390, 844)}
PAGES = ("index", "gallery", "quickstart", "scene_reference", "comparison")
_LONGEST = 2600  # of a page [CSS pixels]


@contextmanager
def chromium() -> Iterator[Any]:
    """Give a browser without a window, driven by selenium.

    Raises
    ------
    ModuleNotFoundError
        Without Chromium and its driver.
    """
    from selenium import webdriver

    program, driver = shutil.which("chromium"), shutil.which("chromedriver")
    if not program or not driver:
        raise ModuleNotFoundError("screenshots take the Debian packages chromium, chromium-driver")
    with tempfile.TemporaryDirectory() as folder:
        options = webdriver.ChromeOptions()
        options.binary_location = program
        for flag in (
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--enable-unsafe-swiftshader",
            "--disable-background-networking",
            "--hide-scrollbars",
            f"--user-data-dir={folder}",
        ):
            options.add_argument(flag)
        browser = webdriver.Chrome(options=options, service=webdriver.ChromeService(driver))
        try:
            yield browser
        finally:
            browser.quit()


@contextmanager
def played() -> Iterator[str]:
    """Give the address of the finger, played until its page is closed."""
    command = [sys.executable, "-m", "der", "play", "example:finger", "--port", "8961"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as player:
        try:
            assert player.stdout is not None
            yield player.stdout.readline().split()[0]
        finally:
            player.terminate()


def wait_until_played(browser: Any) -> None:
    """Wait until a page plays, and has closed and opened the finger."""
    from selenium.webdriver.support.ui import WebDriverWait

    body = ("css selector", "body")
    WebDriverWait(browser, 180).until(lambda b: "moment_clamp" in b.find_element(*body).text)
    time.sleep(5.0)
    notice = "[...document.querySelectorAll('.mantine-Notification-root')]"
    browser.execute_script(f"{notice}.forEach((one) => one.remove())")  # of a slow browser


def show(browser: Any, address: str, screen: str) -> None:
    """Open a page on a screen."""
    width, height = SCREENS[screen]
    metrics = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 500}
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", metrics)
    browser.get(address)


def write(browser: Any, path: Path, *, whole: bool) -> None:
    """Write what is seen, or the page from its top as far as is looked at."""
    options: dict[str, Any] = {"format": "png"}
    if whole:
        size = browser.execute_cdp_cmd("Page.getLayoutMetrics", {})["cssContentSize"]
        clip = {"x": 0, "y": 0, "width": size["width"], "scale": 1}
        clip["height"] = min(size["height"], _LONGEST)
        options |= {"captureBeyondViewport": True, "clip": clip}
    shot = browser.execute_cdp_cmd("Page.captureScreenshot", options)
    path.write_bytes(base64.b64decode(shot["data"]))


def main(folder: Path) -> None:
    """Write all screenshots into a folder."""
    from selenium.webdriver.support.ui import WebDriverWait

    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as made, chromium() as browser:
        view = der.run("example:finger").view(Path(made) / "view.html", open=False)
        for screen in SCREENS:
            for name in PAGES:
                page = ROOT / "build" / "site" / f"{name}.html"
                show(browser, page.as_uri(), screen)
                write(browser, folder / f"{name}_{screen}.png", whole=True)
            show(browser, view.as_uri(), screen)
            wait = WebDriverWait(browser, 60)
            wait.until(lambda b: b.find_elements("css selector", "body.ready"))
            write(browser, folder / f"view_{screen}.png", whole=False)
            with played() as address:
                show(browser, address, screen)
                wait_until_played(browser)
                write(browser, folder / f"play_{screen}.png", whole=False)


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "build" / "screenshots")
