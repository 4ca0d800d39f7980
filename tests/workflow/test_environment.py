"""What numbers depend on beside settings, code and inputs."""

from burstcast_workflow.harness import environment


def test_the_home_of_nobody_is_no_cache(monkeypatch, caplog):
    monkeypatch.setenv(environment.CACHE, "~nosuchuser/cache")
    assert environment.shared_results() is None
    assert "the cache ~nosuchuser/cache is not used: " in caplog.text


def test_a_cache_is_where_the_variable_says(monkeypatch, tmp_path):
    monkeypatch.delenv(environment.CACHE, raising=False)
    assert environment.shared_results() is None
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setenv(environment.CACHE, "~/cache")
    assert environment.shared_results().directory == tmp_path / "cache"
