"""Steppers, which run open-loop: pulses along the profile, the rotor behind them, and lost steps.

May import: results, load_cases, loads, physics, spec, files, and control's own records.
"""

from __future__ import annotations
