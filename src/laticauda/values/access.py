"""Access control for laticauda's servers: they answer their own pages and, from other computers, holders of the token.

A browser sends any request that a page asks for, even to servers on this computer that nobody else
can reach. It states which page asked (`Origin`) and which host the page named (`Host`), and a page
cannot make it state anything else.
"""

import hmac
import ipaddress
import os
import re
import secrets
from collections.abc import Callable
from dataclasses import dataclass, field

from laticauda.values.checks import check_hostname
from laticauda.values.errors import BadArgument

LOCAL = ("127.0.0.1", "localhost", "::1")
"""Hosts that stand for this computer alone."""
VARIABLE = "LATICAUDA_TOKEN"
"""Environment variable with a token to use, even on this computer, instead of a newly generated one."""


@dataclass(frozen=True)
class ServerAccess:
    """What a server requires of its clients."""

    host: str
    """Host on which the server listens."""
    token: str = field(repr=False)
    """Token that clients must know; "" if none is required."""

    @classmethod
    def of(cls, host: str) -> "ServerAccess":
        """Create the access rules of a server.

        Args:
            host: Host on which it listens; any host except those in `LOCAL` requires a token.

        Raises:
            ValueError: If `host` is not a host, or the environment's token could be guessed or
                cannot be part of a URL.
        """
        check_hostname("host", host)
        token = os.environ.get(VARIABLE, "")
        if token and not re.fullmatch(r"[A-Za-z0-9_-]{16,}", token):
            raise BadArgument(
                VARIABLE, "must be 16 or more letters, digits, `-` and `_`; its value is not shown"
            )
        if not token and host not in LOCAL:
            token = secrets.token_urlsafe(18)
        return cls(host, token)

    @property
    def warning(self) -> str:
        """Warning for the person who starts the server; "" if there is none."""
        if self.host in LOCAL:
            return ""
        return f"Anyone who reaches {self.host} and has the token is served; nothing is encrypted, not even the token."

    def url(self, port: int) -> str:
        """Return the address of the server's page, including the token.

        Args:
            port: Port on which it listens.
        """
        host = f"[{self.host}]" if ":" in self.host else self.host
        return f"http://{host}:{port}{self.token and f'/{self.token}/'}"

    def admits(self, token: object) -> bool:
        """Return whether a client with this token is admitted; the time taken is the same for all tokens of one length.

        Args:
            token: Token given by the client; anything but a text counts as no token.
        """
        if not self.token:
            return True
        text = token if isinstance(token, str) else ""
        return hmac.compare_digest(text.encode(errors="replace"), self.token.encode())

    def refusal(self, path: str, headers: Callable[[str], list[str]]) -> str:
        """Return why a browser's request is not answered, in a sentence; "" if it is answered.

        Args:
            path: Requested path, which begins with the token: a page's sockets have the page's
                address.
            headers: Returns all values of the request header with a given name.
        """
        hosts, origins = headers("Host"), headers("Origin")
        if len(hosts) != 1 or not _is_ours(self.host.lower(), hosts[0].lower()):
            return f"This server is at {self.host}, and not at {', '.join(hosts)[:80]!r}."
        if origins not in ([], [f"http://{hosts[0]}"]):
            return f"This server answers only its own pages, none of {', '.join(origins)[:80]!r}."
        if not self.admits(path.partition("?")[0].strip("/").partition("/")[0]):
            return "This server requires its token: open the complete address that it printed."
        return ""


def _is_ours(served: str, requested: str) -> bool:
    """Return whether a host names this server; others may have been pointed here by an attacker for a moment."""
    host, _, port = requested.rpartition(":")
    name = (host if port.isdigit() else requested).strip("[]")
    if (name and name == served) or name in LOCAL:
        return True
    try:  # a number is not a name: nobody else's page can have this server's address
        return served in ("", "0.0.0.0", "::") and bool(ipaddress.ip_address(name))
    except ValueError:
        return False
