"""The campaign zoo.py: its stored answer has no dead ends, and its verdicts are those of known models."""

from pathlib import Path

import pytest
from campaign_scripts import campaign

zoo = campaign("zoo")
FREE = '<body name="b"><freejoint/><geom size=".1"/></body>'


def test_no_model_ends_in_a_dead_end_or_a_traceback():
    answers = zoo.stored()
    assert len(answers) > 60
    assert {answer.package for answer in answers} == {"mujoco", "gymnasium", "dm_control"}
    assert [answer for answer in answers if answer.verdict == "wrong"] == []


@pytest.mark.parametrize(
    ("text", "verdict"),
    [
        (f'<compiler inertiafromgeom="true"/><worldbody>{FREE}</worldbody>', "runs"),
        (f'<option density="1000"/><worldbody>{FREE}</worldbody>', "warned"),
        (f'<option solver="PGS"/><worldbody>{FREE}</worldbody>', "cured"),
        ('<worldbody><geom size="1"/></worldbody>', "nothing to wet"),
        ("<worldbody><bdy/></worldbody>", "not loaded"),
    ],
)
def test_a_model_gets_the_verdict_that_it_deserves(tmp_path: Path, text, verdict):
    file = tmp_path / "model.xml"
    file.write_text(f"<mujoco>{text}</mujoco>")
    assert zoo.judge(file)[0] == verdict
