import hashlib
from http.server import BaseHTTPRequestHandler, HTTPServer
from threading import Thread

import pytest
import yaml

from dea.errors import InputError
from dea.public_records import fetch

CONTENT = b"u,y\n1,2\n"


@pytest.fixture
def place(tmp_path):
    (tmp_path / "source" / "tanks").mkdir(parents=True)
    (tmp_path / "source" / "tanks" / "data.csv").write_bytes(CONTENT)
    entry = {
        "url": (tmp_path / "source/tanks/data.csv").as_uri(),
        "sha256": hashlib.sha256(CONTENT).hexdigest(),
    }
    (tmp_path / "catalogue.yaml").write_text(yaml.safe_dump({"tanks/data.csv": entry}))
    return tmp_path


def bring(place, *names, **options):
    return fetch(names, catalogue=place / "catalogue.yaml", destination=place / "data", **options)


@pytest.mark.parametrize("from_folder", [False, True])
def test_a_record_comes_from_its_address_or_from_a_folder(place, from_folder):
    folder = {"folder": place / "source"} if from_folder else {}
    (path,) = bring(place, **folder)
    assert path.read_bytes() == CONTENT


def test_other_content_is_refused_and_nothing_is_left(place):
    (place / "source/tanks/data.csv").write_bytes(b"something else")
    with pytest.raises(InputError, match="holds something else"):
        bring(place)
    assert not list((place / "data").rglob("*"))


def test_an_address_that_does_not_answer_is_named_with_the_remedy(place):
    (place / "source/tanks/data.csv").unlink()
    with pytest.raises(InputError, match=r"does not answer.*--from"):
        bring(place)


def test_an_unknown_name_lists_the_known(place):
    with pytest.raises(InputError, match=r"no public record 'drives'.*tanks/data\.csv"):
        bring(place, "drives")


def test_a_record_already_there_is_not_fetched_again(place):
    bring(place)
    (place / "source/tanks/data.csv").unlink()
    assert bring(place)[0].read_bytes() == CONTENT


@pytest.fixture
def sampled(place):
    (place / "source/tanks/data.csv").write_bytes(b"1.5 7 -2\n\n2.5 7 -3\n")
    record = b"time,u,y\n0.000,1.500000,-2.000000\n0.250,2.500000,-3.000000\n"

    def write(**changed):
        entry = {
            "url": (place / "source/tanks/data.csv").as_uri(),
            "sha256": hashlib.sha256(record).hexdigest(),
            "sampled": {"interval": 0.25, "columns": {"u": 1, "y": 3}} | changed,
        }
        (place / "catalogue.yaml").write_text(yaml.safe_dump({"tanks/data.csv": entry}))
        return record

    return write


def test_a_table_without_times_becomes_a_record_with_them(place, sampled):
    record = sampled()
    assert bring(place)[0].read_bytes() == record


def test_a_download_that_breaks_off_is_told_and_leaves_nothing(place, sampled):
    sampled()

    class Short(BaseHTTPRequestHandler):
        def do_GET(self):
            self.send_response(200)
            self.send_header("Content-Length", "1000")
            self.end_headers()
            self.wfile.write(b"0.1 0.2")

        def log_message(self, *_):
            pass

    with HTTPServer(("127.0.0.1", 0), Short) as server:
        Thread(target=server.handle_request).start()
        catalogue = place / "catalogue.yaml"
        entries = yaml.safe_load(catalogue.read_text())
        entries["tanks/data.csv"]["url"] = f"http://127.0.0.1:{server.server_port}/data.csv"
        catalogue.write_text(yaml.safe_dump(entries))
        with pytest.raises(InputError, match=r"not to the end.*993 more expected"):
            bring(place)
    assert not list((place / "data").rglob("*.csv"))


def test_a_record_that_a_folder_holds_is_copied_as_it_is(place, sampled):
    record = sampled()
    (place / "source/tanks/data.csv").write_bytes(record)
    assert bring(place, folder=place / "source")[0].read_bytes() == record


@pytest.mark.parametrize("changed", [{"interval": 0.5}, {"columns": {"u": 1, "y": 2}}])
def test_a_table_read_otherwise_is_refused(place, sampled, changed):
    sampled(**changed)
    with pytest.raises(InputError, match="holds something else"):
        bring(place)


def test_a_column_that_is_not_there_is_named_with_the_remedy(place, sampled):
    sampled(columns={"u": 1, "y": 4})
    with pytest.raises(InputError, match=r"no table of numbers.*sampled\.columns"):
        bring(place)
