import hashlib

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
