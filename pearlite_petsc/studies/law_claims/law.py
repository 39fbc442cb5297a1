"""The claims about any law, by its type."""

from pearlite_petsc.errors import PearliteError
from pearlite_petsc.laws.cycle_jump import CycleJumpLaw
from pearlite_petsc.laws.damage import DamageLaw
from pearlite_petsc.laws.law import Law
from pearlite_petsc.laws.springs import SpringLaw
from pearlite_petsc.scene import Scene
from pearlite_petsc.studies.law_claims.cycle_jump import cycle_jump_claims
from pearlite_petsc.studies.law_claims.damage import damage_claims
from pearlite_petsc.studies.law_claims.springs import spring_claims
from pearlite_petsc.studies.verification.claim import Section

_CLAIMS = {
    DamageLaw: damage_claims,
    SpringLaw: spring_claims,
    CycleJumpLaw: cycle_jump_claims,
}


def law_claims(law: Law, scene: Scene) -> Section:
    """Return the claims about a law; one that fails to answer is a claim that does not hold.

    Args:
        law: The law.
        scene: A scene that has chosen it.
    """
    section = Section(f'[{law.table}] {law.key} = "{law.name}"')
    try:
        _CLAIMS[type(law)](section, scene)
    except PearliteError as error:
        section.true("The law answers", "", "an answer", str(error), False)
    except Exception as error:
        # Whatever goes wrong where the program calls what a law returned is the law's.
        text = f"{type(error).__name__}: {error}"
        section.true("What the law returns can be used", "", "no error", text, False)
    return section
