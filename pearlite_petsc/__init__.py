"""Fatigue crack growth in sheared pearlitic rail steel by the discrete element method."""

__version__ = "0.1.0"
