"""Limits on the files that pages upload.

viser keeps all data of a file until it is complete, and acknowledges every part. Here, an upload
that exceeds the limits is discarded while it arrives.
"""

# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false

from importlib import import_module
from typing import Any

from laticauda.show.cockpit.events import show_refusal

MOST_UPLOADED = 128 << 20
"""Total size of files being uploaded, and size of one [bytes]."""
MOST_UPLOADS = 8
"""Files being uploaded at a time."""
LONGEST_NAME = 1000
"""Longest name of a file and of its upload, and longest type of a file [characters]."""
PART_COST = 1000
"""Overhead of a part of a file, in addition to its content [bytes]."""


def limit_uploads(server: Any) -> None:
    """Discard uploads to a server of viser that exceed the limits.

    Args:
        server: The server.
    """
    limits = _UploadLimits(server)
    messages = limits.messages
    sockets = server._websock_server
    sockets.unregister_handler(messages.FileTransferStartUpload)
    sockets.register_handler(messages.FileTransferStartUpload, limits.check_start)
    sockets.register_handler(messages.FileTransferPart, limits.check_part)


class _UploadLimits:
    """Handlers of viser's messages about uploads, called with the number of the page."""

    def __init__(self, server: Any) -> None:
        self.messages: Any = import_module("viser._messages")
        self._server = server
        self._button: Any = import_module("viser").GuiUploadButtonHandle
        self._start = server.gui._handle_file_transfer_start
        self._controls: dict[str, Any] = server.gui._gui_input_handle_from_uuid
        self._uploads: dict[str, Any] = server.gui._current_file_upload_states
        """viser's own record of every upload that is not complete, by its name."""

    def check_start(self, page: int, message: Any) -> None:
        """Begin an upload; refuse a file that is too large, or one of too many, and ignore what is no upload."""
        self._forget_acknowledgements()
        if not self._is_upload(message):
            return
        is_too_large = message.size_bytes > MOST_UPLOADED
        if not is_too_large and len(self._uploads) < MOST_UPLOADS:
            self._start(page, message)
            return
        clients = self._server.get_clients()
        if page in clients:
            limit = f"{MOST_UPLOADED >> 20} MiB or less"
            reason = f"A file must have {limit}, and be sent while few others are."
            show_refusal(clients[page], reason)

    def _is_upload(self, message: Any) -> bool:
        """Return whether a message is what a page sends for one of the buttons that take files."""
        names = (message.transfer_uuid, message.filename, message.mime_type)
        numbers = (message.part_count, message.size_bytes)
        if not all(isinstance(name, str) and len(name) <= LONGEST_NAME for name in names):
            return False
        if not all(isinstance(number, int) and number >= 0 for number in numbers):
            return False
        source = message.source_component_uuid
        control = self._controls.get(source) if isinstance(source, str) else None
        return isinstance(control, self._button)

    def check_part(self, page: int, message: Any) -> None:
        """Discard a file if all that have arrived so far are too large: it may be larger than announced."""
        size = sum(_kept_size(upload) for upload in self._uploads.values())
        if size > MOST_UPLOADED:
            self._uploads.pop(message.transfer_uuid, None)

    def _forget_acknowledgements(self) -> None:
        """Remove what the server keeps for pages that open later: no page needs it."""
        buffer = self._server._websock_server.get_message_buffer()
        buffer.remove_from_buffer(self._is_acknowledgement)

    def _is_acknowledgement(self, message: Any) -> bool:
        return isinstance(message, self.messages.FileTransferPartAck)


def _kept_size(upload: Any) -> int:
    """Return the memory that an upload needs so far [bytes]."""
    return upload["transferred_bytes"] + PART_COST * len(upload["parts"])
