"""The address of a host."""

import socket


def address_of(host: str) -> str | None:
    """Return a host's address, of the fourth version of IP where it has one; None if unknown."""
    try:
        found = socket.getaddrinfo(host, None, type=socket.SOCK_STREAM)
    except OSError:
        return None
    known = sorted(found, key=lambda each: each[0] != socket.AF_INET)
    return str(known[0][4][0])
