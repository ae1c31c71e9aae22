"""The live page: a spec in the browser, and its drive as it changes.

``server`` answers the page and computes nothing; ``worker`` holds a process of the engine, ``jobs`` are what it does,
each a function that yields pieces of an answer. ``guard`` decides what may be requested at all. ``page/`` is what the
browser loads.

May import: everything but the command line that calls it.
"""

from __future__ import annotations

__all__: list[str] = []
