"""Figures: plain data and a path in, PNG and SVG out."""
