"""Elements: nuclei, bounded Voronoi diagram, interfaces, kinds, quality."""
