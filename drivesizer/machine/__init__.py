"""Drives in their machine: load cycles, losses and temperatures, bus and battery, mass and the platform's budgets.

Battery, mass, room, footing and grip are budgets: they count whatever method ranks, and drives that pass their own
checks are checked against them in order until as many pass as are required. ``problem`` makes one frozen record of a
spec: wheels as load cases, every load cycle, belts out of the catalogues. Each driven wheel of a platform is a load
case of its own, so that nothing behind knows of platforms.

A machine is a list of axes, of which a plain spec has one. Of each piece of a drive's course mean, largest and least
power are kept, so that pieces of several drives add up to bounds of the sum: it is judged on the safe side, and no axis
needs the waveform of another.

May import: physics, platform, catalog, loads, spec, results, load_cases.
"""
