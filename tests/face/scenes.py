"""A scene whose cracks grow in a second."""

from typing import Any

import pearlite_petsc as pp

TABLES: dict[str, Any] = {
    "name": "small",
    "microstructure": {
        "prior_austenite_grain_um": 30.0,
        "block_um": 20.0,
        "colony_um": 10.0,
    },
    "window": {"width_um": 80.0, "height_um": 80.0, "notch_um": 25.0},
    "elements": {"width_um": 2.5, "length_um": 5.0, "radius_um": 15.0},
    "states": {"undeformed": {}, "severe_AT": {}},
    "loading": {"delta_k_mpa_sqrt_m": [4.0, 18.0], "extension_um": 20.0},
    "ensemble": {"meshes": 2},
    "output": {"figures": False, "fields": "none"},
}


def small_scene() -> pp.Scene:
    return pp.Scene.from_dict(TABLES)
