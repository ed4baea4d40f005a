# The library, and the config file before Snakemake reads it.
import os
import subprocess
import sys

from snakemake.exceptions import WorkflowError

# The package beside this workflow, not one that is installed elsewhere.
sys.path[:0] = [str(Path(workflow.basedir, name)) for name in ("workflow", "src")]

from dea.configuration.files import read_yaml
from dea.errors import InputError


def readable(path):
    """The path; where it is no valid YAML, a message with its name and line ends the workflow."""
    try:
        if isinstance(read_yaml(path, what="the configuration", example=path), dict):
            return path
    except InputError as error:
        raise WorkflowError(str(error)) from None
    raise WorkflowError(
        f"{path}: no sections in it. Take the one of this project as a template."
    )


def commit():
    """The commit that is checked out, `-dirty` where a file differs from it."""
    described = subprocess.run(
        ["git", "describe", "--always", "--dirty", "--abbrev=40", "--exclude", "*"],
        cwd=workflow.basedir,
        capture_output=True,
        text=True,
    )
    return described.stdout.strip() or "unknown"


# Every job keeps it with its products.
os.environ.update(DEA_COMMIT=commit(), DEA_RUN=str(os.getpid()))
