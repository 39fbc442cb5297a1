"""Where a method is known to go wrong without failing, as ``bench stability`` and ``jumps`` map it."""

from pearlite_petsc.scene import Scene

MOST_RAJE_NU, MOST_MATCHED_NU = 0.2, 0.334
"""Poisson ratios up to which da/dN is right within 10 %."""

MOST_AFFINE_SHEAR = 0.45
"""gamma up to which the moduli of an affinely sheared mesh are right within 10 %."""

LONGEST_STEP = {"euler": 0.05, "heun": 0.2, "exponential": 0.1}
"""delta_d up to which da/dN is right within 10 %, as ``bench jumps`` measures it too."""

SMALLEST_WINDOW = 32.0
"""Side of the window over the element's longer side from which da/dN is right within 10 %."""


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
    return warnings
