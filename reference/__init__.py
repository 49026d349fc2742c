"""The truth: a Mitsuba integrator for single scattering, its convergence, and its check against `volpath`."""
