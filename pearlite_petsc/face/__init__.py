"""What ``import pearlite_petsc`` offers: scenes, meshes, cracks and results in the user's units."""
