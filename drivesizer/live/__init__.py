"""The live page: a spec in the browser, and its drive as it changes.

``server`` answers the page and computes nothing; ``worker`` holds a process of the engine, ``jobs`` are what it does,
each a function that yields pieces of an answer. ``guard`` decides what may be requested at all. ``page/`` is what the
browser loads.
"""
