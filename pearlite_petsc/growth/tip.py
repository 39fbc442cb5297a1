"""K at the tip of a growing crack, measured on the elements round it."""

import numpy as np

from pearlite_petsc.errors import PearliteError
from pearlite_petsc.fatigue.crack import Point
from pearlite_petsc.fatigue.damage_state import DamageState
from pearlite_petsc.growth.body import CrackedBody
from pearlite_petsc.growth.case import CrackCase
from pearlite_petsc.growth.domain import Domain
from pearlite_petsc.growth.record import Record
from pearlite_petsc.mechanics.tip_fields import TipFields, fit_tip_fields
from pearlite_petsc.scene import Scene

RING = (2.0, 6.0)
"""Radii of the ring of elements, in mean spacings of the fine ones."""


def with_tip(record: Record, case: CrackCase, body: CrackedBody, damage: DamageState) -> Record:
    """Return the record with K at the tip, where it lacks it and there is an equilibrium. Collective."""
    if not (record.lacks_tip and damage.is_solved):
        return record
    fields = measured_tip(case.scene, body.domain, body.tracker.tip)
    return record if fields is None else record.with_tip(fields, case.delta_k)


def measured_tip(scene: Scene, domain: Domain, tip: Point) -> TipFields | None:
    """Return K_I, K_II and T at a crack's tip in the last equilibrium. Collective.

    The crack is taken to run along x, as it does on the whole; how far the field round the tip is
    that of one crack tip, its misfit tells.

    Args:
        scene: Spring law and elements.
        domain: The mesh.
        tip: The tip [um].

    Returns:
        The same on all ranks; None where the spring law shows unknown elastic constants, under
        affine shear, which shows others than the law's, and where the window leaves no ring.
    """
    material, elements = scene.material, scene.elements
    nu = material.springs.poisson_ratio
    if nu is None or elements.shear == "affine":
        return None
    motions = domain.motions()
    spacing = float(np.sqrt(elements.width * elements.length))
    found: TipFields | None = None
    if domain.mesh is not None and motions is not None:
        inner, outer = (spacing * radius for radius in RING)
        try:
            found = fit_tip_fields(
                domain.mesh.centre,
                motions[:, :2],
                tip,
                0.0,
                inner,
                outer,
                material.youngs_modulus,
                nu,
            )
        except PearliteError:
            # Too few elements: at the window's edge, or all coarse.
            found = None
    shared: TipFields | None = domain.comm.bcast(found)
    return shared
