"""Results as JSON documents, and their schema.

May import: what output may.
"""

from __future__ import annotations
