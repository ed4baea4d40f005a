"""The same results, whatever the number of cores."""

import pytest

pytestmark = pytest.mark.slow
KINDS = ("nc", "png", "pdf", "csv", "md", "tex")
# Every stage of one actuator, a figure of each kind of job, and the published models.
ONE_OF_ALL = ("results/dea1/gfrf.nc", "results/figures/fig2.png", "results/tables/recovery.csv")


def test_results_do_not_depend_on_the_number_of_cores(project, request):
    run = project.snakemake(*ONE_OF_ALL, cores=1)
    assert run.returncode == 0, run.stdout + run.stderr
    # Asked for now: another worker has made it by then, or is still at it.
    finished = request.getfixturevalue("finished")
    made = project.digests(*KINDS)
    assert {"results/dea1/record.nc", *ONE_OF_ALL} <= made.keys()
    assert made.items() <= finished.digests(*KINDS).items()
