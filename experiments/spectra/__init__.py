"""`airlight spectra`: what three bands get wrong against the spectrum."""
