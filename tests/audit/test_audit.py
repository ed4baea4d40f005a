"""A small project of made-up jobs, tampered with in every way that an audit must notice."""

import errno
import fcntl
import json
import os
import re
import shutil
import subprocess
from contextlib import contextmanager
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pytest

from dea import archive, provenance
from dea.audit import Manifest, collect, verify, withdraw
from dea.audit.__main__ import main
from dea.audit.crate import write
from dea.audit.recompute import _close, recompute
from dea.audit.verify import Finding, in_order, resting_on, spoilt_by
from dea.errors import InputError
from dea.report.origin import origin

# Each result: what it is made from, and the code that makes it.
JOBS = {
    "results/a/record.nc": (["config/device.yaml"], ["src/acquire.py"]),
    "results/a/model.nc": (["results/a/record.nc"], ["src/select.py", "src/shared.py"]),
    "results/a/track.nc": (["results/a/record.nc", "results/a/model.nc"], ["src/track.py"]),
    "results/figures/fig3.png": (["results/a/track.nc"], ["src/draw.py", "src/shared.py"]),
    "results/a/model.fmu": (["results/a/model.nc"], ["src/fmi2.c"]),
    "results/tables/table1.csv": (["results/a/model.nc"], ["src/tabulate.py"]),
}


@pytest.fixture
def study(tmp_path, monkeypatch):
    """A finished study: its code committed, its results made, its manifest written."""
    monkeypatch.chdir(tmp_path)
    for sources, code in JOBS.values():
        for file in (*sources, *code):
            if not file.startswith("results"):
                Path(file).parent.mkdir(exist_ok=True)
                Path(file).write_text(f"content of {file}\n")
    Path("environment.txt").write_text("numpy==2.0.0\nsci-py==1.5\n")
    packages = ["python-3.11.7", "numpy-2.0.0", "sci_py-1.5"]
    monkeypatch.setattr(provenance, "packages", lambda: list(packages))
    git = ["git", "-c", "user.name=a", "-c", "user.email=a@b"]
    for command in (["init", "-q"], ["add", "src"], ["commit", "-q", "-m", "code"]):
        subprocess.run([*git, *command], check=True)
    commit = subprocess.run(["git", "rev-parse", "HEAD"], capture_output=True, text=True).stdout
    monkeypatch.setenv(provenance.COMMIT, commit.strip())
    for product in JOBS:
        make(monkeypatch, product)
    Path("results/a/log").mkdir(exist_ok=True)
    Path("results/a/log/track.log").write_text("converged\n")
    collect().write()
    monkeypatch.delenv(provenance.JOB)
    return packages


@contextmanager
def job(monkeypatch, product, sources, code, settings=None):
    """Run the block as the job of the workflow that makes this product."""
    monkeypatch.setenv(provenance.JOB, f"results/a/log/{Path(product).stem}.log")
    monkeypatch.setenv(provenance.RULE, Path(product).stem)
    monkeypatch.setenv(provenance.CODE, " ".join(code))
    command, inputs, outputs = ["dea.stages.x", str(product)], map(Path, sources), [Path(product)]
    with provenance.job(command, settings or {}, inputs=inputs, outputs=outputs):
        yield


def make(monkeypatch, product, settings=None):
    with job(monkeypatch, product, *JOBS[product], settings):
        Path(product).parent.mkdir(parents=True, exist_ok=True)
        Path(product).write_text(f"{product} by {provenance.current_job()}\n")


def first():
    return verify(Manifest.read())[0]


def full(self, text, encoding):
    """Write to a disk without space."""
    with self.open("w") as file:
        file.write(text[:10])
    raise OSError(errno.ENOSPC, "No space left on device")


def overwrite(file, content):
    """Change a file and keep its time."""
    time = Path(file).stat().st_mtime_ns
    Path(file).write_bytes(content)
    os.utime(file, ns=(time, time))


def test_an_untouched_study_passes(study, capsys):
    assert verify(Manifest.read()) == []
    main([])
    assert "6 results of 6 jobs are what they were made as" in capsys.readouterr().out
    page = Path("results/audit.md").read_text()
    assert "Every result is what its job made" in page
    assert provenance.digest(Path("results/MANIFEST.json")) in page
    main([])  # its own page is nothing extra


def test_an_audit_that_ends_early_leaves_no_page_of_an_earlier_one(study):
    main([])
    Path("results/MANIFEST.json").write_text("{}")
    with pytest.raises(SystemExit):
        main([])
    assert not Path("results/audit.md").exists()


def test_a_run_that_makes_results_removes_what_an_audit_said_of_those_before(study):
    main([])
    withdraw()
    assert not Path("results/audit.md").exists()


def test_what_is_broken_is_printed_where_the_page_cannot_be_written(study, monkeypatch, capsys):
    Path("results/a/model.nc").write_text("edited\n")
    monkeypatch.setattr(Path, "write_text", full)
    with pytest.raises(SystemExit) as exit_:
        main([])
    assert exit_.value.code == 1
    said = capsys.readouterr()
    assert "broken: results/a/model.nc" in said.out
    assert said.err == (
        "error: results/audit.md: cannot be written (No space left on device)."
        " Free space or allow writing there, or go by what is printed\n"
    )


@pytest.mark.parametrize(
    "file", ["results/a/track.nc", "results/figures/fig3.png", "results/tables/table1.csv"]
)
def test_a_value_a_pixel_or_a_cell_that_is_changed_is_named(study, file):
    overwrite(file, Path(file).read_bytes()[:-2] + b"X\n")
    assert first().path == file
    assert "is not what was made" in first().problem


def test_two_files_that_are_swapped_are_named(study):
    one, other = Path("results/a/model.nc"), Path("results/a/track.nc")
    contents = one.read_bytes(), other.read_bytes()
    overwrite(one, contents[1])
    overwrite(other, contents[0])
    assert [finding.path for finding in verify(Manifest.read())] == [str(one), str(other)]


def test_an_edited_module_is_named_with_what_rests_on_it(study, capsys):
    Path("src/shared.py").write_text("other\n")
    with pytest.raises(SystemExit) as exit_:
        main([])
    assert exit_.value.code == 1
    said = capsys.readouterr().out
    assert "src/shared.py: has changed" in said
    for product in ("results/a/model.nc", "results/a/track.nc", "results/figures/fig3.png"):
        assert f"rests on it: {product}" in said
    assert "record.nc" not in said


def test_edited_code_of_another_language_is_named(study):
    Path("src/fmi2.c").write_text("other\n")
    assert first().path == "src/fmi2.c"


def test_code_that_its_commit_does_not_hold_is_named(study, monkeypatch):
    Path("src/draw.py").write_text("never committed\n")
    make(monkeypatch, "results/figures/fig3.png")
    collect().write()
    assert first().path == "src/draw.py"
    assert "is not what the commit" in first().problem


def test_a_package_of_another_version_is_named(study):
    study[1] = "numpy-2.0.1"
    paths = [finding.path for finding in verify(Manifest.read())]
    assert paths[0] == "numpy"
    assert "results/a/record.nc" in paths


def test_a_package_that_the_environment_does_not_ask_for_is_named(study):
    Path("environment.txt").write_text("numpy==2.0.0\nsci-py==1.6\n")
    assert first().path == "sci-py"
    assert "asks for sci-py==1.6" in first().problem


def test_a_missing_list_of_packages_is_named(study):
    Path("environment.txt").unlink()
    assert verify(Manifest.read()) == [("environment.txt", "is missing")]


def test_a_missing_file_is_named_with_what_rests_on_it(study):
    Path("results/a/model.nc").unlink()
    path, problem = first()
    assert path == "results/a/model.nc"
    assert problem.startswith("is missing; if it is not wanted any more, delete results/provenance")
    assert resting_on("results/a/model.nc", Manifest.read()) == [
        "results/a/model.fmu", "results/a/track.nc", "results/figures/fig3.png",
        "results/tables/table1.csv",
    ]  # fmt: skip


def test_of_changed_code_the_results_made_before_are_named(study, monkeypatch):
    Path("src/shared.py").write_text("changed\n")
    for product in ("model.nc", "track.nc", "model.fmu"):
        make(monkeypatch, f"results/a/{product}")
    make(monkeypatch, "results/tables/table1.csv")
    collect().write()
    manifest = Manifest.read()
    changed = Finding("src/shared.py", "has changed since results were made with it")
    assert changed in verify(manifest)
    assert spoilt_by(changed, manifest) == ["results/figures/fig3.png"]
    make(monkeypatch, "results/figures/fig3.png")
    collect().write()
    # What its commit does not hold concerns all.
    assert first().path == "src/shared.py"
    assert spoilt_by(first(), Manifest.read()) == resting_on("src/shared.py", manifest)


def test_a_file_that_no_job_made_is_named(study):
    Path("results/tables/table2.csv").write_text("a,b\n")
    assert first() == ("results/tables/table2.csv", "was made by no job")


def test_a_file_behind_a_link_to_a_folder_is_named(study, tmp_path_factory):
    elsewhere = tmp_path_factory.mktemp("elsewhere")
    (elsewhere / "table2.csv").write_text("a,b\n")
    Path("results/more").symlink_to(elsewhere)
    Path("results/a/around").symlink_to(Path("results").resolve())
    assert found_after_another_run() == {
        "results/more/table2.csv": "was made by no job",
        "results/a/around": "was made by no job",
    }


def written(file):
    return lambda: Path(file).write_text("edited\n")


@pytest.mark.parametrize(
    ("damage", "said"),
    [
        (written("results/a/model.nc"), "…). Delete it and run again."),
        (written("results/tables/new.csv"), "no job. Delete it; a run makes it again if it is"),
        (Path("results/a/model.nc").unlink, "model.nc.json too. Run again to make it."),
        (
            Path("results/provenance/a/model.nc.json").unlink,
            "is missing. Delete results/a/model.nc and run again, which makes both.",
        ),
        (written("results/a/log/track.log"), "…). Another run lists it as it lies there."),
        (Path("environment.txt").unlink, "environment.txt: is missing.\n"),
    ],
)
def test_what_is_broken_is_named_with_its_remedy(study, capsys, damage, said):
    damage()
    with pytest.raises(SystemExit):
        main([])
    assert said in capsys.readouterr().out
    assert said.rpartition(": ")[2].strip() in Path("results/audit.md").read_text()


def test_a_study_whose_folder_lies_elsewhere_passes(study, tmp_path_factory):
    elsewhere = tmp_path_factory.mktemp("elsewhere") / "a"
    shutil.move("results/a", elsewhere)
    Path("results/a").symlink_to(elsewhere)
    assert verify(Manifest.read()) == []
    assert found_after_another_run() == {}


def test_a_file_that_the_hash_of_a_folder_does_not_hold_is_named(
    study, monkeypatch, tmp_path_factory
):
    records = Path("results/trials/records")
    with job(monkeypatch, records, sources=[], code=["src/acquire.py"]):
        records.mkdir(parents=True)
        (records / "0.nc").write_text("measured")
    (records / ".snakemake_timestamp").touch()
    assert found_after_another_run() == {}
    elsewhere = tmp_path_factory.mktemp("elsewhere")
    (elsewhere / "9.nc").write_text("planted")
    (records / "more").symlink_to(elsewhere)
    (records / ".0.nc").write_text("planted")
    assert found_after_another_run() == {
        str(records / "more/9.nc"): "was made by no job",
        str(records / ".0.nc"): "was made by no job",
    }


def found_after_another_run():
    collect().write()
    return {finding.path: finding.problem for finding in verify(Manifest.read())}


def test_no_run_makes_a_result_of_what_no_job_made(study):
    Path("results/tables/fake.csv").write_text("a,b\n")
    Path("results/tables/table1.csv").write_text("c,d\n")
    provenance.description_of(Path("results/tables/table1.csv")).unlink()
    assert found_after_another_run() == {
        "results/tables/fake.csv": "was made by no job",
        "results/tables/table1.csv": "was made by no job",
    }


@pytest.mark.parametrize(
    "file",
    ["results/a/log/verdict.json", "results/a/log/lost.log", "results/a/resolve/fit.nc",
     "results/a/benchmark/track.csv", "results/provenance/x.bin", "results/provenance/x.json"],
)  # fmt: skip
def test_no_run_makes_a_log_or_a_description_of_what_is_none(study, file):
    Path(file).parent.mkdir(exist_ok=True)
    if file.endswith("lost.log"):
        Path(file).symlink_to("nowhere")
    else:
        Path(file).write_text("{}")
    assert found_after_another_run() == {file: "was made by no job"}


@pytest.mark.parametrize(
    "file", ["results/b/log/failed.log", "results/a/benchmark/track.tsv", "results/resolve/a/1.nc"]
)
def test_logs_timings_and_what_resolve_makes_are_listed(study, file):
    Path(file).parent.mkdir(parents=True, exist_ok=True)
    Path(file).write_text("kept\n")
    assert found_after_another_run() == {}


def test_no_run_makes_a_result_that_was_deleted_forgotten(study):
    Path("results/tables/table1.csv").unlink()
    [(path, problem)] = found_after_another_run().items()
    assert path == "results/tables/table1.csv"
    assert problem.startswith("is missing")


@pytest.mark.parametrize(
    "damage",
    ["not JSON", "a list", "no job", "a list of files", "no run",
     "no commit", "no processor", "no instructions", "no options"],
)  # fmt: skip
def test_a_description_that_cannot_be_read_is_none(study, damage):
    file = provenance.description_of(Path("results/tables/table1.csv"))
    said = json.loads(file.read_text())
    match damage:
        case "a list":
            said = [said]
        case "no job":
            said["job"] = {}
        case "a list of files":
            said["job"]["code"] = [*said["job"]["code"]]
        case "no run":
            said["run"] = None
        case "no commit" | "no processor" | "no instructions" | "no options":
            del said["run"][damage.removeprefix("no ")]
    file.write_text("{" if damage == "not JSON" else json.dumps(said))
    assert found_after_another_run() == {
        "results/tables/table1.csv": "was made by no job",
        str(file): "was made by no job",
    }


def test_descriptions_that_were_edited_before_another_run_are_named(study):
    file = provenance.description_of(Path("results/tables/table1.csv"))
    overwrite(file, file.read_bytes().replace(b'"settings": {}', b'"settings": {"a": 1}'))
    assert found_after_another_run() == {
        "results/tables/table1.csv": "its description is not what its job kept"
    }


@pytest.mark.parametrize("without", ["repository", "program"])
def test_a_copy_without_its_history_passes_with_a_note(study, monkeypatch, capsys, without):
    if without == "repository":
        shutil.rmtree(".git")
    else:
        monkeypatch.setenv("PATH", "")
    main([])
    note = "no commit was looked up"
    assert note in capsys.readouterr().out
    assert note in Path("results/audit.md").read_text()
    overwrite("src/draw.py", b"edited\n")
    assert first().path == "src/draw.py"


def test_a_copy_inside_another_repository_passes(study, monkeypatch):
    copy = Path("vendored")
    copy.mkdir()
    for path in ("src", "config", "results", "environment.txt"):
        Path(path).rename(copy / path)
    shutil.rmtree(".git")
    subprocess.run(["git", "init", "-q"], check=True)
    monkeypatch.chdir(copy)
    assert verify(Manifest.read()) == []


def test_a_commit_that_a_shallow_clone_lacks_is_named_with_its_remedy(study):
    shutil.rmtree(".git")
    subprocess.run(["git", "init", "-q"], check=True)
    assert first().path == os.environ[provenance.COMMIT]
    assert "git fetch --unshallow" in first().problem


def test_a_commit_that_was_edited_before_another_run_is_named(study):
    file = provenance.description_of(Path("results/tables/table1.csv"))
    commit = os.environ[provenance.COMMIT]
    overwrite(file, file.read_bytes().replace(commit.encode(), b"unknown"))
    assert found_after_another_run() == {
        "results/tables/table1.csv": "its description is not what its job kept"
    }


def test_a_description_from_before_it_had_a_hash_of_its_own_passes(study):
    file = provenance.description_of(Path("results/tables/table1.csv"))
    said = json.loads(file.read_text())
    del said["description"]
    file.write_text(json.dumps(said, indent=1, sort_keys=True) + "\n")
    assert found_after_another_run() == {}


def test_results_that_were_swapped_with_their_descriptions_are_named(study):
    pair = [Path("results/figures/fig3.png"), Path("results/tables/table1.csv")]
    for one, other in (pair, map(provenance.description_of, pair)):
        content = one.read_bytes(), other.read_bytes()
        one.write_bytes(content[1])
        other.write_bytes(content[0])
    problem = "its description is that of a job which makes other results"
    assert found_after_another_run() == {str(path): problem for path in pair}


@pytest.fixture
def record(study, monkeypatch):
    """A record of hardware that a result was made from; its folder can be written to."""
    with archive.unfinished("film", now=datetime(2026, 1, 1, tzinfo=UTC)) as folder:
        (folder / "record.nc").write_text("measured")
        kept = archive.seal(folder, {"excitation": "main"})
    monkeypatch.setitem(
        JOBS, "results/a/taken.nc", ([str(kept / archive.MANIFEST)], ["src/acquire.py"])
    )
    make(monkeypatch, "results/a/taken.nc")
    assert found_after_another_run() == {}
    kept.chmod(0o755)
    for file in kept.iterdir():
        file.chmod(0o644)
    return kept


def test_a_record_of_hardware_that_has_changed_is_named(record):
    (record / "record.nc").write_text("altered")
    [(path, problem)] = found_after_another_run().items()
    assert path == str(record / "record.nc")
    assert "is not what was recorded" in problem
    (record / "record.nc").unlink()
    assert found_after_another_run() == {path: "is missing"}


def test_a_file_that_was_added_to_a_record_of_hardware_is_named(record):
    (record / "more").mkdir()
    for name in ("link.nc", "more/link.nc"):
        (record / name).write_text("planted")
    assert found_after_another_run() == {
        str(record / name): "is no file of the record" for name in ("link.nc", "more/link.nc")
    }


def test_a_changed_setting_in_a_description_is_named(study):
    file = provenance.description_of(Path("results/a/model.nc"))
    overwrite(file, file.read_bytes().replace(b'"settings": {}', b'"settings": {"a": 1}'))
    assert first().path == str(file)


def test_a_manifest_that_a_full_disk_refuses_leaves_the_last_one_alone(study, monkeypatch):
    before = provenance.digest(Path("results/MANIFEST.json"))

    manifest = collect()
    with monkeypatch.context() as disk:
        disk.setattr(Path, "write_text", full)
        with pytest.raises(OSError, match="No space left"):
            manifest.write()
    assert provenance.digest(Path("results/MANIFEST.json")) == before
    assert verify(Manifest.read()) == []
    assert not list(Path("results").rglob("*partial"))


def test_during_a_run_the_manifest_is_waited_for(study, capsys):
    Path("results/MANIFEST.json").unlink()
    lock = Path("build/lock")
    lock.parent.mkdir(exist_ok=True)
    lock.write_text("4711\n")
    with lock.open() as held:
        fcntl.flock(held, fcntl.LOCK_EX)
        with pytest.raises(SystemExit):
            main([])
        said = capsys.readouterr().err
        assert "there is no manifest while process 4711 makes results. Wait until" in said
    with pytest.raises(SystemExit):
        main([])
    assert "there is no manifest. Make it again" in capsys.readouterr().err


def test_an_edited_manifest_is_refused(study, capsys):
    file = Path("results/MANIFEST.json")
    content = json.loads(file.read_text())
    content["products"]["results/a/track.nc"]["sha256"] = 64 * "0"
    file.write_text(json.dumps(content, indent=1, sort_keys=True) + "\n")
    with pytest.raises(SystemExit) as exit_:
        main([])
    assert exit_.value.code == 2
    assert "is not as it was written" in capsys.readouterr().err


def test_a_run_with_nothing_to_make_mends_a_damaged_manifest(study):
    file = Path("results/MANIFEST.json")
    written = file.read_text()
    file.write_text(written[:100])
    main(["--collect"])
    assert file.read_text() == written


def test_a_run_with_nothing_to_make_lists_an_edited_log(study):
    Path("results/a/log/track.log").write_text("edited\n")
    assert first().path == "results/a/log/track.log"
    main(["--collect"])
    assert verify(Manifest.read()) == []


@pytest.fixture
def signers(study):
    """The signature of the manifest, and who may have made it."""
    subprocess.run(["ssh-keygen", "-q", "-t", "ed25519", "-N", "", "-f", "key"], check=True)
    sign = ["ssh-keygen", "-q", "-Y", "sign", "-f", "key", "-n", "dea-study"]
    subprocess.run([*sign, "results/MANIFEST.json"], check=True)
    Path("signers").write_text(f"ada {Path('key.pub').read_text()}")
    return ["--signers", "signers"]


@pytest.mark.skipif(not shutil.which("ssh-keygen"), reason="ssh-keygen is not installed")
def test_a_manifest_written_anew_after_signing_is_named(study, signers, monkeypatch, capsys):
    main(signers)
    capsys.readouterr()
    make(monkeypatch, "results/tables/table1.csv", {"digits": 2})
    collect().write()
    assert verify(Manifest.read()) == []
    with pytest.raises(SystemExit) as exit_:
        main(signers)
    assert exit_.value.code == 1
    assert "MANIFEST.json: is not what ada signed" in capsys.readouterr().out


@pytest.mark.skipif(not shutil.which("ssh-keygen"), reason="ssh-keygen is not installed")
def test_a_signer_whose_name_holds_a_blank_is_known(study, signers, capsys):
    Path("signers").write_text(f'"ada lovelace" {Path("key.pub").read_text()}')
    main(signers)
    assert "are what they were made as" in capsys.readouterr().out


@pytest.mark.skipif(not shutil.which("ssh-keygen"), reason="ssh-keygen is not installed")
def test_the_signature_of_a_stranger_is_refused(study, signers, capsys):
    Path("signers").write_text("")
    with pytest.raises(SystemExit) as exit_:
        main(signers)
    assert exit_.value.code == 2
    assert "nobody in signers made it" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--sample=-1"], "SAMPLE: it is '-1'. Give a whole number of at least 0"),
        (["--sample=abc"], "SAMPLE: it is 'abc'. Give a whole number of at least 0"),
        (["--seed=1.5"], "SEED: it is '1.5'. Give a whole number of at least 0"),
    ],
)
def test_a_wrong_variable_of_make_is_named(study, capsys, options, message):
    with pytest.raises(SystemExit) as exit_:
        main(options)
    assert exit_.value.code == 2
    assert capsys.readouterr().err == f"error: {message}\n"


@pytest.mark.skipif(not shutil.which("ssh-keygen"), reason="ssh-keygen is not installed")
def test_a_missing_file_of_signers_is_named(study, signers, capsys):
    with pytest.raises(SystemExit) as exit_:
        main(["--signers", "absent"])
    assert exit_.value.code == 2
    assert "error: SIGNERS: there is no file 'absent'. Name" in capsys.readouterr().err


def test_a_config_file_that_has_changed_is_named(study):
    Path("config/device.yaml").write_text("other\n")
    assert first() == ("config/device.yaml", "has changed since results were made from it")


def test_a_file_that_a_job_read_beside_its_inputs_is_named(study, monkeypatch):
    Path("helper.py").write_text("RATE = 1.0\n")
    product = Path("results/a/other.nc")
    with job(monkeypatch, product, sources=[], code=["src/select.py"]):
        provenance.note_read([Path("helper.py")])
        product.write_text("made")
    assert found_after_another_run() == {}
    assert resting_on("helper.py", Manifest.read()) == [str(product)]
    Path("helper.py").write_text("RATE = 2.0\n")
    assert found_after_another_run() == {"helper.py": "has changed since results were made from it"}
    Path("helper.py").unlink()
    assert found_after_another_run() == {"helper.py": "is missing"}


def repeat_in_this_process(monkeypatch):
    """Let the audit run jobs again as :func:`make` does."""
    began = Path.cwd()

    def again(command, cwd, **_):
        monkeypatch.chdir(cwd)
        try:
            (product,) = [word for word in command if word in JOBS]
            make(monkeypatch, product)
        except OSError as error:
            return subprocess.CompletedProcess(command, 1, stderr=str(error))
        finally:
            monkeypatch.chdir(began)
        return subprocess.CompletedProcess(command, 0)

    monkeypatch.setattr("dea.audit.recompute.subprocess.run", again)


def found_when_made_again():
    jobs = recompute(collect(), len(JOBS), seed=1)
    return [finding for _, found in jobs for finding in found]


def make_reading(monkeypatch, product, read):
    """Make a product again whose job reads a file beside its inputs."""
    content = Path.write_text

    def reading(*arguments, **options):
        provenance.note_read([Path(read)])
        return content(*arguments, **options)

    with monkeypatch.context() as patched:
        patched.setattr("pathlib.Path.write_text", reading)
        make(monkeypatch, product)


def test_a_job_after_one_that_read_a_file_beside_its_inputs_is_run_again(study, monkeypatch):
    Path("helpers").mkdir()
    Path("helpers/rate.py").write_text("RATE = 1.0\n")
    make_reading(monkeypatch, "results/a/model.nc", "helpers/rate.py")
    for product in ("results/a/track.nc", "results/a/model.fmu", "results/tables/table1.csv"):
        make(monkeypatch, product)
    make(monkeypatch, "results/figures/fig3.png")
    repeat_in_this_process(monkeypatch)
    assert found_when_made_again() == []


def test_a_job_with_a_source_outside_of_the_project_is_run_again(
    study, monkeypatch, tmp_path_factory
):
    outside = tmp_path_factory.mktemp("outside")
    (outside / "mine.csv").write_text("t,y\n")
    source = os.path.relpath(outside / "mine.csv")
    assert source.startswith("..")
    monkeypatch.setitem(JOBS, "results/a/other.nc", ([source], ["src/select.py"]))
    monkeypatch.setitem(JOBS, "results/a/last.nc", (["results/a/other.nc"], ["src/select.py"]))
    for product in ("results/a/other.nc", "results/a/last.nc"):
        make(monkeypatch, product)
    repeat_in_this_process(monkeypatch)
    assert found_when_made_again() == []


def test_a_draw_of_jobs_can_be_repeated(study, monkeypatch, capsys):
    monkeypatch.setattr("dea.audit.recompute._run", lambda *_: None)
    monkeypatch.setattr("dea.audit.recompute._difference", lambda *_: None)
    main(["--sample=3"])
    drawn = capsys.readouterr().out
    (seed,) = re.findall(r"SEED=(\d+)", drawn)
    main(["--sample=3", f"--seed={seed}"])
    assert capsys.readouterr().out == drawn


def test_an_infinity_does_not_hide_other_values_that_differ():
    made = np.array([np.inf, np.nan, 1.0])
    assert _close(made, made.copy())
    assert _close(made, made * (1 + 1e-13))
    assert not _close(made, np.array([np.inf, np.nan, 5.0]))
    assert not _close(made, np.array([-np.inf, np.nan, 1.0]))


def test_products_come_after_those_that_their_jobs_read_beside_their_inputs(study, monkeypatch):
    make_reading(monkeypatch, "results/a/model.fmu", "results/tables/table1.csv")
    order = in_order(collect())
    assert order.index("results/tables/table1.csv") < order.index("results/a/model.fmu")


def test_a_job_that_read_what_was_made_from_its_own_product_is_in_the_order(study, monkeypatch):
    make_reading(monkeypatch, "results/a/record.nc", "results/tables/table1.csv")
    manifest = collect()
    assert sorted(in_order(manifest)) == sorted(JOBS)
    assert set(resting_on("results/a/record.nc", manifest)) == set(JOBS) - {"results/a/record.nc"}
    [code] = set(manifest.jobs[manifest.products["results/a/record.nc"]["job"]]["code"])
    assert set(resting_on(code, manifest)) == set(JOBS)


def test_one_byte_flipped_in_each_file_is_found(study):
    files = [path for path in Path("results").rglob("*") if path.is_file() and path.stat().st_size]
    for file in sorted(files):
        content = file.read_bytes()
        for place in (0, len(content) // 2, len(content) - 1):
            file.write_bytes(content[:place] + bytes([content[place] ^ 1]) + content[place + 1 :])
            try:
                found = [finding.path for finding in verify(Manifest.read())]
            except InputError as error:
                found = [str(error.file)]
            assert found[:1] == [str(file)]
        file.write_bytes(content)
    assert verify(Manifest.read()) == []


@pytest.fixture
def crate(study):
    """Where the crate is written."""
    Path("Snakefile").write_text("rule study:\n")
    return Path("build/crate")


@pytest.mark.parametrize(
    ("file", "problem"),
    [
        ("results/a/model.nc", "is not what was made"),
        ("config/device.yaml", "has changed since results were made from it"),
    ],
)
def test_no_crate_is_written_of_what_differs_from_its_hash(study, crate, file, problem):
    Path(file).write_text("edited\n")
    with pytest.raises(InputError, match=rf"^{file}: {problem}.*`make audit` says what to do$"):
        write(crate, {})
    assert not crate.exists()


def test_no_crate_is_written_without_a_described_result(study, crate):
    Path("results/a/model.nc").unlink()
    with pytest.raises(InputError, match=r"^results/a/model\.nc: is missing"):
        write(crate, {})


def test_a_crate_holds_sources_from_outside_of_the_project(
    study, crate, monkeypatch, tmp_path_factory
):
    outside = tmp_path_factory.mktemp("outside")
    (outside / "one").mkdir()
    absolute = outside / "one/mine.csv"
    relative = os.path.relpath(outside / "mine.csv")
    absolute.write_text("t,u\n")
    Path(relative).write_text("t,y\n")
    monkeypatch.setitem(JOBS, "results/a/other.nc", ([str(absolute), relative], ["src/select.py"]))
    make(monkeypatch, "results/a/other.nc")
    write(crate, {})
    kept = sorted((crate / "external").glob("*/mine.csv"))
    assert {file.read_text() for file in kept} == {"t,u\n", "t,y\n"}
    for file in kept:
        assert provenance.digest(file).startswith(file.parent.name)
    said = (crate / "ro-crate-metadata.json").read_text()
    assert all(str(file.relative_to(crate)) in said for file in kept)


def test_a_link_to_another_input_is_named(study, monkeypatch):
    make(monkeypatch, "results/a/model.nc", {"degree": 2})
    collect().write()
    paths = [finding.path for finding in verify(Manifest.read())]
    assert paths == ["results/a/model.fmu", "results/a/track.nc", "results/tables/table1.csv"]


def test_a_job_refuses_an_input_that_is_not_what_was_made(study, monkeypatch):
    overwrite("results/a/model.nc", b"other")
    with pytest.raises(InputError, match=r"model\.nc: it is not what the job a/model made"):
        make(monkeypatch, "results/a/track.nc")


def test_a_job_refuses_an_input_that_was_made_from_something_else(study, monkeypatch):
    make(monkeypatch, "results/a/record.nc", {"other": 1})
    with pytest.raises(InputError, match=r"model\.nc: it was made from another .*record\.nc"):
        make(monkeypatch, "results/tables/table1.csv")


@pytest.mark.parametrize("missing", ["processor", "instructions"])
def test_an_incomplete_description_is_named_by_the_report(study, missing):
    file = provenance.description_of(Path("results/a/model.nc"))
    said = json.loads(file.read_text())
    del said["run"][missing]
    file.write_text(json.dumps(said))
    with pytest.raises(InputError, match=r"model\.nc: nothing says which job made it"):
        origin(Path("results/a/model.nc"))


@pytest.mark.parametrize("text", ["[]", '{"sha256": "0", "job": []}', '{"sha256": "0", "job": {}}'])
def test_a_job_refuses_an_input_whose_description_is_none(study, monkeypatch, text):
    provenance.description_of(Path("results/a/model.nc")).write_text(text)
    with pytest.raises(InputError, match=r"model\.nc: nothing says which job made it"):
        make(monkeypatch, "results/a/track.nc")


def test_a_job_refuses_an_input_of_which_no_job_is_known(study, monkeypatch):
    provenance.description_of(Path("results/a/model.nc")).unlink()
    with pytest.raises(InputError, match=r"model\.nc: nothing says which job made it"):
        make(monkeypatch, "results/a/track.nc")


def test_products_come_after_what_they_are_made_from(study):
    order = in_order(Manifest.read())
    for product, (sources, _) in JOBS.items():
        for source in sources:
            if source in order:
                assert order.index(source) < order.index(product)


def test_outside_of_the_workflow_nothing_is_kept(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv(provenance.JOB, raising=False)
    with provenance.job(["x"], {}, inputs=[], outputs=[Path("results/a.nc")]):
        assert provenance.current_job() == ""
    assert not Path("results").exists()


def test_a_job_makes_a_folder_anew_that_a_job_of_an_earlier_run_has_made_meanwhile(
    study, monkeypatch
):
    sealed = Path("results/trials/sealed")
    for name in ("orphan", "next"):
        with job(monkeypatch, sealed, sources=[], code=["src/acquire.py"]):
            sealed.mkdir(parents=True)
            (sealed / f"{name}.json").write_text("{}")
    assert [file.name for file in sealed.iterdir()] == ["next.json"]
    assert found_after_another_run() == {}


def test_a_job_whose_run_has_ended_leaves_its_products_to_the_next(study, monkeypatch):
    made = Path("results/a/track.nc").read_bytes()
    ended = subprocess.Popen(["true"])
    ended.wait()
    monkeypatch.setenv(provenance.RUN, str(ended.pid))
    with pytest.raises(InputError, match=r"track\.log: the run that began this job has ended"):
        make(monkeypatch, "results/a/track.nc", {"forgetting": 0.5})
    assert Path("results/a/track.nc").read_bytes() == made
    monkeypatch.setenv(provenance.RUN, str(os.getpid()))
    make(monkeypatch, "results/a/track.nc", {"forgetting": 0.5})
    assert Path("results/a/track.nc").read_bytes() != made
