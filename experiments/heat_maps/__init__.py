"""Errors as colours: signed or absolute, of the pixel or in radiance, on one fixed scale, with the noise marked."""
