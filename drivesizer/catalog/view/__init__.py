"""The catalogue as the search takes it: estimates put in, actuators split, direct drive added.

May import: catalog and its estimates; nothing else of catalog imports it.
"""

from __future__ import annotations
