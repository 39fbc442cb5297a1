"""What makes a crack that ended as wanted doubtful all the same."""

from pearlite_petsc.fatigue.outcome import Outcome
from pearlite_petsc.scene import Elements

SHORT_LIFE = "ended within one load cycle, not by fatigue; is Delta-K in MPa sqrt(m)?"
FAST = "grew by more than one element per cycle, not by fatigue; is Delta-K in MPa sqrt(m)?"


def doubts(outcome: Outcome, elements: Elements) -> list[str]:
    """Return what is doubtful about a crack; empty if nothing is.

    Args:
        outcome: The task.
        elements: Their size [um].
    """
    found = []
    if outcome.extension > 0.0 and outcome.cycles < 1.0:
        found.append(SHORT_LIFE)
    elif outcome.da_dn > min(elements.width, elements.length):
        found.append(FAST)
    return found
