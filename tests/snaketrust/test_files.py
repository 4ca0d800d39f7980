"""Files that are written whole or not at all."""

from snaketrust.files import PARTIAL_SUFFIX, remove_partial, replaced


def test_what_killed_writers_of_a_file_have_left_behind_is_removed(tmp_path):
    path = tmp_path / "a.json"
    with replaced(path) as partial:
        partial.write_text("whole")
    assert [one.name for one in tmp_path.iterdir()] == ["a.json"]
    left = [tmp_path / f".a.json.{number}{PARTIAL_SUFFIX}" for number in range(2)]
    others = [tmp_path / name for name in (f".b.json.0{PARTIAL_SUFFIX}", ".a.json.txt", "a.txt")]
    for one in [*left, *others]:
        one.write_text("")
    remove_partial(path)
    assert not any(one.exists() for one in left)
    assert all(one.exists() for one in others)
    assert path.read_text() == "whole"
