"""Candidates to the best drives: stages of limits on columns, ranking, what would have to change where none passes.

May import: equations, physics, catalog, loads, spec, results, load_cases, machine, control; not output.
"""

from __future__ import annotations

__all__: list[str] = []
