"""Pages in a real browser without a window."""

from __future__ import annotations

import html
import json
import re
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest

BROWSER = next(
    (found for name in ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")
     if (found := shutil.which(name))),
    None,
)  # fmt: skip

needs_browser = pytest.mark.skipif(BROWSER is None, reason="no chromium or chrome to open the page in")


def evaluate(page: bytes, script: str, folder: Path) -> Any:
    """What an async function with this body returns at the end of a page, by way of JSON."""
    assert BROWSER is not None
    ending = (
        "<script>(async () => { const frame = () => new Promise((done) => setTimeout(done, 20)); let result;\n"
        f"try {{ result = await (async () => {{ {script} }})(); }} catch (error) {{ result = String(error); }}\n"
        'const pre = document.createElement("pre"); pre.id = "result"; pre.textContent = JSON.stringify(result);\n'
        "document.body.append(pre); })();</script></body>"
    )
    path = folder / "page.html"
    # A browser without a window draws when it likes, and virtual time does not wait for it.
    steady = b"<script>window.requestAnimationFrame = (draw) => setTimeout(draw, 0);</script></head>"
    path.write_bytes(page.replace(b"</head>", steady).replace(b"</body>", ending.encode()))
    done = subprocess.run(
        [BROWSER, "--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage",
         f"--user-data-dir={folder / 'profile'}",
         "--window-size=1200,800", "--virtual-time-budget=5000", "--dump-dom", path.as_uri()],
        capture_output=True, text=True, timeout=60, check=True,
    )  # fmt: skip
    (text,) = re.findall(r'<pre id="result">(.*?)</pre>', done.stdout, re.DOTALL)
    return json.loads(html.unescape(text))
