"""The cycle jumps: how many cycles pass until the next break, and what damage they do.

Each is a file of its own with one function or small class that is given a ``Situation`` and
returns a ``Block``.
"""
