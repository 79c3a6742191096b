"""Whether every link of the built site leads somewhere, and nothing in it is fetched from elsewhere."""

from __future__ import annotations

import re
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

LOADED = {("img", "src"), ("script", "src"), ("iframe", "src"), ("source", "src"), ("link", "href"), ("video", "src")}
"""What a browser fetches by itself."""


class PageLinks(HTMLParser):
    """The links of a page, each with whether the browser follows it by itself, and the anchors that it has."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.links: list[tuple[str, bool]] = []
        self.anchors: set[str] = set()
        self.pictures_without_words: list[str] = []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Note a tag's links and anchors."""
        given = {name: value or "" for name, value in attrs}
        self.anchors |= {given[name] for name in ("id", "name") if name in given}
        for name in ("href", "src"):
            if name in given:
                self.links.append((given[name], (tag, name) in LOADED))
        if tag == "img" and "alt" not in given:
            self.pictures_without_words.append(given.get("src", ""))


def faults(site: Path) -> list[str]:
    """What is wrong with the links of a site, a line each with the page and the link."""
    pages = {path: PageLinks(path.read_text(encoding="utf-8")) for path in sorted(site.rglob("*.html"))}
    found = []
    for path, page in pages.items():
        name = path.relative_to(site).as_posix()
        found += [f"{name}: {link}: {why}" for link, loaded in page.links if (why := _fault(path, link, loaded, pages))]
        found += [f"{name}: {src}: a picture without words (alt)" for src in page.pictures_without_words]
    for path in sorted(site.rglob("*.css")):
        for link in re.findall(r"url\(\s*['\"]?([^'\")]+)", path.read_text(encoding="utf-8")):
            if why := _fault(path, link, True, pages):
                found.append(f"{path.relative_to(site).as_posix()}: {link}: {why}")
    return found


def _fault(path: Path, link: str, loaded: bool, pages: dict[Path, PageLinks]) -> str:
    """What is wrong with a link; "" for nothing."""
    parts = urlsplit(link.strip())
    if parts.scheme in ("data", "mailto", "javascript", "blob"):
        return ""
    if parts.scheme or parts.netloc:
        return "fetched from elsewhere" if loaded else ""
    if parts.path.startswith("/"):
        return "begins at the server's root, expected a relative link"
    goal = (path.parent / unquote(parts.path)).resolve() if parts.path else path
    goal = goal / "index.html" if goal.is_dir() else goal
    if not goal.is_file():
        return "there is no such file"
    anchor = unquote(parts.fragment)
    # What has an "=" is no place but what a page of its own shows at its start.
    if anchor and "=" not in anchor and goal in pages and anchor not in pages[goal].anchors:
        return f"there is no place '{anchor}' in it"
    return ""
