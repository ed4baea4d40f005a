"""What each rule of the workflow runs: read inputs, call the library, write outputs."""

import os

# Sums that threads share are rounded differently (docs/decisions/0010-one-thread-per-job.md). Set
# before a stage imports numpy, whose linear algebra reads it once; Snakemake sets a rule's threads.
os.environ |= {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
