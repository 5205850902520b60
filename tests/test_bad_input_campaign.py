"""A slice of campaigns/bad_input.py, and that it attacks whatever is in the package."""

import contextlib
import importlib
import io
import random
import re

import pytest
from campaign_scripts import campaign

import laticauda as lc
from laticauda.cli import app, main, swim
from laticauda.connect import messages, schema
from laticauda.connect.session import Session
from laticauda.values import quantity, value_class

bad_input = campaign("bad_input")
attempt = importlib.import_module("bad_inputs.attempt")
surface = importlib.import_module("bad_inputs.surface")
pantry = importlib.import_module("bad_inputs.pantry")

SLICE = {
    "calls": 12,
    "values": 10,
    "messages": 12,
    "flags": 12,
    "texts": 2,
    "robots": 2,
    "columns": 2,
    "damage": 1,
}
"""Inputs of each kind."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("pantry")
    pantry.fill_pantry(folder)
    return folder


@pytest.mark.parametrize("kind", SLICE)
def test_bad_input_is_refused_by_name_or_comes_to_finite_figures(kind, folder):
    _, faults = bad_input.try_kind(kind, 11, SLICE[kind], folder)
    assert faults == []


# ---- nothing is left out -------------------------------------------------------------------------


@pytest.mark.parametrize("command", sorted(app.COMMANDS))
def test_every_flag_in_the_help_of_a_command_is_attacked(command, folder, monkeypatch):
    monkeypatch.setenv("COLUMNS", "200")
    shown = io.StringIO()
    with contextlib.redirect_stdout(shown):
        assert main([*command.split(), "--help"]) == 0
    in_help = set(re.findall(r"^[│ ]*(--[a-z][a-z0-9-]*)", shown.getvalue(), re.MULTILINE))
    with contextlib.chdir(folder):
        runs = surface.RUNS[command]
        attacked = {
            flag for line in runs for flag in surface.flags_of_run(command, tuple(line.split()))
        }
    assert in_help - attacked - surface.LEFT_OUT_OPTIONS.keys() == set()
    assert len(in_help) > 1


def test_every_field_of_a_request_is_attacked():
    attacked = {(target.request, target.path[0]) for target in surface.find_fields()}
    for request, fields in messages.REQUEST_FIELDS.items():
        for name in (*messages.COMMON_FIELDS, *fields):
            assert (request, name) in attacked


def test_every_public_name_is_attacked_or_left_out_for_a_reason():
    attacked = {id(thing) for thing in surface.public_things().values()}
    for package in surface.public_packages():
        module = importlib.import_module(package)
        for name in surface.public_names(module):
            thing = getattr(module, name)
            is_left_out = f"{package}.{name}" in surface.LEFT_OUT_CALLS
            assert id(thing) in attacked or is_left_out or not surface.is_callable(thing)
    assert {
        f"laticauda.{name}" for name in ("swim", "load_robot")
    } <= surface.public_things().keys()
    assert len(attacked) > 300


def test_reasons_are_given_only_for_what_there_is():
    for name in surface.LEFT_OUT_CALLS:
        package, _, attribute = name.rpartition(".")
        assert hasattr(importlib.import_module(package), attribute)


# ---- something new is attacked -------------------------------------------------------------------


@value_class
class WavingSwim(swim.Swim):
    """A command of which nobody told the campaign that it has an option more, and fails at some of its words."""

    waving_speed: float = quantity("m/s", "Speed of waving", ge=-10.0, default=1.0)

    def run(self):
        if self.waving_speed < 0.0:
            raise AttributeError("no such wave")
        return super().run()


def test_a_new_option_is_attacked_and_its_traceback_is_found(folder, monkeypatch):
    monkeypatch.setattr(swim, "Swim", WavingSwim)
    with contextlib.chdir(folder):
        targets = [one for one in surface.find_options() if one.flag == "--waving-speed"]
    assert len(targets) > 1
    kinds = importlib.import_module("bad_inputs.command_kinds")
    answer = bad_input.attempt(kinds.attack_option(targets[0], ["-1"], folder))
    assert answer.verdict == "fault"
    assert "AttributeError: no such wave" in answer.detail
    answer = bad_input.attempt(kinds.attack_option(targets[0], ["-20"], folder))
    assert answer.verdict == "refused"


def test_a_new_field_of_a_message_is_attacked_and_its_failure_is_found(monkeypatch):
    fields = {**messages.REQUEST_FIELDS, "set": (*messages.REQUEST_FIELDS["set"], "waves")}
    monkeypatch.setattr(messages, "REQUEST_FIELDS", fields)
    undeclared = {**schema.UNDECLARED_FIELDS, "waves": {"type": "integer"}}
    monkeypatch.setattr(schema, "UNDECLARED_FIELDS", undeclared)
    usual = Session._set

    def count_waves(session, message):
        range(message.get("waves", 0))
        return usual(session, message)

    monkeypatch.setattr(Session, "_set", count_waves)
    (target,) = [one for one in surface.find_fields() if one.path == ("waves",)]
    kinds = importlib.import_module("bad_inputs.message_kinds")
    answer = bad_input.attempt(kinds.attack_field(target, "many"))
    assert answer.verdict == "fault"
    assert "'str' object cannot be interpreted as an integer" in answer.detail
    assert bad_input.attempt(kinds.attack_field(target, 3)).verdict == "accepted"


def test_a_new_public_function_is_attacked_and_its_traceback_is_found(monkeypatch):
    def wave(height):
        return height.crest

    monkeypatch.setattr(lc, "__all__", [*lc.__all__, "wave"])
    monkeypatch.setattr(lc, "wave", wave, raising=False)
    (target,) = [one for one in surface.find_calls() if one.name == "laticauda.wave"]
    kinds = importlib.import_module("bad_inputs.call_kinds")
    answer = bad_input.attempt(kinds.attack_call(target, kinds.Arguments(), random.Random(1)))
    assert answer.verdict == "fault"
    assert "has no attribute 'crest'" in answer.detail


# ---- it finds what it looks for ------------------------------------------------------------------


def test_a_message_that_names_nothing_is_found():
    answer = attempt.judge_command("swim", "--duration", "-1", names=("--no-such-name",))
    assert answer.verdict == "fault"
    assert answer.detail.startswith("names nothing: laticauda: --duration must be > 0 s")


def test_a_traceback_under_odd_circumstances_is_found(folder, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    kinds = importlib.import_module("bad_inputs.environment_kinds")
    narrow = kinds.Circumstance(title="COLUMNS=1", variables={"COLUMNS": "1"})
    attack = kinds.UnderCircumstance(circumstance=narrow, command="nonsense", pantry=folder)
    assert attack().verdict == "refused"
    broken = kinds.Circumstance(title="no site", shell=">&2; echo Traceback >&2")
    attack = kinds.UnderCircumstance(circumstance=broken, command="nonsense", pantry=folder)
    assert attack().verdict == "fault"


def test_what_is_read_wrongly_from_a_damaged_file_is_found(folder, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    kinds = importlib.import_module("bad_inputs.damage_kinds")
    text = kinds.Format(name="good.csv", read=lambda path: path.read_bytes(), has_checksums=True)
    attack = kinds.DamagedAt(
        file_format=text,
        folder=folder,
        file=pantry.Path("good.csv"),
        change=kinds.FLIP,
        places=(3,),
        bit=0,
    )
    answer = attack()
    assert (answer.verdict, answer.detail) == (
        "fault",
        "byte 3: other values are read, without a word",
    )


def test_the_stored_answer_has_no_fault():
    rows = bad_input.read_rows()
    assert {row.kind for row in rows} <= set(bad_input.KINDS)
    assert rows
    assert sum(row.faults for row in rows) == 0
