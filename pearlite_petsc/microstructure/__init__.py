"""Label map: nested tessellation of grains, blocks, colonies; shear; lamella directions."""
