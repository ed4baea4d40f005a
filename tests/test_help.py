"""Programs without options describe themselves when asked to, and do nothing else."""

import importlib

import pytest


@pytest.mark.parametrize(
    "module",
    [
        "benchmarks.__main__", "benchmarks.calibration", "dea.discrepancy.__main__",
        "dea.report.__main__", "dea.simulation.__main__",
    ],
)  # fmt: skip
@pytest.mark.parametrize(("asked", "status"), [("--help", 0), ("--unknown", 2)])
def test_a_program_that_is_asked_for_help_does_not_run(
    module, asked, status, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit) as ended:
        importlib.import_module(module).main([asked])
    assert ended.value.code == status
    assert not list(tmp_path.iterdir())
