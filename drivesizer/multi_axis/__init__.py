"""Machines of several axes: each sized with the drives that ride on it, all of them on one supply.

Of each piece of a drive's course mean, largest and least power are kept, so that pieces of several drives add up to
bounds of the sum: it is judged on the safe side, and no axis needs the waveform of another.

May import: everything up to sizing; not output.
"""

from __future__ import annotations
