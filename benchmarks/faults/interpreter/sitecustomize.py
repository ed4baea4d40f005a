"""Python imports this at its start where the folder is on PYTHONPATH."""

from benchmarks.faults.host_faults import apply

apply()
