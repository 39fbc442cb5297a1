"""Assembly, near-null-space, KSP; the only package that imports petsc4py."""
