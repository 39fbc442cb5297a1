"""The public face: scenes, meshes, cracks and results in the user's units."""
