"""The live page: a spec in the browser, and its drive as it changes.

``server`` answers the page and computes nothing; ``http`` decides what may be requested at all. ``worker`` holds the
processes of the ``engine``; their jobs are functions of ``answer`` and ``catalogue``, which yield pieces of an answer.
``page/`` is what the browser loads.

Its text is the one state; form, sliders and YAML are edits of it. What it shows are the sections and figures of the
HTML report. Its own small page and server, not a framework of 50 packages, and a policy that forbids scripts inside it.

May import: everything but the command line that calls it.
"""

from __future__ import annotations
