"""Whose packets a process takes."""

from __future__ import annotations

import socket
from collections.abc import Iterator
from ipaddress import IPv4Address

import pytest

from rthm_core.errors import InputError
from rthm_core.ros import reach, sockets


@pytest.fixture
def listener() -> Iterator[socket.socket]:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as one:
        one.settimeout(5.0)
        yield one


def of(listener: socket.socket) -> sockets.Socket:
    return next(one for one in sockets.own() if one.descriptor == listener.fileno())


@pytest.mark.parametrize(("address", "loopback"), [("127.0.0.1", True), ("127.4.5.6", True), ("", False)])
def test_a_socket_of_this_process_is_found_where_it_is_bound(
    listener: socket.socket, address: str, loopback: bool
) -> None:
    listener.bind((address, 0))
    found = of(listener)
    assert (found.kind, found.port, found.loopback) == ("udp", listener.getsockname()[1], loopback)


def test_a_socket_that_listens_beyond_this_host_is_refused_with_its_port(listener: socket.socket) -> None:
    listener.bind(("127.0.0.1", 0))
    reach.refuse_open([of(listener)])
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
        other.bind(("", 0))
        with pytest.raises(InputError, match=f"at port {other.getsockname()[1]}, but must not"):
            reach.refuse_open([of(listener), of(other)])


def test_who_is_open_is_left_alone(listener: socket.socket) -> None:
    listener.bind(("", 0))
    reach.enforce(7, {reach.VARIABLE: reach.OPEN})
    reach.enforce(7, {})
    with pytest.raises(InputError, match="--network"):
        reach.enforce(7, {reach.VARIABLE: reach.HOST})


def received(listener: socket.socket, count: int) -> list[bytes]:
    return [listener.recv(100) for _ in range(count)]


def test_a_filter_passes_the_hosts_that_are_named_and_drops_the_others(listener: socket.socket) -> None:
    """Hosts outside of 127/8 are this machine's own addresses; without one there is nobody to be dropped."""
    outside = sockets.addresses()
    if not outside:
        pytest.skip("this machine has no address but that of the loopback interface")
    listener.bind((outside[0], 0))
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        sender.bind((outside[0], 0))
        for number, named in enumerate(
            (["10.255.0.9", outside[0]], ["10.255.0.9"], [outside[0], "10.0.0.1"])
        ):
            sockets.attach(listener.fileno(), sockets.only_from(map(IPv4Address, named)))
            sender.sendto(bytes([number]), listener.getsockname())
    assert received(listener, 2) == [b"\0", b"\2"]


def test_a_filter_passes_the_loopback_interface(listener: socket.socket) -> None:
    listener.bind(("127.0.0.1", 0))
    sockets.attach(listener.fileno(), sockets.only_from([]))
    listener.sendto(b"x", listener.getsockname())
    assert received(listener, 1) == [b"x"]


def test_announcements_have_even_ports_of_the_domain() -> None:
    ports = {port for port in range(7400, 7400 + 250 * 233) if reach.announces(port, 97)}
    assert ports == {31650, *range(31660, 31900, 2)}


def test_a_peer_without_an_address_is_refused() -> None:
    assert reach.addresses_of(["127.0.0.2", "", "localhost"]) == [
        IPv4Address("127.0.0.1"),
        IPv4Address("127.0.0.2"),
    ]
    with pytest.raises(InputError, match="The peer 'no-such-host"):
        reach.addresses_of(["no-such-host.invalid"])
