from laticauda.tank.protocol import FAULTS, Heartbeat, NodeState


def test_the_motor_is_on_while_a_node_follows_or_holds_references_and_never_else():
    assert [state for state in NodeState if state.is_on] == [NodeState.ACTIVE, NodeState.HOLD]


def test_a_heartbeat_names_the_flags_that_keep_its_node_in_fault_and_no_others():
    beat = Heartbeat(node=1, state=NodeState.FAULT)
    assert beat.faults == ()
    flagged = Heartbeat(
        node=1, state=NodeState.FAULT, stuck=True, leak=True, bus_errors=True, not_calibrated=True
    )
    assert flagged.faults == ("leak", "stuck")
    assert FAULTS == ("leak", "over_temperature", "over_current", "stuck", "emergency_stopped")
