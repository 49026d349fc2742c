"""The OpenGL techniques: passes, GLSL and the registry of techniques."""
