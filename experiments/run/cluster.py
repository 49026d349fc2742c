"""Where cases run: one worker process of our own, or a cluster that is already there (dask.distributed)."""

from __future__ import annotations

import logging
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import dask
from distributed import Client, LocalCluster

from scenes.errors import InputError

# a worker has it once; a task of a suite with timings holds it, so that a machine whose one worker offers it runs
# nothing of ours beside a timing
QUIET = "airlight_quiet"
CONNECT_SECONDS = 5
WORKER = "dask worker ADDRESS --nthreads 1"
SETTINGS: dict[str, Any] = {
    # a case that ends its worker is not tried on another: it would end that one too
    "distributed.scheduler.allowed-failures": 0,
    # a worker that compiles shaders or kernels for a minute is not lost
    "distributed.scheduler.worker-ttl": None,
    "distributed.admin.tick.limit": "1h",
    # threads of numpy and of the renderers as in any other process: dask would set them to one
    "distributed.nanny.pre-spawn-environ": {},
}


@contextmanager
def cluster(scheduler: str | None) -> Iterator[Client]:
    """Connect to a cluster, or start one of a single worker process with a single thread.

    A crash of a driver or of Dr.Jit ends that process alone, and dask starts another. OpenGL's context belongs to the
    worker's one thread.

    Parameters
    ----------
    scheduler : address, such as tcp://host:8786; None for a cluster of our own

    Raises
    ------
    InputError
        Nobody answers at the address.
    """
    if scheduler is not None:
        try:
            client = Client(scheduler, timeout=CONNECT_SECONDS)
        except (OSError, ValueError, TimeoutError):
            raise InputError(
                f"No scheduler of dask answers at {scheduler}; start one (`dask scheduler`) or leave --scheduler out."
            ) from None
        with client:
            yield client
        return
    with dask.config.set(SETTINGS):
        with _interrupts_blocked():
            own = _own_cluster()
        with own, Client(own) as client:
            yield client


def _own_cluster() -> LocalCluster:
    try:
        return LocalCluster(
            n_workers=1,
            threads_per_worker=1,
            processes=True,
            host="127.0.0.1",
            # any free port: two runs at a time shall not speak of each other's
            dashboard_address="127.0.0.1:0",
            # the renderers' memory is not dask's to limit
            memory_limit=0,
            resources={QUIET: 1},
            silence_logs=logging.CRITICAL,
        )
    except (RuntimeError, OSError) as error:
        raise InputError(
            f"No worker process can be started here ({error}): make room in memory and try again."
        ) from None


@contextmanager
def _interrupts_blocked() -> Iterator[None]:
    """A process that is started inside never hears Ctrl-C: the terminal sends it to all, and ours alone answers it."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def slots(client: Client, quiet: bool) -> int:
    """How many cases the cluster runs at a time.

    Raises
    ------
    InputError
        There is no worker, one cannot hold OpenGL's context or cannot be ended where it hangs, or a quiet one is asked
        for and none says that it is.
    """
    workers = client.scheduler_info(n_workers=-1)["workers"]
    if not workers:
        raise InputError(f"The cluster has no worker; start one on each machine: {WORKER}.")
    for address, worker in workers.items():
        if worker["nthreads"] != 1 or not worker.get("nanny"):
            why = "has several threads" if worker["nthreads"] != 1 else "has no nanny that could end it where it hangs"
            raise InputError(f"The cluster's worker {address} {why}; start it with {WORKER}.")
    if not quiet:
        return len(workers)
    found = sum(1 for worker in workers.values() if worker["resources"].get(QUIET))
    if not found:
        raise InputError(
            "The suite has timings, and no worker of the cluster says that nothing runs beside it: start one on each "
            f"machine with {WORKER} --resources {QUIET}=1."
        )
    return found
