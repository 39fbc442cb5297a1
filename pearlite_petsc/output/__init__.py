"""Tables, HDF5, XDMF, figures, report (no MPI, no PETSc)."""
