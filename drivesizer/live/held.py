"""Memory of a process of the engine between jobs, and the sign by which a job stops."""

from __future__ import annotations

import time
from collections import OrderedDict
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from drivesizer.errors import DrivesizerError
from drivesizer.files.text import hand_over, state_of, states

__all__ = ["EngineMemory", "Piece", "StoppedError", "take_over"]

Piece = dict[str, Any]
_LOOK = 0.01  # s between looks at newer requests
_KEPT = 4  # sizings: that of the page, and those of which someone wants a file or a comparison


class StoppedError(Exception):
    """A newer request has come: nobody waits for this answer."""


@dataclass(slots=True)
class EngineMemory:
    """Memory of a process of the engine between jobs."""

    name: str  # of the file that the page edits, as messages call it
    stopped: Callable[[], bool] = lambda: False
    sized: OrderedDict[str, Any] = field(default_factory=OrderedDict)  # sizings by their spec's text
    shelf: dict[str, Any] = field(default_factory=dict)  # shipped catalogues by name, each by itself
    own: tuple[str, ...] = ()  # names of the user's catalogues

    def go_on(self, *_: int) -> None:
        """Stop a job of which nobody wants the answer; takes the numbers of a progress."""
        if self.stopped():
            raise StoppedError

    def rest(self, seconds: float) -> None:
        """Wait for a newer request: while a slider moves nobody looks at more than the ranking."""
        for _ in range(round(seconds / _LOOK)):
            self.go_on()
            time.sleep(_LOOK)

    def keep(self, key: str, make: Callable[[], Any]) -> Any:
        """A sizing that was made before of the same files, or is made now."""
        kept, files = self.sized.get(key, (None, {}))
        if kept is None or any(state_of(name) != state for name, state in files.items()):
            before = states()
            kept = make()
            files = states() | before  # of one that changes meanwhile the earlier state
            while len(self.sized) >= _KEPT:
                self.sized.popitem(last=False)
        self.sized[key] = kept, files
        self.sized.move_to_end(key)
        return kept


def take_over(held: EngineMemory, own: Mapping[str, bytes]) -> None:
    """Take the user's catalogues in place of those before, and read them; what was found with these is forgotten."""
    from drivesizer.catalog import load

    hand_over({Path(held.name).parent / name: content for name, content in own.items()})
    held.own = tuple(own)
    held.sized.clear()
    with suppress(DrivesizerError, MemoryError):  # said where it is used
        for name in own:
            load([name], beside=Path(held.name).parent)
