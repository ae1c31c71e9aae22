"""Closed loops: the drive train as a linear plant, gains, loop analysis, simulation and its checks.

Two engines, each held against the other: python-control has PID and motor as linear systems (poles, margins, step
responses, by which gains are designed); the program's own simulation adds limits, friction, backlash, heat and a source
that sags, exact between samples by matrix exponentials, as machine code.

May import: physics, platform, catalog, loads, spec, results, load_cases; not machine.
"""

from __future__ import annotations
