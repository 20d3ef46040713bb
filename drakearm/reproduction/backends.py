"""Where the trials of a sweep run: joblib's backends for the processes of this computer and for clusters."""

import logging
import os
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from importlib.util import find_spec
from typing import Any

from joblib import parallel_config

from drakearm.errors import SweepError
from drakearm.reproduction.choices import Backend

_PACKAGES = {Backend.dask: "distributed", Backend.ray: "ray"}


def usable_cores() -> int:
    """How many cores of this computer this process may use."""
    return len(os.sched_getaffinity(0))


@contextmanager
def workers(backend: Backend | None, jobs: int | None) -> Iterator[None]:
    """Inside the `with` block, joblib works on a cluster, or in processes of this computer if there is no backend.

    jobs: how many trials at the same time; by default one per usable core, or all that the cluster offers.
    Raises SweepError if the backend's package is not installed.
    """
    if backend is None:
        # One thread each: the networks and arms are too small to gain from more.
        config: dict[str, Any] = {"backend": "loky", "n_jobs": jobs or usable_cores(), "inner_max_num_threads": 1}
        cluster: AbstractContextManager[None] = nullcontext()
    else:
        if find_spec(_PACKAGES[backend]) is None:
            raise SweepError(
                f"--backend {backend} needs the package {_PACKAGES[backend]}, which is not installed: "
                f"`pip install drakearm[cluster-{backend}]` installs it."
            )
        config = {"backend": backend.value, "n_jobs": jobs or -1}
        cluster = _dask_client(jobs or usable_cores()) if backend is Backend.dask else _ray_driver()
    with cluster, parallel_config(**config):
        yield


@contextmanager
def _dask_client(processes: int) -> Iterator[None]:
    """The client that the caller has, or a new one. processes: of a new cluster."""
    import dask
    from distributed import Client, get_client

    try:
        get_client()
    except ValueError:
        address = dask.config.get("scheduler-address", None)
        new = {} if address else {"n_workers": processes, "threads_per_worker": 1, "silence_logs": logging.CRITICAL}
        with Client(address, **new):
            yield
    else:
        yield


@contextmanager
def _ray_driver() -> Iterator[None]:
    import ray
    from ray.util.joblib import register_ray

    register_ray()
    if ray.is_initialized():  # by the caller
        yield
        return
    ray.init(log_to_driver=False, logging_level=logging.ERROR)
    try:
        yield
    finally:
        ray.shutdown()
