"""Pictures and videos of trials, and an interactive window to view them, with MuJoCo's renderer.

Requires the extra `spatial`.

- `render`: films and stills of trials;
- `window`: MuJoCo's own window, in which a trial is replayed;
- `stage`: `Studio`, a robot in its surroundings, which takes postures and draws pictures;
- `posture`: the posture in which a robot is drawn, of a trial or of a state of a plant;
- `camera`: `Film`, which says what is filmed, and the cameras;
- `surroundings`, `looks`: floor, light, fog and the water's surface, and their colors;
- `water`: arrows and a moving surface, if the water moves;
- `shadows`: shadows of the robot;
- `lines`, `shapes`: trail and path, and the pieces that lines and arrows are made of;
- `captions`, `description`: text on a picture, and what it says about the trial;
- `video`: videos that every player plays;
- `renderer`: MuJoCo's renderer without a screen.
"""

from typing import TYPE_CHECKING

from laticauda.values import lazy_exports

if TYPE_CHECKING:
    from laticauda.show.pictures.camera import Film as Film, lift_to_space as lift_to_space
    from laticauda.show.pictures.description import describe_run as describe_run
    from laticauda.show.pictures.posture import read_posture as read_posture
    from laticauda.show.pictures.render import (
        render_film as render_film,
        write_still as write_still,
    )
    from laticauda.show.pictures.stage import Studio as Studio
    from laticauda.show.pictures.video import (
        check_video as check_video,
        find_ffmpeg as find_ffmpeg,
        write_video as write_video,
    )
    from laticauda.show.pictures.window import show_in_window as show_in_window

__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {},
    plain={
        "laticauda.show.pictures.camera": ["Film", "lift_to_space"],
        "laticauda.show.pictures.description": ["describe_run"],
        "laticauda.show.pictures.posture": ["read_posture"],
        "laticauda.show.pictures.render": ["render_film", "write_still"],
        "laticauda.show.pictures.stage": ["Studio"],
        "laticauda.show.pictures.video": ["check_video", "find_ffmpeg", "write_video"],
        "laticauda.show.pictures.window": ["show_in_window"],
    },
)
