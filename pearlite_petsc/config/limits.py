"""Limits beyond which a method is wrong without failing, as ``bench stability`` and ``jumps`` show."""

from pearlite_petsc.scene import Scene

MOST_RAJE_NU, MOST_MATCHED_NU = 0.2, 0.334
"""Poisson ratios up to which da/dN is right within 10 %."""

MOST_AFFINE_SHEAR = 0.45
"""gamma up to which the moduli of an affinely sheared mesh are right within 10 %."""

LONGEST_STEP = {"euler": 0.05, "heun": 0.2, "exponential": 0.1}
"""delta_d up to which da/dN is right within 10 %, as ``bench jumps`` measures it too."""

SMALLEST_WINDOW = 32.0
"""Side of the window over the element's longer side from which da/dN is right within 10 %."""

SHORTEST_NOTCH = 2.0
"""Notch over the element's longer side from which every crack of ``runs/geometry_only.toml`` grew.

Of its 20 cracks in a window of 200 um, 7, 4, 5, 1, 0 failed with notches of 0.1, 1, 2.5, 5, 10 um.
"""

MPA_SQRT_M = 1e3
"""One MPa sqrt(m) in MPa sqrt(um)."""


def method_warnings(scene: Scene) -> list[str]:
    """Return one sentence for each method that the scene takes beyond its limit."""
    material, jump = scene.material, scene.cycle_jump
    nu, springs = material.poisson_ratio, material.springs.name
    warnings = []
    if springs == "raje" and nu > MOST_RAJE_NU:
        warnings.append(
            f'springs = "raje" with poisson_ratio = {nu:g}: above {MOST_RAJE_NU:g} da/dN is wrong by '
            'more than 10 % on a Voronoi mesh (0.3: +34 %); "homogeneous" is exact.'
        )
    if springs == "matched" and nu > MOST_MATCHED_NU:
        warnings.append(
            f'springs = "matched" with poisson_ratio = {nu:g}: above {MOST_MATCHED_NU:g} da/dN is '
            'wrong by more than 10 % (0.4: +18 %); "homogeneous" is exact.'
        )
    sheared = [s.name for s in scene.states if abs(s.shear_strain) > MOST_AFFINE_SHEAR]
    if scene.elements.shear == "affine" and sheared:
        warnings.append(
            f'shear = "affine" in {", ".join(sheared)}: above a shear strain of '
            f"{MOST_AFFINE_SHEAR:g} the mesh is an anisotropic solid before any damage (moduli off "
            'by a factor of 3 at 2, of 680 at 30); "remesh" keeps them.'
        )
    longest = LONGEST_STEP.get(jump.method.name, 1.0)
    if jump.delta_d > longest:
        warnings.append(
            f'cycle_jump method = "{jump.method}" with delta_d = {jump.delta_d:g}: above {longest:g} '
            "da/dN is wrong by more than 10 %."
        )
    longer = max(scene.elements.width, scene.elements.length)
    side = min(scene.window.width, scene.window.height)
    if scene.loading.kind == "k_field" and side < SMALLEST_WINDOW * longer:
        warnings.append(
            f"window of {scene.window.width:g} x {scene.window.height:g} um with elements of up to "
            f"{longer:g} um: below {SMALLEST_WINDOW * longer:g} um da/dN is too high by more than "
            "10 % (15 elements across: 30 %, 30: 13 %)."
        )
    return [*warnings, *_load_warnings(scene, longer), *_threshold_warnings(scene)]


def _load_warnings(scene: Scene, longer: float) -> list[str]:
    """Return one sentence for each load that is not fatigue or has no room."""
    loading, tough = scene.loading, scene.material.fracture_toughness
    warnings = []
    broken = [d for d in loading.delta_k if d / (1.0 - loading.load_ratio) > tough]
    if broken:
        shown = ", ".join(f"{d / MPA_SQRT_M:g}" for d in broken)
        warnings.append(
            f"Delta-K = {shown} MPa sqrt(m): K_max = {broken[-1] / (1.0 - loading.load_ratio) / MPA_SQRT_M:g} "
            f"is above the fracture toughness of {tough / MPA_SQRT_M:g} MPa sqrt(m) "
            "(material.fracture_toughness_mpa_sqrt_m): the steel breaks at the first load, and da/dN is "
            "not a fatigue growth rate."
        )
    if scene.window.notch < SHORTEST_NOTCH * longer:
        warnings.append(
            f"notch of {scene.window.notch:g} um with elements of up to {longer:g} um: below "
            f"{SHORTEST_NOTCH * longer:g} um the singular load of the tip lies on the window's edge; "
            "cracks fail there, or their rate is an effect of the edge."
        )
    return warnings


def _threshold_warnings(scene: Scene) -> list[str]:
    """Return one sentence for each state that is loaded at or below its threshold."""
    warnings = []
    for state in scene.states:
        low = [value for value in scene.loading.delta_k if value <= state.delta_k_th]
        if low:
            shown = ", ".join(f"{value / MPA_SQRT_M:g}" for value in low)
            warnings.append(
                f"Delta-K = {shown} MPa sqrt(m) is not above delta_k_th_mpa_sqrt_m = "
                f"{state.delta_k_th / MPA_SQRT_M:g} of {state.name}: expect cracks that arrest."
            )
    return warnings
