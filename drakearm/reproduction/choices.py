"""What a user chooses by name on the command line."""

from enum import StrEnum


class Backend(StrEnum):
    """A kind of cluster that joblib works on. The trials' folder must be on a file system that its computers share."""

    dask = "dask"  # the one at DASK_SCHEDULER_ADDRESS, else processes of this computer
    ray = "ray"  # the one at RAY_ADDRESS, else processes of this computer
