"""One crack: a mesh at one Delta-K. Wires tessellation, mechanics, fatigue and solver."""
