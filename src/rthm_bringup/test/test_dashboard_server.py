"""The server of the dashboard: who gets what, and who may press its button."""

from __future__ import annotations

import json
import os
import time
from collections.abc import Iterator
from http.client import HTTPConnection, HTTPResponse
from pathlib import Path

import pytest
from simulated_graph import BESIDE, running, served

from rthm_bringup.dashboard.cost import Cost
from rthm_bringup.dashboard.hub import Hub
from rthm_bringup.dashboard.report import Report
from rthm_bringup.dashboard.server import FILES, Server
from rthm_bringup.dashboard.watching import Dashboard, variables
from rthm_bringup.run.domain import Leadership, led
from rthm_bringup.run.environment import PROFILES, Network
from rthm_core.errors import InputError
from rthm_core.spec import shipped_spec

SPEC = shipped_spec("paper")


@pytest.fixture
def hub() -> Hub:
    return Hub()


@pytest.fixture
def server(hub: Hub) -> Iterator[Server]:
    with served(hub) as server:
        yield server


def ask(server: Server, path: str, method: str = "GET", **headers: str) -> HTTPResponse:
    connection = HTTPConnection("127.0.0.1", server.server_port, timeout=10)
    connection.request(
        method, path, headers={name.replace("_", "-"): value for name, value in headers.items()}
    )
    return connection.getresponse()


def events(server: Server) -> Iterator[tuple[str, dict]]:
    """Events of the page's stream."""
    stream = ask(server, f"/events?token={server.token}")
    assert stream.getheader("Content-Type", "").startswith("text/event-stream")
    while line := stream.readline().decode():
        if line.startswith("event: "):
            yield line[7:].strip(), json.loads(stream.readline().decode().removeprefix("data: "))


def test_only_the_whole_address_opens_the_page(server) -> None:
    assert ask(server, f"/?token={server.token}").status == 200
    for path in ("/", "/?token=guessed", "/events", "/report", "/events?token="):
        assert ask(server, path).status == 403, path
    assert ask(server, f"/nothing?token={server.token}").status == 404
    assert server.address.startswith("http://127.0.0.1:")


def test_a_name_that_was_made_to_point_here_gets_nothing(server) -> None:
    for host in ("evil.example", f"evil.example:{server.server_port}", ""):
        assert ask(server, f"/?token={server.token}", Host=host).status == 421
        assert ask(server, "/abort", "POST", Host=host, X_Token=server.token).status == 403


def test_a_page_of_another_site_cannot_press_the_button(server, hub) -> None:
    aborts: list[str] = []
    hub.abort = lambda: aborts.append("asked for")
    own = f"http://127.0.0.1:{server.server_port}"
    pressed = {
        "another origin": ask(server, "/abort", "POST", Origin="http://evil.example", X_Token=server.token),
        "no origin": ask(server, "/abort", "POST", Origin="null", X_Token=server.token),
        "no token": ask(server, "/abort", "POST", Origin=own),
        "a guess": ask(server, "/abort", "POST", Origin=own, X_Token="guess"),
        "a form": ask(server, f"/abort?token={server.token}", "POST", Origin=own),
        "a link": ask(server, f"/abort?token={server.token}", Origin=own),
    }
    assert {name: one.status for name, one in pressed.items() if one.status not in (403, 404)} == {}
    assert aborts == []
    assert ask(server, "/abort", "POST", Origin=own, X_Token=server.token).status == 200
    assert aborts == ["asked for"]


def test_where_no_test_goes_on_nothing_is_aborted_then_or_later(server, hub) -> None:
    assert ask(server, "/abort", "POST", X_Token=server.token).status == 409
    aborts: list[str] = []
    hub.abort = lambda: aborts.append("asked for")
    hub.look(None, BESIDE)
    assert aborts == []


def test_the_page_may_load_nothing_from_elsewhere_and_nobody_may_frame_it(server) -> None:
    for path in FILES:
        answer = ask(server, f"{path}?token={server.token}")
        policy = answer.getheader("Content-Security-Policy", "")
        assert answer.status == 200 and len(answer.read()) > 500
        assert "default-src 'none'" in policy and "frame-ancestors 'none'" in policy
        assert answer.getheader("Referrer-Policy") == "no-referrer"


def test_a_page_is_told_the_layout_the_past_and_then_what_is_new(server, hub) -> None:
    stream = events(server)
    assert next(stream)[1]["state"] == "waiting"
    test = running(SPEC, hub, 3.0)
    late = events(server)
    name, layout = next(late)
    assert (name, layout["pulls"]) == ("layout", [{"motor": "a1", "plant": "x1", "numerical": "x2"}])
    name, shown = next(late)
    assert (name, shown["state"], shown["at"]) == ("now", "running", 3.0)
    assert [len(rows) for rows in shown["rows"]] == [148, 31]
    hub.look(test, BESIDE)
    assert next(late)[1]["rows"] == [[], []]
    seen = [data for name, data in stream_until(stream, 3.0) if name == "now"]
    assert sum(len(one["rows"][0]) for one in seen) == 148


def stream_until(stream: Iterator[tuple[str, dict]], at: float) -> Iterator[tuple[str, dict]]:
    for name, data in stream:
        yield name, data
        if data.get("at") == at:
            return


def test_the_report_is_given_once_it_is_written(server, tmp_path: Path) -> None:
    report = Report(str(tmp_path / "bag"), time.time())
    server.report = lambda: report.file
    assert ask(server, f"/report?token={server.token}").status == 404
    assert (report.words, report.over) == ("Its recording is being analysed.", False)
    file = tmp_path / "report.html"
    file.write_text("<h1>The report</h1>")
    assert report.file is None  # it may still be written
    os.utime(file, (time.time() + 5.0,) * 2)
    assert report.file is None
    report = Report(str(tmp_path / "bag"), time.time() - 20.0)
    os.utime(file, (time.time() - 10.0,) * 2)
    answer = ask(server, f"/report?token={server.token}")
    assert (answer.status, answer.read()) == (200, b"<h1>The report</h1>")
    os.utime(file, (time.time() - 60.0,) * 2)
    assert report.file is None  # of another run


def test_a_recorder_that_did_not_answer_is_told() -> None:
    assert Report("", 0.0).over
    assert "where rthm run was started" in Report("", 0.0).words


def test_a_port_that_is_taken_is_refused_in_a_sentence(server) -> None:
    with pytest.raises(InputError, match=r"Port \d+ is in use or reserved .* choose another with --port"):
        Server(Hub(), server.server_port)


def test_the_run_on_this_host_is_found_in_its_namespace() -> None:
    leadership = Leadership(77, "/found_by_a_test")
    assert led("/found_by_a_test") == [77]
    assert led("/found_by_another") == []
    leadership.release()
    assert led("/found_by_a_test") == []


def test_a_domain_that_is_given_is_listened_to_until_its_test_is_over(monkeypatch) -> None:
    class Quiet:
        """A watcher in whose domain nobody is."""

        test, bag, unread, can_abort = None, "", "", False

        def __init__(self, network: Network) -> None:
            self.left = 3

        @property
        def over(self) -> bool:
            return self.left == 0

        def take(self) -> None:
            self.left -= 1

        def close(self) -> None:
            assert self.over
            raise KeyboardInterrupt

    monkeypatch.setattr("rthm_bringup.dashboard.watcher_node.Watcher", Quiet)
    monkeypatch.setattr("rthm_bringup.dashboard.watching.step_back", lambda: None)
    dashboard = Dashboard(Network(domain=87), find=False, port=0)
    dashboard.run()
    assert dashboard.hub.shown["state"] == "waiting"


def test_the_listener_shares_no_memory_with_the_loop() -> None:
    profile = Path(variables(Network(7))[PROFILES]).read_text()
    assert "SHM" not in profile and "127.0.0.1" in profile
    assert variables(Network(7, open=True))["FASTDDS_BUILTIN_TRANSPORTS"] == "UDPv4"


def test_the_cost_is_the_share_of_a_core() -> None:
    cost = Cost(0.0)
    time.sleep(0.2)
    assert cost.share() < 0.9
    end = time.process_time() + 0.2
    while time.process_time() < end:
        pass
    assert cost.share() > 0.0
