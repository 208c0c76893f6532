"""The suite of primitives that constant closing is measured on."""

import os

import pytest

from maniskill_taskgrasp.assets.objects import library
from maniskill_taskgrasp.assets.objects.folders import HOME_VARIABLE
from maniskill_taskgrasp.errors import InputError
from maniskill_taskgrasp.selection.feasibility import feasible
from maniskill_taskgrasp.train import scripted


def test_suite_is_eight_primitives_in_a_library_that_goes_away(tmp_path, monkeypatch):
    monkeypatch.setenv(HOME_VARIABLE, str(tmp_path))
    with scripted._library_of_primitives():
        models = [library.load(name) for name in library.names("imported")]
    assert os.environ[HOME_VARIABLE] == str(tmp_path)
    assert library.names("imported") == ()
    assert len(models) == 8
    assert {model.friction for model in models} == {1.0}
    assert all(len(model.parts) == 1 and 0.02 < model.mass_kg < 0.26 for model in models)
    for model in models:
        assert all(feasible(name, model.affordance)[0] for name in scripted.TOPOLOGIES)


def test_no_episodes_are_refused_before_anything_is_made():
    with pytest.raises(InputError, match="--episodes must be 1 or more"):
        scripted.run(scripted.ScriptedConfig(episodes=0))
