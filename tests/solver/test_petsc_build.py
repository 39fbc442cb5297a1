"""What the record of a run says of PETSc."""

from pearlite_petsc.solver.petsc import PETSc
from pearlite_petsc.solver.petsc_build import petsc_facts


def test_version_and_size_of_integers_are_those_of_the_library() -> None:
    facts = petsc_facts()
    assert facts["petsc"].split(".")[:2] == [str(part) for part in PETSc.Sys.getVersion()[:2]]
    assert int(facts["petsc_integer_bytes"]) in (4, 8)
    assert facts["petsc_configure"] == "" or "--with-" in facts["petsc_configure"]
