"""MuJoCo below Python: the memory layout of its structures, and calls of its functions from compiled code.

Compiled callbacks receive two plain addresses, of the model and of the data. They find what they
need from the data by the fields' offsets in the structure, which are the same for all data of one
build of MuJoCo; `offsets` measures them on a small model instead of relying on a header. MuJoCo's
functions are called by name and others by address, passed as a number, so that compiled code can be
cached on disk.
"""

# pyright: reportUnknownParameterType=false, reportMissingParameterType=false, reportUnknownVariableType=false
# pyright: reportUnknownMemberType=false, reportUnknownArgumentType=false, reportUntypedFunctionDecorator=false

import ctypes
import os
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import llvmlite.binding
import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from laticauda.values import load_mujoco
from laticauda.water.mujoco.table import AT

# A free body with a hinged child: every array of interest has a distinct address.
_PROBE = """
<mujoco><worldbody><body><freejoint/><geom size=".1"/>
<body pos="1 0 0"><joint/><geom size=".1" pos=".2 0 0"/><site name="s"/></body></body></worldbody>
<sensor><force site="s"/></sensor></mujoco>
"""
_CONTACTS_TRIED = (5, 3, 4, 1)
"""Numbers of contacts by which their counter is found."""
_RARE = 0.7310585786300049
"""A number that occurs nowhere else."""
_RARE_FLAGS = 0x2A5C39D6
"""Flags that occur nowhere else."""
_PAGE = 1024
"""Bytes by which the search for the end of a structure goes on."""
_LARGEST = 1 << 20
"""Size that no structure reaches [bytes]."""
_LIBRARIES = ("libmujoco*.so*", "libmujoco*.dylib", "mujoco*.dll")
"""Files that may be MuJoCo's library, on Linux, macOS and Windows."""


def _function(name: str, result: Any, *arguments: Any) -> Any:
    """Declare a function of MuJoCo for compiled code, where an address is a 64-bit integer."""
    return types.ExternalFunction(name, result(*arguments))


_integer = types.int64
_flag = types.int32
factor_inertia = _function("mj_factorM", types.void, _integer, _integer)
mark_stack = _function("mj_markStack", types.void, _integer)
free_stack = _function("mj_freeStack", types.void, _integer)
allocate = _function("mj_stackAllocNum", _integer, _integer, _integer)
forward_skip = _function("mj_forwardSkip", types.void, _integer, _integer, _flag, _flag)
integrate_positions = _function(
    "mj_integratePos", types.void, _integer, _integer, _integer, types.float64
)
forces_after = _function("mj_rnePostConstraint", types.void, _integer, _integer)
contact_force = _function("mj_contactForce", types.void, _integer, _integer, _flag, _integer)
stop = _function("mju_error", types.void, _integer)
_FUNCTIONS = (
    factor_inertia,
    mark_stack,
    free_stack,
    allocate,
    forward_skip,
    integrate_positions,
    forces_after,
    contact_force,
    stop,
)


@cache
def library() -> ctypes.CDLL:
    """Return the shared library that the module `mujoco` uses; once it is open, compiled code finds its functions.

    Raises:
        OSError: If the loaded library is not that of the module: packages have overwritten each
            other.
    """
    mujoco = load_mujoco()
    folder = Path(mujoco.__file__).parent
    opened = _open_running(folder, mujoco.__version__)
    if opened is None:
        raise OSError(
            f"no library of MuJoCo {mujoco.__version__} is running from {folder}: two packages may have been installed "
            "into it; uninstall `mujoco` and `mujoco-core`, and install `mujoco` again"
        )
    for function in _FUNCTIONS:
        address = ctypes.cast(getattr(opened, function.symbol), ctypes.c_void_p).value
        llvmlite.binding.add_symbol(function.symbol, address)
    return opened


def _open_running(folder: Path, version: str) -> ctypes.CDLL | None:
    """Return the library in a folder that is already loaded and has a version; None: there is none."""
    only_if_loaded = getattr(os, "RTLD_NOLOAD", 0)  # Windows opens a library only once anyway
    for pattern in _LIBRARIES:
        for path in folder.glob(pattern):
            try:
                opened = ctypes.CDLL(str(path), mode=ctypes.DEFAULT_MODE | only_if_loaded)
            except OSError:
                continue  # another version's, which is not loaded
            opened.mj_versionString.restype = ctypes.c_char_p
            if opened.mj_versionString().decode() == version:
                return opened
    return None


@cache
def offsets() -> list[int]:
    """Return the offsets of the fields `AT` from the start of `mjData` [bytes]."""
    mujoco = load_mujoco()
    data = mujoco.MjData(mujoco.MjModel.from_xml_string(_PROBE))
    data.time = _RARE
    signature = np.uint64(data.signature)  # located after all pointers
    content = _words(data._address, signature, "data")
    offsets_of_fields: list[int] = []
    for name in AT._fields:
        if name == "time":
            value = np.float64(_RARE).view(np.uint64)
        else:
            value = np.uint64(getattr(data, name).ctypes.data)
        offsets_of_fields.append(_last(content, value, name))
    return offsets_of_fields


@cache
def model_offsets() -> dict[str, int]:
    """Return offsets in `mjModel` [bytes]: of options, two of them contact overrides, and of the armature's address."""
    model = load_mujoco().MjModel.from_xml_string(_PROBE)
    margin = 2.0 * _RARE
    model.opt.timestep = _RARE
    model.opt.o_margin = margin
    model.opt.disableflags = _RARE_FLAGS
    armature = np.uint64(model.dof_armature.ctypes.data)
    content = _words(model._address, armature, "model")
    flags = content.view(np.int32)
    return {
        "gravity": model.opt.gravity.ctypes.data - model._address,
        "o_friction": model.opt.o_friction.ctypes.data - model._address,
        "disableflags": _last(flags, _RARE_FLAGS, "disableflags", size=4),
        "timestep": _last(content, np.float64(_RARE).view(np.uint64), "timestep"),
        "o_margin": _last(content, np.float64(margin).view(np.uint64), "o_margin"),
        "dof_armature": _last(content, armature, "dof_armature"),
    }


class ContactLayout(NamedTuple):
    """Where `mjData` has its contacts, and a contact its fields [bytes]."""

    first: int
    """Offset in the data of the address of the first contact."""
    n_contacts: int
    """Offset in the data of the number of contacts, 32 bits."""
    size: int
    """Size of a contact."""
    geom: int
    """Offset in a contact of its two geoms, 32 bits each; -1: a flex."""
    frame: int
    """Offset in a contact of its axes, nine numbers, row by row."""


@cache
def contact_layout() -> ContactLayout:
    """Return where the contacts are, measured on balls of which as many touch a plane as are tried."""
    mujoco = load_mujoco()
    ball = '<body pos="{x} 0 1"><freejoint/><geom size=".1"/></body>'
    balls = "".join(ball.format(x=x) for x in range(max(_CONTACTS_TRIED)))
    plane = '<geom type="plane" size="9 9 1"/>'
    model = mujoco.MjModel.from_xml_string(
        f"<mujoco><worldbody>{plane}{balls}</worldbody></mujoco>"
    )
    data = mujoco.MjData(model)
    signature = np.uint64(data.signature)
    counters: set[int] | None = None
    content = np.zeros(0, dtype=np.uint64)
    for n_contacts in _CONTACTS_TRIED:
        heights = data.qpos[2::7]
        heights[:] = 1.0
        heights[:n_contacts] = 0.05
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_collision(model, data)
        content = _words(data._address, signature, "data")
        places = set(np.flatnonzero(content.view(np.int32) == n_contacts).tolist())
        counters = places if counters is None else counters & places
    contacts = data.contact
    start = contacts.dist.ctypes.data
    if not counters:
        raise OSError("the number of contacts was not found in this build of MuJoCo")
    return ContactLayout(
        first=_last(content, np.uint64(start), "contact"),
        n_contacts=4 * max(counters),
        size=int(contacts.geom.strides[0]),
        geom=contacts.geom.ctypes.data - start,
        frame=contacts.frame.ctypes.data - start,
    )


def _words(start: int, target: np.uint64, structure: str) -> np.ndarray:
    """Return the words of a structure from its start to the first that holds `target`, which is near its end.

    Memory beyond the end may hold what is left of another structure, with the same addresses.
    """
    for length in range(_PAGE, _LARGEST, _PAGE):
        memory = (ctypes.c_uint64 * (length // 8)).from_address(start)
        content = np.ctypeslib.as_array(memory)
        if target in content[-_PAGE // 8 :]:
            return content[: int(np.argmax(content == target)) + 1]
    raise OSError(f"the {structure} of this build of MuJoCo is not laid out as expected")


def _last(content: np.ndarray, value: Any, name: str, size: int = 8) -> int:
    """Return the offset of the last place of a value [bytes].

    Empty arrays before a field, and the buffer's own pointer, may have the same address.
    """
    places = np.flatnonzero(content == value)
    if places.size == 0:
        raise OSError(f"`{name}` was not found in this build of MuJoCo")
    return int(places[-1]) * size


@intrinsic
def pointer(typingctx, number):
    """Convert an address, given as a number, to an untyped pointer."""
    del typingctx, number

    def codegen(context, builder, signature, arguments):
        return builder.inttoptr(arguments[0], cgutils.voidptr_t)

    return types.voidptr(types.int64), codegen


def _load_at(result_type, stored_type):
    """Return the type and the code for reading the value at an address."""

    def codegen(context, builder, signature, arguments):
        place = builder.inttoptr(arguments[0], stored_type.as_pointer())
        return builder.load(place)

    return result_type(types.int64), codegen


@intrinsic
def word_at(typingctx, number):
    """Return the 64-bit integer at an address."""
    return _load_at(types.int64, ir.IntType(64))


@intrinsic
def flags_at(typingctx, number):
    """Return the 32-bit integer at an address."""
    return _load_at(types.int32, ir.IntType(32))


@intrinsic
def number_at(typingctx, number):
    """Return the 64-bit floating-point number at an address."""
    return _load_at(types.float64, ir.DoubleType())


def _call(*arguments):
    """Return type and code of a call to the function at an address; it takes 64-bit integers and returns nothing."""

    def codegen(context, builder, signature, values):
        function_type = ir.FunctionType(ir.VoidType(), [ir.IntType(64)] * len(arguments))
        function = builder.inttoptr(values[0], function_type.as_pointer())
        builder.call(function, values[1:])
        return context.get_dummy_value()

    return types.void(types.int64, *arguments), codegen


@intrinsic
def call_3(typingctx, address, a, b, c):
    """Call the function f(a, b, c) at an address."""
    return _call(a, b, c)


@intrinsic
def call_2(typingctx, address, a, b):
    """Call the function f(a, b) at an address."""
    return _call(a, b)
