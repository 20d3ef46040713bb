"""Files are written whole or not at all."""

import errno
import os

import pytest

from drakearm.errors import StorageError
from drakearm.files import replacement
from tests.full_disk import full_disk


def write_text(file, text):
    with replacement(file) as partial:
        partial.write_text(text)


def test_a_file_is_replaced_and_its_folder_is_made(tmp_path):
    file = tmp_path / "new" / "file.txt"
    write_text(file, "first")
    write_text(file, "second")
    assert file.read_text() == "second"
    assert list(file.parent.iterdir()) == [file]


def test_an_error_leaves_the_earlier_file(tmp_path):
    file = tmp_path / "file.txt"
    write_text(file, "first")
    with pytest.raises(ZeroDivisionError), replacement(file) as partial:
        partial.write_text("sec")
        raise ZeroDivisionError
    assert file.read_text() == "first" and list(tmp_path.iterdir()) == [file]


def test_what_does_not_fit_leaves_the_earlier_file(tmp_path):
    file = tmp_path / "file.txt"
    write_text(file, "first")
    with full_disk(), pytest.raises(StorageError, match=os.strerror(errno.EFBIG)):
        write_text(file, "x" * 2000)
    assert file.read_text() == "first" and list(tmp_path.iterdir()) == [file]


@pytest.mark.parametrize("name", ["file.txt/below", "x" * 300, "a\0b"])
def test_an_impossible_place_is_a_sentence(tmp_path, name):
    write_text(tmp_path / "file.txt", "first")
    with pytest.raises(StorageError, match="cannot be written: "):
        write_text(tmp_path / name, "text")
    assert [file.name for file in tmp_path.iterdir()] == ["file.txt"]
