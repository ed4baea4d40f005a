"""The same results, whatever the number of cores."""

import pytest

pytestmark = pytest.mark.slow
KINDS = ("nc", "png", "pdf", "csv", "md", "tex")


def test_results_do_not_depend_on_the_number_of_cores(project, request):
    run = project.snakemake("study", cores=1)
    assert run.returncode == 0, run.stdout + run.stderr
    # Asked for now: another worker has made it by then, or is still at it.
    finished = request.getfixturevalue("finished")
    assert project.digests(*KINDS) == finished.digests(*KINDS)
