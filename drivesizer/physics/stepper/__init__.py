"""Stepper motors on chopper drivers: pull-out torque, starting, and what they draw.

May import: nothing of the package.
"""

from __future__ import annotations

__all__: list[str] = []
