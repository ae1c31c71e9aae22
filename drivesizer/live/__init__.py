"""The live page: a spec in the browser, and its drive as it changes.

``server`` answers the page and computes nothing; ``worker`` holds a process of the engine, ``jobs`` are what it does,
each a function that yields pieces of an answer. ``guard`` decides what may be requested at all. ``page/`` is what the
browser loads.

Its text is the one state; form, sliders and YAML are edits of it. What it shows are the sections and figures of the
HTML report. Its own small page and Starlette, not a framework of 50 packages, and a policy that forbids scripts
inside it.

May import: everything but the command line that calls it.
"""

from __future__ import annotations
