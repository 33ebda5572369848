"""How far a run is, on one line of stderr."""
from __future__ import annotations

import sys
import time


class Bar:
    """Shows itself once a run takes longer than half a second."""

    def __init__(self) -> None:
        self._begin = time.monotonic()
        self._last = 0.0
        self._analysis = ""
        self._since = self._begin
        self._width = 0

    def __call__(self, analysis: str, done: float, total: float, unit: str) -> None:
        now = time.monotonic()
        if analysis != self._analysis:
            self._analysis, self._since = analysis, now
        if now - self._begin < 0.5 or now - self._last < 0.2:
            return
        self._last = now
        share = done / total if total > 0 else 0.0
        left = (now - self._since) * (1.0 - share) / share if share > 0 else 0.0
        text = f"{analysis}: {100 * share:.0f} %, {done:.0f} of {total:.0f} {unit}"
        self._write(text + (f", {left:.0f} s left" if share > 0 else ""))

    def _write(self, text: str) -> None:
        try:
            sys.stderr.write("\r" + text.ljust(self._width))
            sys.stderr.flush()
        except (AttributeError, OSError, ValueError):  # nobody reads it
            return
        self._width = len(text)

    def end(self) -> None:
        if self._width:
            self._write("")
            sys.stderr.write("\r")
