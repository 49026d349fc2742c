"""Runs a suite: its cases as tasks on dask.distributed, every finished row kept at once."""
