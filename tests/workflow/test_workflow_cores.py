"""The same results, whatever the number of cores, the folder, the time zone and the language."""

import pytest

pytestmark = pytest.mark.slow
KINDS = ("nc", "png", "pdf", "csv", "md", "tex")
# Every stage of one actuator, a figure of each kind of job, and the published models.
ONE_OF_ALL = ("results/dea1/gfrf.nc", "results/figures/fig2.png", "results/tables/recovery.csv")


def test_results_do_not_depend_on_cores_folder_time_zone_and_language(project, request):
    run = project.snakemake(*ONE_OF_ALL, cores=2, TZ="Asia/Kathmandu", LC_ALL="C", LANG="tr_TR")
    assert run.returncode == 0, run.stdout + run.stderr
    # Asked for now: another worker has made it by then, or is still at it.
    finished = request.getfixturevalue("finished")
    made = project.digests(*KINDS)
    assert {"results/dea1/record.nc", *ONE_OF_ALL} <= made.keys()
    assert made.items() <= finished.digests(*KINDS).items()
