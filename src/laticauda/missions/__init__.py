"""Missions: a robot finds, inspects and docks by what its sensors tell.

estimate.py    what a robot believes of itself and of the water
posture.py     where the middle of its body is, seen from the head
navigation.py  from readings of sensors to what it believes
steering.py    what a behaviour wants, and the helm
depth.py       holding a depth by the pitch joints
avoidance.py   keeping clear of what the sonar has seen
behaviours     what it does in a phase
phases.py      phases, and conditions that end them
mission.py     the table of phases, which is a controller
checking.py    what a mission must have before it runs
running.py     runs of missions, and what came of them
inspection.py  how near the body came to places, and what was seen of a net
campaign.py    one mission in many waters, with sensors that fail
campaign_table.py  the rows of a campaign in a CSV file
drawing.py     pictures: the table as a diagram, a run as a map
film.py        films of runs, in time lapse
film_frame.py  what stays the same in their pictures
film_water.py  the water in them
sensed.py      what the sensors told, for films
files.py       missions as files, in TOML
"""

from typing import TYPE_CHECKING

from laticauda.values import lazy_exports

if TYPE_CHECKING:
    from laticauda.missions.avoidance import Avoidance as Avoidance
    from laticauda.missions.behaviours import (
        Behaviour as Behaviour,
        FollowWall as FollowWall,
        Hover as Hover,
        KeepStation as KeepStation,
        Rest as Rest,
        Search as Search,
        StandOff as StandOff,
        SwimIntoDock as SwimIntoDock,
        SwimRoute as SwimRoute,
        SwimStraight as SwimStraight,
    )
    from laticauda.missions.campaign import (
        CampaignSummary as CampaignSummary,
        Conditions as Conditions,
        MergedCampaign as MergedCampaign,
        change_scenario as change_scenario,
        draw_conditions as draw_conditions,
        merge_campaign as merge_campaign,
        run_campaign as run_campaign,
        summarize_campaign as summarize_campaign,
        N_WORST as N_WORST,
    )
    from laticauda.missions.campaign_table import MissionRow as MissionRow
    from laticauda.missions.depth import DepthKeeping as DepthKeeping
    from laticauda.missions.drawing import draw_map as draw_map, draw_phases as draw_phases
    from laticauda.missions.estimate import Echo as Echo, Estimate as Estimate
    from laticauda.missions.files import (
        list_missions as list_missions,
        load_mission as load_mission,
    )
    from laticauda.missions.film import film_mission as film_mission
    from laticauda.missions.inspection import (
        find_net as find_net,
        measure_clearance as measure_clearance,
        measure_share_seen as measure_share_seen,
    )
    from laticauda.missions.mission import Mission as Mission, Way as Way
    from laticauda.missions.navigation import Navigation as Navigation
    from laticauda.missions.phases import (
        BatteryLow as BatteryLow,
        Captured as Captured,
        Condition as Condition,
        Phase as Phase,
        PositionUnsure as PositionUnsure,
        SensorHeard as SensorHeard,
        SensorSilent as SensorSilent,
        Touched as Touched,
        Transition as Transition,
    )
    from laticauda.missions.running import (
        MissionResult as MissionResult,
        PhaseChange as PhaseChange,
        judge_mission as judge_mission,
        mission_of as mission_of,
        read_changes as read_changes,
        run_mission as run_mission,
        run_missions as run_missions,
        start_of as start_of,
        swim_to_dock as swim_to_dock,
    )
    from laticauda.missions.steering import Helm as Helm, Steering as Steering

__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {
        "laticauda.missions.avoidance": ["Avoidance"],
        "laticauda.missions.behaviours": [
            "Behaviour",
            "FollowWall",
            "Hover",
            "KeepStation",
            "Rest",
            "Search",
            "StandOff",
            "SwimIntoDock",
            "SwimRoute",
            "SwimStraight",
        ],
        "laticauda.missions.campaign": [
            "CampaignSummary",
            "Conditions",
            "MergedCampaign",
            "change_scenario",
            "draw_conditions",
            "merge_campaign",
            "run_campaign",
            "summarize_campaign",
        ],
        "laticauda.missions.campaign_table": ["MissionRow"],
        "laticauda.missions.depth": ["DepthKeeping"],
        "laticauda.missions.drawing": ["draw_map", "draw_phases"],
        "laticauda.missions.estimate": ["Echo", "Estimate"],
        "laticauda.missions.files": ["list_missions", "load_mission"],
        "laticauda.missions.film": ["film_mission"],
        "laticauda.missions.inspection": ["find_net", "measure_clearance", "measure_share_seen"],
        "laticauda.missions.mission": ["Mission", "Way"],
        "laticauda.missions.navigation": ["Navigation"],
        "laticauda.missions.phases": [
            "BatteryLow",
            "Captured",
            "Condition",
            "Phase",
            "PositionUnsure",
            "SensorHeard",
            "SensorSilent",
            "Touched",
            "Transition",
        ],
        "laticauda.missions.running": [
            "MissionResult",
            "PhaseChange",
            "judge_mission",
            "mission_of",
            "read_changes",
            "run_mission",
            "run_missions",
            "start_of",
            "swim_to_dock",
        ],
        "laticauda.missions.steering": ["Helm", "Steering"],
    },
    plain={"laticauda.missions.campaign": ["N_WORST"]},
)
