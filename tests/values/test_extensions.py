"""Bases that others add to: members are known by name as soon as they are there, and nothing is imported by a file."""

import sys

import pytest

from laticauda.robot import Scene
from laticauda.values import codec
from laticauda.values.extensions import Extensible, name_of


class Sound(Extensible, group="sounds"):
    """A group."""


Sound._homes = {"html-parser": "html.parser"}  # as `HOMES` has them


class LoudBang(Sound):
    """A member."""


class _Hidden(Sound):
    """A part of others."""


def test_a_class_is_known_by_its_name_with_hyphens():
    assert name_of(LoudBang) == "loud-bang"
    assert name_of(type("PD", (), {})) == "pd"
    assert name_of(type("X", (), {"called": "own-name"})) == "own-name"
    assert Sound.named("loud-bang") is LoudBang


def test_a_member_is_known_once_it_is_defined_and_only_in_its_group():
    class Other(Extensible, group="others"):
        pass

    class Whisper(Other):
        pass

    assert Other.names() == ("whisper",)
    assert "whisper" not in Sound.names()
    assert "-hidden" not in str(Sound.names())


def test_an_unknown_name_is_refused_with_those_that_there_are():
    with pytest.raises(
        ValueError,
        match=r"`kind` must be one of .*`loud-bang`, got 'loudbang'; did you mean `loud-bang`\?",
    ):
        Sound.named("loudbang")


def test_a_base_with_a_name_is_a_member_and_one_without_is_none():
    class Weather(Extensible, group="weathers"):
        called = "calm"

    class Storm(Weather):
        pass

    assert Weather.names() == ("calm", "storm")
    assert Weather.named("calm") is Weather
    assert "sound" not in Sound.names()
    assert codec.decode(Scene, codec.encode(Scene(level=0.1), Scene)) == Scene(level=0.1)


def test_a_name_never_imports_what_it_says():
    with pytest.raises(ValueError, match="`kind` must be one of"):
        Sound.named("antigravity")
    assert "antigravity" not in sys.modules
