"""The report of a small study, as a browser shows it."""

import json
import re
import shutil
import subprocess
from functools import reduce
from html import unescape
from operator import getitem
from pathlib import Path

import pytest
import yaml
from copied_project import ROOT
from markdown_it import MarkdownIt

from dea.errors import InputError
from dea.report import page, write
from dea.report.origin import origin, verdict

BROWSER = shutil.which("chromium") or shutil.which("google-chrome")
# Says in the title what the browser made of the page.
PROBE = """<script>addEventListener("load", () => { document.title = JSON.stringify({
    pictures: document.images.length,
    drawn: [...document.images].filter(image => image.naturalWidth > 300).length,
    wide: document.documentElement.scrollWidth > innerWidth,
    origins: document.querySelectorAll("figure details").length,
}) })</script>"""


@pytest.fixture
def study(finished, tmp_path, monkeypatch):
    shutil.copytree(finished.folder / "results", tmp_path / "results")
    for folder in ("config", "build"):
        (tmp_path / folder).symlink_to(finished.folder / folder)
    for folder in ("src", "workflow"):
        (tmp_path / folder).symlink_to(ROOT / folder)
    monkeypatch.chdir(tmp_path)
    return Path("results/report.html")


def test_the_report_opens_with_the_findings_and_says_how_each_result_was_made(study):
    write(study)
    text = study.read_text()
    assert study.stat().st_size < 10e6
    headings = re.findall(r"<h2[^>]*>([^<]+)", text)
    assert headings == [
        "Findings", "Method", "Quality of the data", "Each actuator", "Cases and trials", "Limits",
    ]  # fmt: skip
    opening = "First-order frequency response", "Root mean square error of forecasts", 'id="method"'
    assert sorted(opening, key=text.index) == list(opening)
    for link in re.findall(r'href="([^"#]+)"', text):
        assert (study.parent / link).exists(), link
    figures = text.count("<figcaption>")
    assert figures == text.count("how it was made</summary>")
    assert text.count("rule figures_actuator") == 10  # five for each actuator
    assert not re.search(r"{{|{%|\*\*|\|---", text)


@pytest.mark.parametrize(
    ("name", "system", "alt"),
    [
        ("actuators/fig1_dea1", "dea1", "The bench and the record of dea1"),
        ("fig3_page2", "", "First-order frequency response over the record"),
    ],
)
def test_a_picture_is_described_by_the_first_sentence_of_its_caption(
    monkeypatch, name, system, alt
):
    monkeypatch.chdir(ROOT)
    for part in ("_result", "_small", "origin"):
        monkeypatch.setattr(f"dea.report.page.{part}", lambda _: "")
    assert f'<img alt="{alt}" ' in page.figure(name, system)


@pytest.mark.parametrize("name", ["front_page", "mine_page2", "a_page_b"])
def test_the_diagnosis_of_a_case_has_its_caption_whatever_its_name(name, monkeypatch):
    monkeypatch.chdir(ROOT)
    for part in ("_result", "_small", "origin"):
        monkeypatch.setattr(f"dea.report.page.{part}", lambda _: "")
    asked = []
    monkeypatch.setattr("dea.report.page._caption", lambda *of: asked.append(of) or "")
    page.figure(f"discrepancy/{name}", name)
    page.figure(f"cases/fig1_{name}", name)
    assert asked == [("figures", "discrepancy", name), ("figures", "fig1", name)]


HOSTILE = "0.1 N*m where u_1 is 2 N*m, <img src=x onerror=f()> &amp; `a` [b](c) | #\n\nd \\"


def test_text_of_a_user_is_text_in_the_report(tmp_path, monkeypatch):
    (tmp_path / "workflow").symlink_to(ROOT / "workflow")
    monkeypatch.chdir(tmp_path)
    folder = Path("results/discrepancy/mine")
    folder.mkdir(parents=True)
    (folder / "verdict.json").write_text(json.dumps({"sentence": HOSTILE}))
    Path("results/tables").mkdir()
    Path("results/tables/cases.md").write_text(f"| units |\n|---|\n| {HOSTILE[:52]} |\n")
    for part in ("provenance.check", "provenance.digest"):
        monkeypatch.setattr(f"dea.{part}", lambda *_: "")
    monkeypatch.setattr("dea.report.page.origin", lambda _: "")
    reader = MarkdownIt("commonmark", {"html": True}).enable("table")
    shown = reader.render(f"| a | b |\n|---|---|\n| c | {verdict('mine')} |\n")
    plain = unescape(re.sub("<[^>]+>", "", shown[shown.index("<td>c") :])).split()
    assert plain == ["c", *HOSTILE.split()]
    assert set(re.findall("<(\\w+)", shown)) == {"table", "thead", "tbody", "tr", "th", "td"}
    assert "<img" not in page.table("cases")


def test_a_link_reaches_a_file_whatever_is_in_its_name(monkeypatch):
    run = {"processor": "one", "instructions": {}, "commit": "0"}
    job = {
        "inputs": {"data/Lauf #2 100%?<\">.csv": "0"}, "name": "one", "rule": "one", "command": [],
        "settings": {}, "code": {},
    }  # fmt: skip
    said = {"job": job, "run": run, "identity": "0"}
    monkeypatch.setattr("dea.report.origin._said", lambda product: said)
    text = origin(Path("results/mine/model.nc"))
    assert (
        '<a href="../data/Lauf%20%232%20100%25%3F%3C%22%3E.csv">'
        "data/Lauf #2 100%?&lt;&quot;&gt;.csv</a>"
    ) in text


@pytest.fixture
def results(tmp_path, monkeypatch):
    """Return a function that makes a report of results by name, without their content.

    Pictures are their names in brackets; it takes the data that figures and tables are made from.
    """
    (tmp_path / "workflow").symlink_to(ROOT / "workflow")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("dea.report.page.figure", lambda name, system="": f"[{name}]")
    monkeypatch.setattr("dea.report.page.table", lambda name: "")
    monkeypatch.setattr("dea.report.page.verdict", lambda name: f"{name} lacks a dead zone.")

    def report(files, cases, made_of):
        monkeypatch.setattr(
            "dea.report.page.systems",
            lambda product: made_of[str(product.relative_to("results").with_suffix(""))],
        )
        for file in [*(f"results/{name}" for name in files),
                     *(f"config/cases/{name}.yaml" for name in cases)]:  # fmt: skip
            Path(file).parent.mkdir(parents=True, exist_ok=True)
            Path(file).touch()
        write(tmp_path / "report.html")
        return (tmp_path / "report.html").read_text()

    return report


OF_ONE = {
    f"figures/{name}": {"dea1"} for name in ("fig3", "fig3_phase", "fig4_h2", "fig4_h2_phase",
                                             "fig4_h3")
} | {"tables/forecast": {"dea1"}}  # fmt: skip


def files_of(made_of):
    return [f"{name}.{'md' if 'tables' in name else 'png'}" for name in made_of]


def test_the_report_shows_the_diagnosis_of_a_case(results):
    shown = ["actuators/fig1_dea1", "discrepancy/dea1", "discrepancy/mine", "discrepancy/yours",
             "cases/fig2_yours"]  # fmt: skip
    files = [*files_of(OF_ONE), *(f"figures/{name}.png" for name in shown)]
    text = results(files, ["mine", "yours", "unmade"], OF_ONE)
    later = text[text.index('id="cases-and-trials"') :]
    assert re.findall(r"\[(\w+/\w+)\]", later) == [
        "discrepancy/mine", "cases/fig2_yours", "cases/fig3_yours", "discrepancy/yours",
    ]  # fmt: skip
    assert "mine lacks a dead zone." in later
    assert "dea1" not in later


def test_the_report_leaves_out_what_is_no_longer_studied(results):
    left = ["actuators/fig1_gone", "discrepancy/gone", "discrepancy/deleted", "cases/fig2_deleted",
            "fig3_page2"]  # fmt: skip
    files = [*files_of(OF_ONE), *(f"figures/{name}.png" for name in left)]
    text = results(files, [], OF_ONE)
    assert "1 actuators were driven" in text
    assert "dea1 lacks a dead zone." in text
    assert not re.search("gone|deleted|page2", text)


def test_the_report_shows_every_page_of_the_responses(results):
    pages = {f"{name}_page2": {"dea2"} for name in OF_ONE if "figures" in name}
    both = OF_ONE | pages | {"tables/forecast": {"dea1", "dea2"}}
    text = results(files_of(both), [], both)
    for name in pages:
        name = name.removeprefix("figures/")
        assert f"[{name.removesuffix('_page2')}]</p>\n<p>[{name}]" in text


@pytest.mark.parametrize("room", ["figures", "tables"])
def test_every_caption_is_filled_in(room, monkeypatch):
    monkeypatch.chdir(ROOT)
    captions = sorted(Path("workflow/report", room).glob("*.rst"))
    assert captions
    for file in captions:
        filled = page._caption(room, file.stem, "dea3")
        assert filled.startswith("<p>"), file
        assert "{" not in filled, file


@pytest.mark.parametrize(
    ("caption", "keys"),
    [
        ("figures/confirmation", ["excitation.probing.times"]),
        ("figures/trials_gap", ["discrepancy.rules.clean"]),
        ("tables/confirmation", ["excitation.probing.times"]),
        ("tables/forecast", ["forecast.every", "forecast.window"]),
        ("tables/recovery", ["recovery.noise"]),
        ("tables/tracking", ["tracking.frozen_window"]),
    ],
)
def test_a_caption_names_the_keys_whose_values_may_be_others(caption, keys):
    text = (ROOT / f"workflow/report/{caption}.rst").read_text()
    assert re.findall(r"``([a-z_]+(?:\.[a-z_]+)+)``", text) == keys
    config = yaml.safe_load((ROOT / "config/config.yaml").read_text())
    for key in keys:
        assert reduce(getitem, key.split("."), config)


@pytest.mark.parametrize("room", ["figures", "tables"])
def test_every_figure_and_table_has_a_place_in_the_report(room):
    text = (ROOT / "workflow/report/report.md").read_text()
    for name in yaml.safe_load((ROOT / f"workflow/{room}.yaml").read_text()):
        assert re.search(rf'{room[:-1]}\("[^)]*{name}', text), name


def test_the_report_refuses_a_figure_that_is_not_what_its_job_made(study):
    figure = Path("results/figures/fig3.png")
    figure.write_bytes(figure.read_bytes() + b"x")
    with pytest.raises(InputError, match="it is not what the job"):
        write(study)
    assert not study.exists()


@pytest.mark.skipif(BROWSER is None, reason="no Chromium is installed")
def test_a_browser_draws_every_picture_within_its_window(study, tmp_path):
    write(study)
    probed = study.with_name("probed.html")
    probed.write_text(study.read_text().replace("</body>", f"{PROBE}</body>"))
    shown = subprocess.run(
        [BROWSER, "--headless", "--no-sandbox", "--disable-gpu", "--window-size=1200,900",
         f"--user-data-dir={tmp_path}/browser", "--virtual-time-budget=10000", "--dump-dom",
         probed.resolve().as_uri()],
        capture_output=True, text=True, check=True, timeout=120,
    ).stdout  # fmt: skip
    pictures = study.read_text().count("<img ")
    found = re.search(r"<title>({.*?})</title>", shown)
    assert found, shown[:300]
    assert f'"pictures":{pictures},"drawn":{pictures},"wide":false' in found[1]
    assert f'"origins":{study.read_text().count("<figcaption>")}' in found[1]
