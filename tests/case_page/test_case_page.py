"""The page says what the datasets hold, and holds its pictures."""

import json
import re
from base64 import b64decode
from html.parser import HTMLParser

import numpy as np
import pytest
import xarray as xr

import made_datasets as made
from dea import store
from dea.case_page import Findings, page, summary
from dea.case_page.findings import percentage
from dea.narx import NarxModel, Scaling

PICTURE = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR" + (2000).to_bytes(4) + b" not really"


class Tags(HTMLParser):
    """Fails where a tag is closed that is not open."""

    def __init__(self):
        super().__init__()
        self.open, self.images = [], []

    def handle_starttag(self, tag, attributes):
        if tag == "img":
            self.images.append(dict(attributes))
        elif tag not in ("meta", "br"):
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


def test_scores():
    baselines = ["constant", "linear", "hammerstein", "cubic"]
    return made.checked(
        xr.Dataset(
            {
                "nmse": made.over("part", [0.01]),
                "rmse": made.over("part", [0.05], "mm"),
                "samples": made.over("part", [100]),
                "terms": made.over((), 6),
                "initial_outputs": made.over((), 3),
                "stability": made.over((), "stable"),
                "baseline_nmse": made.over(("part", "baseline"), [[1.0, 0.2, 0.5, np.inf]]),
                "baseline_rmse": made.over(("part", "baseline"), [[0.5, 0.2, 0.3, np.inf]], "mm"),
            },
            coords={
                "part": made.over("part", ["held_out"]),
                "baseline": made.over("baseline", baselines),
            },
        ),
        "test_scores",
    )


test_scores.__test__ = False


@pytest.fixture
def findings(tmp_path):
    record = made.record(1, 60.0).rename(voltage="input", displacement="output")
    return findings_of(tmp_path, record, made.model(1), made.gfrf(1))


def findings_of(tmp_path, record, model, gfrf):
    folder = tmp_path / "mine"
    folder.mkdir()
    record.attrs["source_file"] = "<mine & yours>.csv"
    datasets = {
        "record": record,
        "model": model.assign_attrs(stability="slow"),
        "validation": made.validation(1),
        "gfrf": gfrf.assign_attrs(withheld="one step is not white"),
        "test_scores": test_scores(),
    }
    for name, dataset in datasets.items():
        contract = "imported_record" if name == "record" else name
        store.write(dataset.assign_attrs(contract=contract), folder / f"{name}.nc", title=name)
    skipped = [
        {"name": "end_stop", "place": None, "reason": "no force port"},
        {"name": "dead_zone", "place": "<left>", "reason": "it does not move"},
        {"name": "creep", "place": None, "reason": "no force port"},
    ]
    verdict = {"sentence": "It lacks a `<delay>`.", "not_offered": skipped}
    (folder / "verdict.json").write_text(json.dumps(verdict))
    return Findings("My & mine", store.Sources(sorted(folder.iterdir())))


def test_the_page_is_whole_and_holds_its_pictures(findings):
    text = page(findings, {"fig2": PICTURE, "discrepancy": PICTURE})
    tags = Tags()
    tags.feed(text)
    assert not tags.open
    assert [b64decode(i["src"].partition(",")[2]) for i in tags.images] == [PICTURE] * 2
    assert "&lt;mine &amp; yours&gt;.csv" in text
    assert "It lacks a <code>&lt;delay&gt;</code>." in text
    assert "one step is not white" in text
    assert not re.search(r'(src|href)="(?!data:)', text), "it must stand alone"


def test_effects_that_were_not_tried_are_told_by_their_reasons(findings):
    told = "`end_stop`, `creep` (no force port); `dead_zone` at <left> (it does not move)"
    assert findings.not_offered == f"Not tried: {told}."
    assert "<code>dead_zone</code> at &lt;left&gt;" in page(findings, {})
    assert findings.not_offered in " ".join(summary(findings, "page.html").split())


def test_where_all_was_tried_nothing_is_told(findings):
    findings.__dict__["_verdict"] = {"sentence": "It lacks a lag.", "not_offered": []}
    assert findings.not_offered == ""
    assert "<p></p>" not in page(findings, {})


@pytest.mark.parametrize("withheld", ["", "one step is not white"])
def test_a_caption_tells_of_bands_where_they_are_given(findings, withheld):
    findings.sources.dataset("gfrf").attrs["withheld"] = withheld
    text = page(findings, {"fig3": PICTURE})
    assert ("No bands are given" in text) == bool(withheld)
    assert ("and at three times. Without bands" in text) == bool(withheld)
    assert ("and at three times with 95 % bands.<" in text) == (not withheld)


@pytest.mark.parametrize("withheld", ["", "one step is not white"])
@pytest.mark.parametrize("name", ["fig3", "tracked_parameters"])
def test_a_caption_does_not_take_a_course_without_a_band_for_drift(findings, name, withheld):
    findings.sources.dataset("gfrf").attrs["withheld"] = withheld
    [caption] = re.findall("<figcaption>(.*?)</figcaption>", page(findings, {name: PICTURE}))
    said = "Without bands this does not tell drift from error of estimation." in caption
    assert said == bool(withheld)
    assert "What drifts" not in caption


def test_the_caption_of_the_windows_says_which_parameters_come_from_them(findings):
    [caption] = re.findall("<figcaption>(.*?)</figcaption>", page(findings, {"fig2": PICTURE}))
    assert (
        "parameters of a forecast are estimated before the window, fitted ones from the" in caption
    )
    assert "forecast against measured output (C)" in caption


def test_pictures_are_shown_in_proportion(findings):
    narrow, wide = (PICTURE[:16] + width.to_bytes(4) + PICTURE[20:] for width in (900, 2000))
    shown = re.findall(
        r'<img style="width: (\d+)%"', page(findings, {"fig2": wide, "fig3": narrow})
    )
    assert shown == ["100", "45"]


@pytest.mark.parametrize(
    ("nmse", "text"),
    [(0.2, "80.0 %"), (7.3e-5, "99.993 %"), (1.043, "-4.3 %"), (0.0, "100.0000 %"),
     (1.0003, "0.0 %"), (999.0, "-99800.0 %"), (1e3, "-99900 %"), (3.14159e7, "-3.14e+09 %"),
     (np.inf, "diverged")],
)  # fmt: skip
def test_a_score_says_all_only_where_nothing_is_left(nmse, text):
    assert percentage(nmse) == text


def test_the_scores_of_the_model_come_first_and_divergence_is_said(findings):
    rows = re.findall(r"<tr><td>(.*?)</td><td>(.*?)</td>", page(findings, {}))
    assert rows[0] == ("NARX, 6 terms", "99.0 %")
    assert ("linear model with as many lags", "80.0 %") in rows
    assert ("static cubic of the input", "diverged") in rows


def test_the_summary_ends_with_the_path(findings):
    text = summary(findings, "results/mine/page.html")
    assert text.split()[-1] == "results/mine/page.html"
    assert "It lacks a `<delay>`." in text
    assert "99.0 % explained, rmse 0.0500 mm" in text
    assert re.search(r"^  static cubic of the input +diverged$", text, re.MULTILINE)


def test_several_inputs_are_named_on_the_page_and_in_the_terminal(tmp_path):
    record = made.record(1, 60.0).rename(voltage="input_1", displacement="output")
    record["input_2"] = -record["input_1"]
    for name, label, units in (("input_1", "left", "V"), ("input_2", "<right>", "%")):
        record[name].attrs = {"units": units, "long_name": label}
    terms = {"1": 0.5, "y(t-1)": 0.5, "u1(t-1)u2(t-2)": 0.25}
    model = NarxModel.from_terms(terms, scaling=Scaling((1.0, 2.0), (3.0, 4.0), 5.0, 6.0))
    found = findings_of(tmp_path, record, model.to_dataset(("V", "%"), "mm"), made.gfrf_of_inputs())
    assert "left (V) and <right> (%) drive " in found.record
    text = page(found, {})
    assert "<i>u</i><sub>1</sub> = (left - 1.000 V) / 3.000 V" in text
    assert "<i>u</i><sub>2</sub> = (&lt;right&gt; - 2.000 %) / 4.000 %" in text
    named = "u1 = (left - 1.000 V) / 3.000 V, u2 = (<right> - 2.000 %) / 4.000 %, y = (output"
    assert named in summary(found, "page.html")


def test_the_equation_in_the_terminal_says_what_its_signals_are(findings):
    model = findings.sources.dataset("model")
    said = re.search(r"u = \(input ([-+]) (\S+) V\) / (\S+) V", summary(findings, "page.html"))
    sign, offset, scale = said.groups()
    assert -float(sign + offset) == pytest.approx(float(model["u_offset"]), rel=1e-3)
    assert float(scale) == pytest.approx(float(model["u_scale"]), rel=1e-3)
