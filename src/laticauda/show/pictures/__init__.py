"""Pictures and videos of trials, and an interactive window to view them, with MuJoCo's renderer.

Requires the extra `spatial`.
"""

from typing import TYPE_CHECKING

from laticauda.values import lazy_exports

if TYPE_CHECKING:
    from laticauda.show.pictures.camera import Film as Film
    from laticauda.show.pictures.render import (
        check_video as check_video,
        render_film as render_film,
        write_still as write_still,
    )
    from laticauda.show.pictures.replay import show as show
    from laticauda.show.pictures.stage import Studio as Studio, posture_of as posture_of

__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {},
    plain={
        "laticauda.show.pictures.camera": ["Film"],
        "laticauda.show.pictures.render": ["check_video", "render_film", "write_still"],
        "laticauda.show.pictures.replay": ["show"],
        "laticauda.show.pictures.stage": ["Studio", "posture_of"],
    },
)
