import re
from dataclasses import replace
from typing import get_args
from unittest.mock import Mock

import numpy as np
import pytest
from campaign_scripts import campaign

from laticauda.paper import Claim, find_fin_gains, read_path_following_trials, run_side_trials
from laticauda.paper.claims import Verdict, find_misprints, load_claims
from laticauda.paper.claims.efficiency_numbers import collect_efficiency_numbers
from laticauda.paper.claims.following_numbers import collect_following_numbers
from laticauda.paper.claims.judge import judge_parts
from laticauda.paper.claims.printed_numbers import MODELS, collect_table_numbers, energy_change
from laticauda.paper.claims.rules import check_part
from laticauda.paper.claims.sentences import format_percent, format_spread
from laticauda.paper.measured import find_printed_changes
from laticauda.trials import Trial

CURVES = ("forward_velocity", "steady_velocity", "mechanical_power")


@pytest.fixture(scope="module")
def side():
    return run_side_trials()


@pytest.fixture(scope="module")
def found(study, following, side) -> dict[str, Claim]:
    return by_key(load_claims(study, following, side))


def by_key(judged) -> dict[str, Claim]:
    return {claim.key: claim for claim in judged}


def doubled_first(curves: np.ndarray) -> np.ndarray:
    """Curves of one more model, the same as the first."""
    return np.concatenate([curves[:1], curves])


def with_speeds(study, speed):
    """The study as if the robot had swum at the speeds that `speed` gives for every case."""
    rows = [(case, replace(case.measured, forward_velocity=speed(case))) for case in study.cases]
    return replace(study, cases=tuple(replace(case, measured=row) for case, row in rows))


# ---- laws ----------------------------------------------------------------------------------------


def test_all_parts_must_be_met():
    assert judge_parts(True, True) == "holds"
    assert judge_parts(True, False) == "holds in part"
    assert judge_parts(False, False) == "does not hold"


def test_numbers_read_well():
    assert format_percent(-3.7) == "\N{MINUS SIGN}4 %"
    assert format_percent(-0.2) == "0 %"
    assert format_spread([3.0, -1.0, 2.0]) == "\N{MINUS SIGN}1 to +3 %"


def test_every_claim_says_where_what_and_by_which_rule(found):
    assert len(found) == len(load_claims()) >= 30
    for claim in found.values():
        assert claim.verdict in get_args(Verdict)
        assert claim.section and claim.theme
        for text in (claim.paper, claim.evidence, claim.rule):
            assert text.endswith(".")
            assert not re.search(r"nan|inf\b|None|[{}]", text)


def test_without_studies_what_needs_one_is_not_tested_and_says_which():
    judged = by_key(load_claims())
    assert judged["fin-speed-eel"].evidence == "Not run: the efficiency study."
    assert judged["phase-optimum"].evidence == "Not run: the efficiency study, the side trials."
    assert judged["path-converges"].evidence == "Not run: the path-following study."
    assert judged["links-power"].evidence == "Not run: the side trials."
    assert {claim.verdict for claim in judged.values() if claim.evidence.startswith("Not run")} == {
        "not tested here"
    }
    assert judged["fin-length"].verdict == "holds"


def test_that_both_models_agree_is_judged_by_the_answer_of_its_campaign():
    finest = [one.path for one in campaign("parity").stored() if one.dt == MODELS["dt"]]
    assert len(finest) == 15
    assert max(finest) == pytest.approx(MODELS["path"], rel=0.03)
    judged = by_key(load_claims())["same-as-vortex"]
    assert judged.verdict == "holds"
    assert "differ by 0.000001 % of the distance or less at a step of 0.5 ms" in judged.evidence


def test_claims_about_simulations_say_which_joints(study, following, side, found):
    alone = ("fin-little-power", "fin-length", "repeatable", "eel-drag", "same-as-vortex")
    for claim in found.values():
        assert ("prescribed joints" in claim.evidence) == (claim.key not in alone)
    other = load_claims(replace(study, trial_settings={**study.trial_settings, "joints": "servo"}))
    assert "servo joints" in by_key(other)["accurate"].evidence


# ---- the studies decide --------------------------------------------------------------------------


def test_a_robot_that_swims_as_simulated_agrees_and_one_twice_as_fast_does_not(study):
    same = by_key(load_claims(with_speeds(study, lambda case: case.forward_velocity[0])))
    twice = by_key(load_claims(with_speeds(study, lambda case: 2.0 * case.forward_velocity[0])))
    for key in ("agreement-lateral", "agreement-lateral-fin", "agreement-eel", "accurate"):
        assert same[key].verdict == "holds"
        assert twice[key].verdict == "does not hold"
    assert "mean absolute error 0.0 %" in same["agreement-lateral"].evidence


def test_a_robot_that_swims_as_the_vortex_coefficients_say_is_closer_to_them(study):
    swum = with_speeds(study, lambda case: case.forward_velocity[1])
    assert by_key(load_claims(swum))["vortex-closer"].verdict == "holds"

    def with_own(case):
        return replace(
            case,
            forward_velocity=(1.0, *case.forward_velocity),
            mechanical_power=(1.0, *case.mechanical_power),
        )

    own = replace(study.settings.models[0], name="mine")
    settings = replace(study.settings, models=(own, *study.settings.models))
    curves = [
        replace(sweep, **{name: doubled_first(getattr(sweep, name)) for name in CURVES})
        for sweep in swum.sweeps
    ]
    three = replace(
        swum, settings=settings, cases=tuple(map(with_own, swum.cases)), sweeps=tuple(curves)
    )
    assert by_key(load_claims(three))["vortex-closer"] == by_key(load_claims(swum))["vortex-closer"]
    assert ", mine: mean absolute error" in by_key(load_claims(three))["accurate"].evidence
    only = replace(study, settings=replace(settings, models=(own, study.settings.models[1])))
    assert by_key(load_claims(only))["vortex-closer"].verdict == "not tested here"


def test_a_fin_that_doubled_every_speed_would_nearly_double_it(study):
    doubled = with_speeds(study, lambda case: 0.2 if case.group.has_fin else 0.1)
    text = by_key(load_claims(doubled))["fin-nearly-double"].evidence
    assert "Table 1: +100 to +100 %, median +100 %, 11 of 11 reach +90 %" in text


def test_runs_that_end_off_the_path_have_not_converged(following):
    def lost(case):
        figures = {
            **case.run.figures,
            "convergence_time": None,
            "convergence_distance": None,
            "last_third_error": 0.5,
        }
        return replace(case, run=replace(case.run, figures=figures, last_third_rms=0.5))

    judged = by_key(load_claims(replace(following, cases=tuple(map(lost, following.cases)))))
    assert judged["path-converges"].verdict == "does not hold"
    assert judged["path-same-controller"].verdict == "does not hold"
    assert judged["path-about-zero"].verdict == "does not hold"
    assert judged["path-converges"].evidence.count("0 of 12") == 1


def test_a_claim_about_path_following_says_in_how_many_ways_it_holds(following):
    def first_way_lost(case):
        lost = replace(
            case.band[0],
            last_third_rms=0.5,
            figures={**case.band[0].figures, "last_third_error": 0.5},
        )
        came = {
            **case.run.figures,
            "convergence_time": 5.0,
            "convergence_distance": 0.5,
            "last_third_error": 0.0,
        }
        kept = replace(case.run, figures=came, last_third_rms=0.01)
        return replace(case, run=kept, band=(lost, *(kept,) * (len(case.band) - 1)))

    n = len(following.cases[0].band)
    judged = by_key(
        load_claims(replace(following, cases=tuple(map(first_way_lost, following.cases))))
    )
    for key in ("path-converges", "path-same-controller", "path-about-zero"):
        assert judged[key].verdict == "holds"
        assert judged[key].evidence.endswith(
            f"The claim holds in {n - 1} of {n} ways to run the trials (joint law and bandwidth)."
        )
    assert "ways to run" not in judged["path-heading"].evidence
    alone = [replace(case, band=case.band[:1]) for case in following.cases]
    assert (
        "ways to run"
        not in by_key(load_claims(replace(following, cases=tuple(alone))))[
            "path-converges"
        ].evidence
    )


def test_a_maximum_at_the_end_of_its_range_is_not_one_of_the_papers_that_was_met(study):
    found = collect_efficiency_numbers(study)
    assert found["at_the_end"].count(True) > 0
    ends = zip(found["at_the_end"], found["distances"], strict=True)
    assert all(np.isinf(distance) == at_the_end for at_the_end, distance in ends)


def test_a_limit_cycle_does_not_pass_as_following_the_path(following):
    def swaying(case):
        came = {**case.run.figures, "convergence_time": 5.0, "convergence_distance": 0.5}
        return replace(case, run=replace(case.run, figures=came, last_third_rms=0.3))

    judged = by_key(load_claims(replace(following, cases=tuple(map(swaying, following.cases)))))
    assert judged["path-converges"].verdict == "holds in part"


def test_a_run_too_short_for_a_last_third_does_not_pass_as_following_the_path(following):
    cases = [replace(case, run=replace(case.run, last_third_rms=None)) for case in following.cases]
    numbers = collect_following_numbers(replace(following, cases=tuple(cases)))
    assert not any(numbers["all"]["stayed"])


def test_the_fin_brings_the_robot_to_the_path_sooner_if_it_does(following):
    def within(case, time):
        figures = {**case.run.figures, "convergence_time": time, "convergence_distance": time}
        return replace(case, run=replace(case.run, figures=figures))

    def with_times(bare, fin):
        cases = tuple(within(case, fin if case.group.has_fin else bare) for case in following.cases)
        return by_key(load_claims(replace(following, cases=cases)))["path-faster-with-fin"]

    assert with_times(2.0, 1.0).verdict == "holds"
    assert with_times(1.0, 2.0).verdict == "does not hold"
    assert with_times(None, 1.0).verdict == "holds"
    assert (
        "lateral undulation (not reached in all cases) without and 1.00 s with fin"
        in with_times(None, 1.0).evidence
    )


def test_what_more_links_bring_is_judged_at_the_same_gait_parameters(side):
    def grown(doubling, speed, power):
        short = doubling.shorter
        long = Mock(
            spec=Trial,
            forward_velocity=speed * short.forward_velocity,
            mechanical_power=power * short.mechanical_power,
        )
        return replace(doubling, longer=long)

    def with_links(speed, power):
        changed = [
            grown(one, speed, power) if one.in_common == "phase shift" else one
            for one in side.doublings
        ]
        return by_key(load_claims(replace(side, doublings=tuple(changed))))

    assert with_links(1.1, 10.0)["links-speed"].verdict == "holds"
    assert with_links(1.1, 10.0)["links-power"].verdict == "holds"
    assert with_links(1.3, 3.0)["links-speed"].verdict == "does not hold"
    assert with_links(1.3, 3.0)["links-power"].verdict == "does not hold"


# ---- the paper's numbers -------------------------------------------------------------------------


def test_the_printed_gains_follow_from_table_1(found, study):
    assert (
        "Recomputed from Table 1: +47.03 to +82.95 % over 4 settings."
        in found["fin-speed-lateral"].evidence
    )
    assert (
        "Recomputed from Table 1: +33.64 to +88.68 % over 5 settings."
        in found["fin-speed-eel"].evidence
    )
    known = [gain for gain in find_fin_gains(study.cases) if gain.measured.velocity is not None]
    simulated = [gain.simulated_change(lambda case: case.forward_velocity[0]) for gain in known]
    assert f"{format_spread(simulated)}, median" in found["fin-nearly-double"].evidence


def test_one_row_of_table_1_and_four_of_table_2_exceed_88_percent(found):
    text = found["fin-more-than-88"].evidence
    assert (
        "Table 1, 1 of 9 (eel-like motion, with fin, case 2, +88.68 %); Table 2, 4 of 6 (+78 to +122 %)"
        in text
    )
    assert found["fin-more-than-88"].verdict == "holds in part"


def test_the_tables_disagree_about_the_power(found):
    assert "it falls in 5 of 7" in found["fin-power-falls"].evidence
    assert "Table 2 +88.4 to +98.9 %" in found["fin-little-power"].evidence
    assert found["fin-little-power"].verdict == "holds in part"


def test_the_changes_of_table_2_are_those_printed_but_for_two_misprints():
    changes = find_printed_changes(read_path_following_trials())
    pairs = [(one.with_fin.printed_velocity, one.velocity) for one in changes]
    pairs += [(one.with_fin.printed_power, one.power) for one in changes]
    assert len(changes) == 6
    off = [(printed, round(found, 2)) for printed, found in pairs if abs(printed - found) > 0.02]
    assert off == [(89.04, 89.11), (94.51, 94.91)]


def test_misprints_are_listed_with_what_is_right():
    listed = {(entry.section, entry.printed): entry.instead for entry in find_misprints()}
    changes = {key: text for key, text in listed.items() if key[1].startswith("Change of")}
    assert [(where, printed, text.split(",")[0]) for (where, printed), text in changes.items()] == [
        ("Table 1, lateral undulation, with fin, case 3", "Change of power: +10.11 %.", "+4.79 %"),
        ("Table 2, lateral undulation, with fin, case 1", "Change of power: +89.04 %.", "+89.11 %"),
        ("Table 2, eel-like motion, with fin, case 2", "Change of power: +94.51 %.", "+94.91 %"),
    ]
    assert "3.6 m" in listed["2", "20 links of 0.18 m."]
    assert all(text.endswith(".") for pair in listed for text in (pair[1], listed[pair]))


@pytest.mark.parametrize(
    ("rule", "met", "not_met"),
    [
        ({"at_most": 2.0}, [1.0, 2.0], [1.0, 2.1]),
        ({"at_least": 2.0}, [2.0, 3.0], [1.9, 3.0]),
        ({"below": 2.0}, [1.0, 1.9], [1.0, 2.0]),
        ({"above": 2.0}, [2.1, 3.0], [2.0, 3.0]),
        ({"within": [1.0, 2.0]}, [1.0, 2.0], [1.0, 2.1]),
        ({"any_above": 2.0}, [1.0, 2.1], [1.0, 2.0]),
        ({"most_below": 2.0}, [1.0, 1.0, 3.0], [1.0, 3.0]),
        ({"median_at_least": 2.0}, [1.0, 2.0, 3.0], [1.0, 1.9, 3.0]),
        ({"spans": [1.0, 2.0]}, [1.01, 1.5, 2.01], [1.03, 1.5, 2.0]),
    ],
)
def test_a_part_of_a_rule_is_met_by_the_numbers_that_it_names(rule, met, not_met):
    known = {"study": {"met": met, "not met": not_met}}
    assert check_part({"of": "study.met", **rule}, known) == [True]
    assert check_part({"of": "study.not met", **rule}, known) == [False]


def test_each_of_several_numbers_can_be_a_part_of_its_own():
    assert check_part(
        {"each": "study.values", "below": 2.0}, {"study": {"values": [1.0, 3.0]}}
    ) == [True, False]


def test_energy_per_meter_is_power_over_speed(study):
    assert energy_change(10.0, 100.0) == pytest.approx(-45.0)  # 1.1 of the power at twice the speed
    found = collect_efficiency_numbers(study)
    gain = find_fin_gains(study.cases)[0]
    per_meter = [
        case.mechanical_power[0] / case.forward_velocity[0]
        for case in (gain.without, gain.with_fin)
    ]
    assert found["simulated_energy"][0] == pytest.approx(
        100.0 * (per_meter[1] / per_meter[0] - 1.0)
    )
    bare, fin = (
        next(t for t in read_path_following_trials() if t.has_fin == has_fin)
        for has_fin in (False, True)
    )
    change = (fin.mean_power / fin.forward_velocity) / (
        bare.mean_power / bare.forward_velocity
    ) - 1.0
    assert collect_table_numbers()["energy"][0] == pytest.approx(100.0 * change)
