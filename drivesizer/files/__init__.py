"""Files in and out: text, CSV and YAML read strictly, types of fields, outputs written whole or not at all, caches.

May import: errors, units.
"""

from __future__ import annotations
