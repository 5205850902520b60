"""The cockpit: a live page on which the robot swims; `Cockpit` is its server, `Live` its simulation without a page.

The simulation, which needs no page:
- `live`: a simulation that is driven by the wall clock, with its data for plotting and saving;
- `simulation`: one tick of it, and how it switches to another scenario;
- `changes`: changes to a scenario that a page can make;
- `buffer`: the last rows of a growing table;
- `readouts`: its figures, as text beside those of the paper.

The page and its server:
- `page`: `Cockpit`, which brings everything together;
- `server`, `uploads`: the server of the pages, who is answered, and how much may be sent to it;
- `events`: what users do, handled one at a time;
- `cameras`: the camera of each page.

The scene:
- `scene`: everything that is shown of a simulation;
- `bodies`, `lines`, `water`: a robot, a path or a trail, and moving water in the scene;
- `shapes`: meshes and poses of the robot's parts.

The panel:
- `controls`: all controls;
- `control`: one of them, a quantity that can be set;
- `gait_controls`, `body_controls`, `water_controls`, `path_controls`: those of one subject;
- `plots`: plots of the run;
- `gait_map`, `gait_trials`: a chart of trials over amplitude and frequency, and their computation;
- `runs`: controls that save, play back and repeat runs;
- `ghost`, `files`, `elsewhere`: a trial that is played back, its file, and the same run elsewhere;
- `operated`, `feed`: a robot that somebody else operates, and the recording that says where it is.
"""

from typing import TYPE_CHECKING

from laticauda.values import lazy_exports

if TYPE_CHECKING:
    from laticauda.show.cockpit.live import Live as Live
    from laticauda.show.cockpit.page import Cockpit as Cockpit
    from laticauda.show.cockpit.readouts import read_figures as read_figures
    from laticauda.show.cockpit.server import load_viser as load_viser

__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {
        "laticauda.show.cockpit.live": ["Live"],
        "laticauda.show.cockpit.page": ["Cockpit"],
        "laticauda.show.cockpit.readouts": ["read_figures"],
    },
    plain={
        "laticauda.show.cockpit.server": ["load_viser"],
    },
    renamed={"numbers": "read_figures"},
)
