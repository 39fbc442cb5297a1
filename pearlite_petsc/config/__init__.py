"""Scene files: TOML in, validated frozen objects out; the only place that converts units.

``keys`` is the one table of what a scene may say; reading, writing and the JSON schema follow it.
Own code rather than a validation library: a message names file, table, key, limit and nearest known
key in one line, decimals keep their bits through units and back, and every value is written with its
meaning.
"""

from pearlite_petsc.config.absent_laws import laws_of_results
from pearlite_petsc.config.checks import estimated_elements
from pearlite_petsc.config.law_files import find_laws
from pearlite_petsc.config.law_trial import refuse_faulty_laws
from pearlite_petsc.config.limits import method_warnings
from pearlite_petsc.config.read import (
    load_scene,
    load_scene_text,
    scene_from_tables,
    state_named,
)
from pearlite_petsc.config.schema import scene_schema
from pearlite_petsc.config.write import laws_of_scene, scene_difference, scene_hash, scene_to_toml

__all__ = [
    "estimated_elements",
    "find_laws",
    "laws_of_results",
    "laws_of_scene",
    "load_scene",
    "load_scene_text",
    "method_warnings",
    "refuse_faulty_laws",
    "scene_difference",
    "scene_from_tables",
    "scene_hash",
    "scene_schema",
    "scene_to_toml",
    "state_named",
]
