"""The commands of the terminal: options in, functions called, results printed.

May import: everything but cli.
"""

from __future__ import annotations
