"""A real browser that opens a page and nothing else: whatever the page asks for is noted."""

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")


@contextmanager
def opened(path: Path) -> Iterator[tuple[Any, list[str]]]:
    """Open a file in the browser of this machine; the test is skipped if it has none.

    Yields
    ------
    The page, and what it asks for beside itself or says of errors, which grows.
    """
    programs = [found for name in BROWSERS if (found := shutil.which(name))]
    if not programs:
        pytest.skip(f"no browser to open the report in: none of {', '.join(BROWSERS)}")
    playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    with playwright.sync_playwright() as started:
        browser = started.chromium.launch(
            # the sandbox needs rights that a container does not have; the page is our own
            executable_path=programs[0],
            args=["--no-sandbox", "--disable-dev-shm-usage"],
        )
        try:
            page = browser.new_page(viewport={"width": 1400, "height": 900})
            said: list[str] = []
            own = path.resolve().as_uri()
            page.on(
                "request",
                lambda request: (
                    None
                    if request.url.split("#")[0] == own
                    or request.url.startswith(("data:", "blob:"))
                    else said.append(request.url)
                ),
            )
            page.on("pageerror", lambda error: said.append(str(error)))
            page.on(
                "console",
                lambda message: said.append(message.text) if message.type == "error" else None,
            )
            page.goto(own)
            yield page, said
        finally:
            browser.close()
