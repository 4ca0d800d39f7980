import json
import os

import pytest

from burstcast_workflow import code_hash
from burstcast_workflow.code_hash import MEMORY, Code, code_of


@pytest.fixture(autouse=True)
def nothing_known(monkeypatch):
    monkeypatch.setattr(code_hash, "_known", {})
    monkeypatch.setattr(code_hash, "_seen", {})


@pytest.fixture
def module(tmp_path):
    path = tmp_path / "module.py"
    path.write_text("from . import other\nimport numpy.linalg\nVALUE = 1\n")
    return path


def as_in_another_process():
    code_hash._known.clear()
    code_hash._seen.clear()


def edited(path, change):
    memory = path.with_name(MEMORY)
    found = json.loads(memory.read_text())
    change(found)
    memory.write_text(json.dumps(found))


def test_what_a_run_kept_is_not_parsed_again(tmp_path, module, monkeypatch):
    found = code_of(module)
    code_hash.keep(str(tmp_path))
    as_in_another_process()
    monkeypatch.setattr(code_hash, "_parsed", None)  # cannot be called
    code_hash.recall(str(tmp_path))
    assert code_of(module) == found
    assert found.imports == [("", 1), ("other", 1), ("numpy.linalg", 0)]


def test_an_edit_is_seen_whatever_was_kept(tmp_path, module):
    found = code_of(module)
    code_hash.keep(str(tmp_path))
    as_in_another_process()
    code_hash.recall(str(tmp_path))
    times = module.stat()
    module.write_text(module.read_text().replace("1\n", "2\n"))
    os.utime(module, ns=(times.st_atime_ns, times.st_mtime_ns))  # same size, same time
    assert code_of(module).digest != found.digest
    # in this process only once it forgets what it has read
    module.write_text("VALUE = 3\n")
    second = code_of(module)
    code_hash.forget_files()
    assert code_of(module) != second


def test_what_other_tools_kept_counts_nothing(tmp_path, module):
    found = code_of(module)
    code_hash.keep(str(tmp_path))

    def other_digests(memory):
        for entry in memory["sources"].values():
            entry[0] = "made up"

    edited(module, other_digests)
    as_in_another_process()
    code_hash.recall(str(tmp_path))
    assert code_of(module) == Code("made up", found.imports)  # it is what is looked into
    edited(module, lambda memory: memory.update(found_out_by="another version"))
    as_in_another_process()
    code_hash.recall(str(tmp_path))
    assert code_of(module) == found


@pytest.mark.parametrize("text", ["", "{", "[]", "{}", '{"found_out_by": 1}', None])
def test_a_memory_of_no_use_is_none(tmp_path, module, text):
    if text is not None:
        (tmp_path / MEMORY).write_text(text)
    code_hash.recall(str(tmp_path))
    assert len(code_of(module).digest) == 12


def test_only_what_was_looked_at_is_kept(tmp_path, module):
    code_of(module)
    code_hash.keep(str(tmp_path))
    as_in_another_process()
    code_hash.recall(str(tmp_path))
    module.write_text("VALUE = 3\n")
    code_of(module)
    code_hash.keep(str(tmp_path))
    assert len(json.loads((tmp_path / MEMORY).read_text())["sources"]) == 1
    assert sorted(os.listdir(tmp_path)) == [MEMORY, "module.py"]


def test_without_room_nothing_is_kept(tmp_path, module, monkeypatch):
    code_of(module)

    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "replace", full)
    code_hash.keep(str(tmp_path))
    assert os.listdir(tmp_path) == ["module.py"]
