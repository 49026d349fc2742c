"""Meshes: where they come from, how they are read, mended and made."""
