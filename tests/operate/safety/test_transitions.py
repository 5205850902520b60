"""The table of phases and supervisor states; that operations keep to it, the rig asserts at every tick."""

from pathlib import Path

from laticauda.operate.safety.transitions import (
    BY_EVENT,
    PHASES,
    REQUESTS,
    STATES,
    TRANSITIONS,
    phase_with,
)


def test_the_rows_name_phases_and_states_and_no_two_contradict_each_other():
    for row in TRANSITIONS:
        assert {row.phase, row.next_phase} <= set(PHASES) and {row.state, row.next_state} <= set(STATES)
        assert row.event not in BY_EVENT
    assert len({row[:3] for row in TRANSITIONS}) == len(TRANSITIONS)
    assert {row.event for row in TRANSITIONS} > set(REQUESTS)


def test_from_everywhere_the_robot_comes_to_rest_and_every_phase_is_reached():
    rows = [row for row in TRANSITIONS if row.event != "acknowledged"]
    reached = {("connecting", "idle")}
    for _ in rows:
        reached |= {row[3:] for row in rows if row[:2] in reached}
    assert {phase for phase, _ in reached} == set(PHASES)
    ends = {("done", "idle"), ("done", "fault")}
    for _ in rows:
        ends |= {row[:2] for row in rows if row[3:] in ends}
    assert ends == reached


def test_a_stop_of_the_supervisor_stops_the_operation_in_every_phase():
    for phase in PHASES[:-1]:
        for state in STATES:
            for stop in {"stopping", "fault"} - {state}:
                assert phase_with(phase, state, stop) == "stopping"


def state_diagram():
    """The table in the language of mermaid."""
    lines = ["stateDiagram-v2", "    [*] --> connecting_idle"]
    for phase, state in dict.fromkeys((row.phase, row.state) for row in TRANSITIONS):
        lines.append(f"    {phase}_{state} : {phase.replace('_', ' ')} / {state}")
    for row in TRANSITIONS:
        source, target = f"{row.phase}_{row.state}", f"{row.next_phase}_{row.next_state}"
        lines.append(f"    {source} --> {target} : {row.event.replace('_', ' ')}")
    return "\n".join([*lines, "    done_idle --> [*]", ""])


def test_the_diagram_of_the_docs_is_that_of_the_table():
    page = (Path(__file__).parents[3] / "docs" / "how-to" / "operate.md").read_text(encoding="utf-8")
    assert f"```mermaid\n{state_diagram()}```" in page
