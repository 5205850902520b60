"""The scripts of campaigns/, whose slices the tests run."""

import importlib.util
import sys
from functools import cache
from pathlib import Path
from typing import Any

FOLDER = Path(__file__).parent.parent / "campaigns"
sys.path.append(str(FOLDER))  # what several of them share


@cache
def campaign(name: str) -> Any:
    """A script as a module, which its worker processes and dataclasses find again by its name."""
    spec = importlib.util.spec_from_file_location(name, FOLDER / f"{name}.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    return module
