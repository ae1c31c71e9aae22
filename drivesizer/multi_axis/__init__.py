"""Machines of several axes: each sized with the drives that ride on it, all of them on one supply.

May import: everything up to sizing; not output.
"""

from __future__ import annotations
