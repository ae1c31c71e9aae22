"""One drive in its machine: its load cycle, losses and temperatures, battery, mass and the platform's budgets.

Battery, mass, room, footing and grip are budgets: they count whatever method ranks, and drives that pass their own
checks are checked against them in order until as many pass as are required. ``problem`` makes one frozen record of a
spec: wheels as load cases, every load cycle, belts out of the catalogues. Each driven wheel of a platform is a load
case of its own, so that nothing behind knows of platforms.

May import: physics, platform, catalog, loads, spec, results, load_cases.
"""
