"""Memory of a process of the engine between jobs, and the sign by which a job stops."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

__all__ = ["Held", "Piece", "StoppedError"]

Piece = dict[str, Any]
_KEPT = 4  # sizings: that of the page, and those of which someone wants a file or a comparison


class StoppedError(Exception):
    """A newer request has come: nobody waits for this answer."""


@dataclass(slots=True)
class Held:
    """Memory of a process of the engine between jobs."""

    name: str  # of the file that the page edits, as messages call it
    stopped: Callable[[], bool] = lambda: False
    sized: OrderedDict[str, Any] = field(default_factory=OrderedDict)  # sizings by their spec's text

    def go_on(self, *_: int) -> None:
        """Stop a job of which nobody wants the answer; takes the numbers of a progress."""
        if self.stopped():
            raise StoppedError

    def keep(self, key: str, make: Callable[[], Any]) -> Any:
        """A sizing that was made before, or is made now."""
        if key not in self.sized:
            self.sized[key] = make()
            while len(self.sized) > _KEPT:
                self.sized.popitem(last=False)
        self.sized.move_to_end(key)
        return self.sized[key]
