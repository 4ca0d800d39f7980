import pytest

from burstcast_workflow.harness.settings import Settings, UndeclaredSettingError

DECLARED = {
    "case.training": {"series": 10, "noise": {"level": 0.01, "kind": "white"}},
    "search.grid": 4,
    "case.actuation.parameters": {},
    "search.tikhonov": [1e-6, 1e-9],
}
IDENTITY = {"rule": "train", "case": "Re400", "forecaster": "esn-N30-RV-seed0"}


@pytest.fixture
def settings():
    return Settings(DECLARED, IDENTITY)


def test_settings_are_read_by_their_path(settings):
    assert settings["search.grid"] == 4
    assert settings["case.training"] == DECLARED["case.training"]
    assert settings["case.training.series"] == 10
    assert settings["case.training.noise.kind"] == "white"


def test_wildcards_are_there_by_their_names(settings):
    assert (settings["case"], settings["rule"]) == ("Re400", "train")
    assert settings["forecaster"] == "esn-N30-RV-seed0"


@pytest.mark.parametrize("path", ["search", "search.gri", "search.tikhonov_", "seed", "training"])
def test_what_is_not_declared_is_an_error_that_names_rule_path_and_what_is(settings, path):
    with pytest.raises(UndeclaredSettingError) as error:
        settings[path]
    assert str(error.value) == (
        f"train reads the setting {path}, which its rule does not declare; it declares: "
        "case.actuation.parameters, case.training, search.grid, search.tikhonov"
    )


def test_a_rule_that_declares_nothing():
    with pytest.raises(UndeclaredSettingError, match="it declares: none"):
        Settings({}, IDENTITY)["search.grid"]


@pytest.mark.parametrize("path", ["case.training.sereis", "case.training.noise.sigma"])
def test_what_a_declared_section_does_not_have_is_an_error(settings, path):
    with pytest.raises(KeyError):
        settings[path]


def test_what_nobody_has_read(settings):
    leaves = [
        "case.training.series",
        "case.training.noise.level",
        "case.training.noise.kind",
        "search.grid",
        "case.actuation.parameters",
        "search.tikhonov",
    ]
    assert settings.unread() == leaves
    settings["case.training.noise"]
    settings["case"]
    assert settings.unread() == [leaves[0], *leaves[3:]]
    settings["case.training.series"]
    settings["search.grid"]
    settings["case.actuation.parameters"]
    assert settings.unread() == ["search.tikhonov"]
    settings["search.tikhonov"]
    assert settings.unread() == []


def test_a_path_is_not_read_with_one_that_begins_alike():
    settings = Settings({"a.b": 1, "a.bc": 2}, IDENTITY)
    settings["a.b"]
    assert settings.unread() == ["a.bc"]


def test_what_could_not_be_read_counts_as_unread(settings):
    with pytest.raises(UndeclaredSettingError):
        settings["search"]
    assert "search.grid" in settings.unread()


def test_they_are_a_mapping_of_what_is_declared(settings):
    assert list(settings) == list(DECLARED)
    assert len(settings) == 4
    assert dict(settings) == DECLARED
    assert settings.unread() == []
