"""A sign of life during long work: one line on a terminal or in a notebook."""

import sys
import threading
import time
from types import TracebackType
from typing import Self, TextIO

_SECONDS_BEFORE = 5.0
"""Work that takes less says nothing."""
_SECONDS_BETWEEN = 1.0


class SignOfLife:
    """A line that says what goes on, and for how long; it is written over every second.

    Nothing is written to files and pipes. ``what``: What takes the time. ``wanted``: Whether to say
    anything.

    Examples
    --------
    >>> with SignOfLife("fit of esn") as sign:
    ...     sign.stage("search for network 1 of 3")  # quick: nothing is written
    """

    def __init__(self, what: str, *, wanted: bool = True) -> None:
        self._what, self._stage, self._written = what, "", ""
        self._start, self._over = time.monotonic(), threading.Event()
        self._stream: TextIO = sys.stderr
        self._thread: threading.Thread | None = None
        if wanted and (self._stream.isatty() or "ipykernel" in sys.modules):
            self._thread = threading.Thread(target=self._write_until_over, daemon=True)

    def stage(self, stage: str) -> None:
        """Say what goes on from now on."""
        self._stage = stage

    def __enter__(self) -> Self:
        if self._thread is not None:
            self._thread.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self._over.set()
        if self._thread is not None:
            self._thread.join()
        if self._written:
            self._write("done" if error is None else "stopped", "\n")

    def _write_until_over(self) -> None:
        wait = _SECONDS_BEFORE
        while not self._over.wait(wait):
            self._write(self._stage)
            wait = _SECONDS_BETWEEN

    def _write(self, stage: str, end: str = "") -> None:
        seconds = f"{time.monotonic() - self._start:.0f} s"
        line = f"{self._what}: {', '.join(filter(None, [stage, seconds]))}"
        self._stream.write(f"\r{line.ljust(len(self._written))}{end}")
        self._stream.flush()
        self._written = line
