"""Which requests of browsers a server of ours answers: those of its own pages, and of no page of somebody else's.

A browser sends what any page asks it to, also to servers of this computer that nobody else reaches. It says which page
that was (`Origin`) and which host the page named (`Host`), and a page can make it say nothing else.
"""

import ipaddress
from collections.abc import Callable

LOCAL = ("127.0.0.1", "localhost", "::1")
"""Hosts that are this computer alone."""


def refusal(host: str, headers: Callable[[str], list[str]]) -> str:
    """Why a request of a browser is not answered, in a sentence; "" if it is.

    Args:
        host: Where the server listens.
        headers: Gives all values of the request's header with a name.
    """
    hosts, origins = headers("Host"), headers("Origin")
    if len(hosts) != 1 or not _is_ours(host.lower(), hosts[0].lower()):
        return f"This server is at {host}, and not at {', '.join(hosts)[:80]!r}."
    if origins not in ([], [f"http://{hosts[0]}"]):
        return f"This server answers its own pages, and none of {', '.join(origins)[:80]!r}."
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
