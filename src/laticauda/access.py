"""Who may speak to a server of ours: its own pages, and from other computers whoever has its token.

A browser sends what any page asks it to, also to servers of this computer that nobody else reaches. It says which page
that was (`Origin`) and which host the page named (`Host`), and a page can make it say nothing else.
"""

import hmac
import ipaddress
import os
import re
import secrets
from collections.abc import Callable
from dataclasses import dataclass, field

from laticauda.errors import BadArgument, hostname

LOCAL = ("127.0.0.1", "localhost", "::1")
"""Hosts that are this computer alone."""
VARIABLE = "LATICAUDA_TOKEN"
"""Of the environment: a token to take, on this computer too, instead of one that is made anew."""


@dataclass(frozen=True)
class Door:
    """What a server asks of those who come to it."""

    host: str
    """Where it listens."""
    token: str = field(repr=False)
    """What they have to know; "" if nothing."""

    @classmethod
    def of(cls, host: str) -> "Door":
        """The door of a server.

        Args:
            host: Where it listens; for any but `LOCAL` there is a token.

        Raises:
            ValueError: If that is no host, or the token of the environment could be guessed or be no part of a URL.
        """
        hostname("host", host)
        given = os.environ.get(VARIABLE, "")
        if given and not re.fullmatch(r"[A-Za-z0-9_-]{16,}", given):
            raise BadArgument(VARIABLE, "must be 16 or more letters, digits, `-` and `_`; its value is not shown")
        return cls(host, given or ("" if host in LOCAL else secrets.token_urlsafe(18)))

    @property
    def warning(self) -> str:
        """What to say to whoever opens it; "" if there is nothing to say."""
        if self.host in LOCAL:
            return ""
        return f"Whoever reaches {self.host} and has the token is answered; nothing is encrypted, the token neither."

    def url(self, port: int) -> str:
        """The address of its page, with the token.

        Args:
            port: Where it listens.
        """
        host = f"[{self.host}]" if ":" in self.host else self.host
        return f"http://{host}:{port}{self.token and f'/{self.token}/'}"

    def admits(self, token: object) -> bool:
        """Whether somebody who says this may speak; it takes as long for any token of a length.

        Args:
            token: What they say; anything but a text is no token.
        """
        said = token if isinstance(token, str) else ""
        return not self.token or hmac.compare_digest(said.encode(errors="replace"), self.token.encode())

    def refusal(self, path: str, headers: Callable[[str], list[str]]) -> str:
        """Why a request of a browser is not answered, in a sentence; "" if it is.

        Args:
            path: What it asks for, which begins with the token: a page's sockets have the page's address.
            headers: Gives all values of the request's header with a name.
        """
        hosts, origins = headers("Host"), headers("Origin")
        if len(hosts) != 1 or not _is_ours(self.host.lower(), hosts[0].lower()):
            return f"This server is at {self.host}, and not at {', '.join(hosts)[:80]!r}."
        if origins not in ([], [f"http://{hosts[0]}"]):
            return f"This server answers its own pages, and none of {', '.join(origins)[:80]!r}."
        if not self.admits(path.partition("?")[0].strip("/").partition("/")[0]):
            return "This server answers whoever has its token: open the address that it printed, as a whole."
        return ""


def _is_ours(served: str, given: str) -> bool:
    """Whether a host names this server; any other name may be one that somebody lets point here for a moment."""
    name = (given.rpartition(":")[0] if given.rpartition(":")[2].isdigit() else given).strip("[]")
    if (name and name == served) or name in LOCAL:
        return True
    try:  # a number is no name: nobody else's page can be at ours
        return served in ("", "0.0.0.0", "::") and bool(ipaddress.ip_address(name))
    except ValueError:
        return False
