"""A platform on wheels in the plane: how its wheels turn, and what turns them.

May import: files, physics.
"""
