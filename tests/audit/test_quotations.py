"""Numbers that documents quote from results and from campaigns."""

import json
import subprocess
from pathlib import Path

import pytest

from dea import provenance
from dea.audit.numbers import KEPT, differences, main
from dea.audit.quotations import printed, quotations, resting, value
from dea.errors import InputError

SCORES = "results/tables/scores.csv"
WORST = f"{SCORES}; rmse (mm); parameters=fixed; max x1000 .0f"
DOCUMENT = f"""# Title

Without tracking the worst of <!--= {SCORES}; rmse (mm); parameters=fixed; count -->0<!--/--> runs
is <!--= {WORST} -->99<!--/--> µm off; a campaign took <!--= speed; study.minutes; .1f -->9<!--/-->
minutes:

<!--= speed; rows; -->
<!--/-->
"""


@pytest.fixture
def project(tmp_path, monkeypatch):
    """A document, a table that a job of the commit made, and a stored campaign."""
    monkeypatch.chdir(tmp_path)
    for folder in ("docs/measured", "results/tables", "results/provenance/tables"):
        Path(folder).mkdir(parents=True)
    Path("docs/page.md").write_text(DOCUMENT)
    Path("docs/measured/speed.json").write_text(
        json.dumps({"values": {"study": {"minutes": 2.25}, "rows": ["| a |", "|---|"]}})
    )
    git = ["git", "-c", "user.name=a", "-c", "user.email=a@b"]
    for command in (["init", "-q"], ["add", "docs"], ["commit", "-q", "-m", "text"]):
        subprocess.run([*git, *command], check=True)
    scores("0.0391", "0.0688", "inf")
    return tmp_path


def scores(*rmse):
    lines = [f"dea{place},fixed,{number}" for place, number in enumerate(rmse, start=1)]
    Path(SCORES).write_text("\n".join(["actuator,parameters,rmse (mm)", *lines, "dea1,rls,0.002"]))
    head = subprocess.run(["git", "rev-parse", "HEAD"], capture_output=True, text=True).stdout
    provenance.description_of(Path(SCORES)).write_text(
        json.dumps({
            "job": {"name": "tables/all"}, "identity": "f00", "sha256": "ba4",
            "run": {"commit": head.strip()},
        })
    )  # fmt: skip


@pytest.mark.parametrize(
    ("address", "expected"),
    [
        (WORST, "69"),
        (f"{SCORES}; rmse (mm); parameters=fixed; min x1000 .1f", "39.1"),
        (f"{SCORES}; rmse (mm); actuator=dea1 & parameters=rls; .4f", "0.0020"),
        (f"{SCORES}; parameters; actuator=dea2;", "fixed"),
        (f"{SCORES}; actuator; ; count", "4"),
        ("speed; study.minutes; .0f", "2"),
        ("speed; study.minutes; x60 .0f", "135"),
    ],
)
def test_an_address_names_one_number(project, address, expected):
    assert printed(address, value(address)) == expected


@pytest.mark.parametrize(
    "address",
    [
        f"{SCORES}; rmse (mm); parameters=fixed; .0f",
        f"{SCORES}; no such; actuator=dea2; .0f",
        f"{SCORES}; rmse (mm); actuator=dea9; max",
        "speed; study.hours; .0f",
        "no_such; study; .0f",
    ],
)
def test_an_address_of_nothing_or_of_several_is_refused(project, address):
    with pytest.raises(InputError, match="nothing to quote"):
        value(address)


def test_refreshed_documents_say_what_the_files_say(project):
    main([])
    text = Path("docs/page.md").read_text()
    assert "the worst of <!--= " in text
    assert "count -->3<!--/--> runs" in text
    assert "-->69<!--/--> µm off" in text
    assert "-->2.2<!--/-->" in text
    assert "\n| a |\n|---|\n" in text
    assert list(differences()) == []
    assert json.loads(KEPT.read_text())[WORST]["job"] == "tables/all f00"
    main(["--check"])


def test_a_number_that_is_edited_in_the_text_is_named(project, capsys):
    main([])
    file = Path("docs/page.md")
    file.write_text(file.read_text().replace("-->69<", "-->68<"))
    with pytest.raises(SystemExit) as exit_:
        main(["--check"])
    assert exit_.value.code == 1
    said = capsys.readouterr().err
    assert f"docs/page.md:4: says '68', and {SCORES} '69'; run make numbers" in said


def test_a_result_of_this_commit_that_says_something_else_is_named(project):
    main([])
    scores("0.0391", "0.0711", "inf")
    assert [line for line in differences() if "'69', and" in line and "'71'" in line]


def test_a_result_of_another_commit_is_not_compared(project):
    main([])
    subprocess.run(
        ["git", "-c", "user.name=a", "-c", "user.email=a@b", "commit", "-q", "--allow-empty",
         "-m", "later"], check=True,
    )  # fmt: skip
    description = provenance.description_of(Path(SCORES)).read_text()
    scores("0.0391", "0.0711", "inf")
    provenance.description_of(Path(SCORES)).write_text(description)
    assert list(differences()) == []


def test_without_results_the_kept_value_stays(project, capsys):
    main([])
    text = Path("docs/page.md").read_text()
    Path(SCORES).unlink()
    with pytest.raises(SystemExit):
        main([])
    assert f"{SCORES} is not there; numbers kept from it: " in capsys.readouterr().err
    assert Path("docs/page.md").read_text() == text
    main(["--check"])


def test_a_number_that_was_never_read_is_named(project):
    assert any("has no" in line for line in differences())


def test_the_lines_that_rest_on_a_file_are_named(project):
    main([])
    assert resting([SCORES]) == [
        "docs/page.md:3: Without tracking the worst of 3 runs",
        "docs/page.md:4: is 69 µm off; a campaign took 2.2",
    ]
    assert [one.text for one in quotations()][:2] == ["3", "69"]
