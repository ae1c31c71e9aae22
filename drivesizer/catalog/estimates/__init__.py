"""Figures that no data sheet gives, estimated from peers: log-linear laws with bands.

May import: catalog's columns and tables.

``laws.txt`` declares which figure follows from which others within which class of parts; ``estimate`` fits them over
the shipped catalogues, measures each on families that were left out, and applies them; ``fitted.json`` keeps what was
found (``python -m drivesizer.catalog.estimates`` prints it anew).
"""

from __future__ import annotations

from drivesizer.catalog.estimates.estimate import Estimate, as_records, estimates_of

__all__ = ["Estimate", "as_records", "estimates_of"]
