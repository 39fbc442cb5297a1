"""The short form of every claim, section by section."""

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("petsc4py")

from pearlite_petsc.studies.verification.claim import Effort, Setting
from pearlite_petsc.studies.verification.suite import SECTIONS

LEAST_CLAIMS = {
    "exact": 20,
    "elastic": 20,
    "fracture": 15,
    "crack_tip": 15,
    "damage": 20,
    "metamorphic": 10,
    "texture": 30,
}


@pytest.mark.parametrize("name", SECTIONS)
def test_every_claim_of_the_short_form_holds(name: str, tmp_path: Path) -> None:
    # A step of 0 underflows in the ODE solver, which is what it asks for.
    with np.errstate(all="warn", under="ignore"):
        section = SECTIONS[name](Setting(Effort.QUICK, tmp_path))
    failed = [claim for claim in section.claims if not claim.holds]
    assert not failed, failed
    assert len(section.claims) >= LEAST_CLAIMS.get(name, 0)
    for figure in section.figures:
        assert (tmp_path / f"{figure}.png").stat().st_size > 5000
