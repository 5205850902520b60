"""Whether pictures and films can be made here, and the reason if not."""

from functools import cache

import pytest

from laticauda.values.errors import MissingExtra, MissingProgram


@cache
def reason_why_not() -> str | None:
    try:
        from laticauda.show.pictures.video import check_video

        check_video()
    except (MissingExtra, MissingProgram) as error:
        return str(error)
    return None


def skip_without_rendering() -> None:
    """Skip the test that calls this where nothing can be rendered."""
    if (reason := reason_why_not()) is not None:
        pytest.skip(reason)
