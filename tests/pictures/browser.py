"""Pages in a real browser without a window: one browser a test session, spoken to by the devtools protocol.

The protocol runs over two pipes (`--remote-debugging-pipe`), messages of JSON that end with a zero byte, so that no
library is needed for it.
"""

from __future__ import annotations

import atexit
import json
import os
import select
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Any

import pytest

BROWSER = next(
    (found for name in ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")
     if (found := shutil.which(name))),
    None,
)  # fmt: skip

needs_browser = pytest.mark.skipif(BROWSER is None, reason="no chromium or chrome to open the page in")

SETTINGS = (
    "--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--disable-quic", "--no-first-run",
    "--disable-sync", "--disable-background-networking", "--disable-component-update", "--hide-scrollbars",
    "--remote-debugging-pipe",
)  # fmt: skip

PATIENCE = 60.0
"""Seconds that an answer may take, on a machine that does much else."""

# A browser without a window draws when it likes; timers keep their order.
STEADY = """
window.requestAnimationFrame = (draw) => setTimeout(() => draw(performance.now()), 0);
window.frame = () => new Promise((done) => setTimeout(done, 20));
"""


# The browser reads at descriptor 3 and writes at 4, whichever the pipes have here.
AT_THREE_AND_FOUR = """
import fcntl, os, sys
ends = [fcntl.fcntl(int(end), fcntl.F_DUPFD, 16) for end in sys.argv[1:3]]
for end, place in zip(ends, (3, 4)): os.dup2(end, place)
os.execv(sys.argv[3], sys.argv[3:])
"""


class Browser:
    """A browser with one tab, and what happened in it since a page was opened: `errors`, and addresses `asked` for."""

    def __init__(self) -> None:
        assert BROWSER is not None
        self._folder = tempfile.TemporaryDirectory(prefix="robokin-browser-", ignore_cleanup_errors=True)
        theirs, self._write = os.pipe()
        self._read, out = os.pipe()
        self._process = subprocess.Popen(
            [sys.executable, "-S", "-c", AT_THREE_AND_FOUR, str(theirs), str(out), BROWSER, *SETTINGS,
             f"--user-data-dir={self._folder.name}", "about:blank"],
            pass_fds=(theirs, out), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip
        os.close(theirs)
        os.close(out)
        self._rest, self._number, self._session = b"", 0, ""
        self._loaded = False
        self.errors: list[str] = []
        self.asked: list[str] = []
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self._session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Network", "Log"):
            self.call(f"{domain}.enable")
        self.call("Page.addScriptToEvaluateOnNewDocument", source=STEADY)

    def close(self) -> None:
        """End the browser and take its folder away."""
        os.close(self._write)
        os.close(self._read)
        self._process.terminate()
        self._process.wait(PATIENCE)
        self._folder.cleanup()

    def call(self, method: str, **arguments: Any) -> dict[str, Any]:
        """Ask for a method of the protocol, and wait for its answer."""
        self._number += 1
        message = {"id": self._number, "method": method, "params": arguments}
        if self._session:
            message["sessionId"] = self._session
        os.write(self._write, json.dumps(message).encode() + b"\0")
        deadline = time.monotonic() + PATIENCE
        while True:
            answer = self._next(deadline)
            if answer.get("id") == self._number:
                assert "error" not in answer, f"{method}: {answer['error']}"
                found: dict[str, Any] = answer["result"]
                return found

    def open(
        self, page: Path | str, width: int = 1200, height: int = 800, theme: str = "light", fragment: str = ""
    ) -> None:
        """Open a page, a file or an address, in a window of this size and theme."""
        self.errors, self.asked = [], []
        self.shape(width, height, theme)
        self._loaded = False
        # Another address first: one that differs in its fragment alone is not loaded anew.
        self.call("Page.navigate", url="about:blank")
        self._until_loaded()
        self._loaded = False
        self.call("Page.navigate", url=(page if isinstance(page, str) else page.as_uri()) + fragment)
        self._until_loaded()

    def shape(self, width: int, height: int, theme: str = "light", touch: bool = False) -> None:
        """Give the window another size and theme, and a finger instead of a mouse."""
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)
        features = [{"name": "prefers-color-scheme", "value": theme}]
        self.call("Emulation.setEmulatedMedia", features=features)
        self.call("Emulation.setTouchEmulationEnabled", enabled=touch, maxTouchPoints=5)

    def run(self, script: str) -> Any:
        """What an async function with this body returns in the page, by way of JSON; what it throws, as text."""
        body = f"(async () => {{ {script} }})()"
        code = f"(async () => {{ try {{ return await {body}; }} catch (error) {{ return String(error); }} }})()"
        found = self.call("Runtime.evaluate", expression=code, awaitPromise=True, returnByValue=True)
        assert "exceptionDetails" not in found, found["exceptionDetails"]
        return found["result"].get("value")

    def press(self, key: str, shift: bool = False) -> None:
        """Press a key, where the focus is, and let it go."""
        codes = {"Tab": 9, "Enter": 13, " ": 32, "ArrowLeft": 37, "ArrowUp": 38, "ArrowRight": 39, "ArrowDown": 40}
        more: dict[str, Any] = {"key": key, "windowsVirtualKeyCode": codes.get(key, 0), "modifiers": 8 if shift else 0}
        if len(key) == 1:
            more["text"] = key
        self.call("Input.dispatchKeyEvent", type="keyDown" if "text" in more else "rawKeyDown", **more)
        self.call("Input.dispatchKeyEvent", type="keyUp", **more)

    def touch(self, *ways: Sequence[tuple[float, float]]) -> None:
        """Put down a finger for each way of places (x, y), move them along, and lift them."""
        for step, points in enumerate(zip(*ways, strict=True)):
            fingers = [{"x": x, "y": y, "id": i} for i, (x, y) in enumerate(points)]
            self.call("Input.dispatchTouchEvent", type="touchMove" if step else "touchStart", touchPoints=fingers)
        self.call("Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])

    def mouse(self, kind: str, x: float, y: float, **more: Any) -> None:
        """Move the mouse, press or let go its button."""
        self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, **more)

    def picture(self) -> bytes:
        """What is seen, as .png."""
        import base64

        return base64.b64decode(self.call("Page.captureScreenshot", format="png")["data"])

    def _until_loaded(self) -> None:
        deadline = time.monotonic() + PATIENCE
        while not self._loaded:
            self._next(deadline)

    def _next(self, deadline: float) -> dict[str, Any]:
        """The next message, after it was noted what it says of the page."""
        while b"\0" not in self._rest:
            ready = select.select([self._read], [], [], max(deadline - time.monotonic(), 0.0))[0]
            assert ready, "the browser gave no answer"
            part = os.read(self._read, 1 << 20)
            assert part, "the browser has ended"
            self._rest += part
        text, _, self._rest = self._rest.partition(b"\0")
        message: dict[str, Any] = json.loads(text)
        params = message.get("params", {})
        match message.get("method"):
            case "Page.loadEventFired":
                self._loaded = True
            case "Runtime.exceptionThrown":
                details = params["exceptionDetails"]
                self.errors.append(details.get("exception", {}).get("description", details["text"]))
            case "Runtime.consoleAPICalled" if params["type"] in ("error", "warning", "assert"):
                self.errors.append(str([value.get("value") for value in params["args"]]))
            case "Log.entryAdded" if params["entry"]["level"] in ("error", "warning"):
                self.errors.append(params["entry"]["text"])
            case "Network.requestWillBeSent":
                url = params["request"]["url"]
                if not url.startswith(("file:", "data:", "about:", "blob:")):
                    self.asked.append(url)
        return message


@cache
def browser() -> Browser:
    """The session's browser, started when it is first asked for."""
    started = Browser()
    atexit.register(started.close)
    return started


def evaluate(page: bytes, script: str, folder: Path) -> Any:
    """What an async function with this body returns in a page; `await frame()` lets the page draw."""
    path = folder / "page.html"
    path.write_bytes(page)
    tab = browser()
    tab.open(path)
    return tab.run(script)
