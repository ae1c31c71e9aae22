"""The version of this program: named in every file that it writes."""

from __future__ import annotations

__version__ = "1.0.0"
