"""Server of the page: this host only, and only for who has the address with its token.

A page of another site can make a browser send requests here, so every request has to name this host (a name
that was made to point here is another one), and what is not a plain file needs the token of the address.
An abort needs it in a header, which no other site can set, and the origin of our own page.
"""

from __future__ import annotations

import errno
import secrets
from collections.abc import Callable
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from importlib.resources import files
from pathlib import Path
from typing import Any
from urllib.parse import parse_qs, urlsplit

from rthm_bringup.dashboard.hub import Hub
from rthm_core.errors import InputError

HOST = "127.0.0.1"
TOKEN = "X-Token"

HTML, CSS, SCRIPT = "text/html", "text/css", "text/javascript"
FILES = {
    "/": ("rthm_bringup.dashboard", "page/index.html", HTML),
    "/style.css": ("rthm_analysis.report", "page.css", CSS),
    "/dashboard.css": ("rthm_bringup.dashboard", "page/dashboard.css", CSS),
    "/dashboard.js": ("rthm_bringup.dashboard", "page/dashboard.js", SCRIPT),
    "/curves.js": ("rthm_bringup.dashboard", "page/curves.js", SCRIPT),
    "/rig.js": ("rthm_bringup.dashboard", "page/rig.js", SCRIPT),
}
"""Package, file and type of what is served as it is; the style is that of the report."""

OWN = "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src data:"
ITSELF = "default-src 'unsafe-inline' 'unsafe-eval' data: blob:"
"""What a page may load: files of ours, or nothing but itself."""
NOBODY = "frame-ancestors 'none'; base-uri 'none'; form-action 'none'"
"""No page of another site may show ours as a part of it."""


class Server(ThreadingHTTPServer):
    """Server of one dashboard.

    Parameters
    ----------
    hub : Hub
        What is shown.
    port : int
        0: a free one.

    Attributes
    ----------
    report : callable
        Gives the file of the report of the test that is over; None: there is none.

    Raises
    ------
    InputError
        If the port is taken.
    """

    daemon_threads = True

    def __init__(self, hub: Hub, port: int) -> None:
        self.hub, self.token = hub, secrets.token_urlsafe(16)
        self.report: Callable[[], Path | None] = lambda: None
        try:
            super().__init__((HOST, port), Page)
        except OSError as error:
            if error.errno not in (errno.EADDRINUSE, errno.EACCES):
                raise
            raise InputError(
                f"Port {port} is in use or reserved on this host; choose another with --port, or 0 for "
                "any free one."
            ) from error

    @property
    def address(self) -> str:
        """Address of the page, with the token."""
        return f"http://{HOST}:{self.server_port}/?token={self.token}"

    def close(self) -> None:
        """End, and let all pages go."""
        self.hub.close()
        self.shutdown()
        self.server_close()

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Let a browser leave in the middle of an answer."""


class Page(BaseHTTPRequestHandler):
    """Answers one request."""

    server: Server
    server_version, sys_version = "rthm", ""

    def do_GET(self) -> None:
        """Give a file, the stream of events, the newest snapshot, or the report."""
        path = urlsplit(self.path).path
        if not self._is_addressed():
            self._refuse(
                HTTPStatus.MISDIRECTED_REQUEST, "This page can be opened only on the host that serves it."
            )
        elif path in FILES and path != "/":
            self._give_file(path)
        elif not self._is_known(parse_qs(urlsplit(self.path).query).get("token", [""])[0]):
            self._refuse(
                HTTPStatus.FORBIDDEN,
                "The token is missing; open the whole address that rthm dashboard printed.",
            )
        elif path == "/":
            self._give_file(path)
        elif path == "/events":
            self._stream()
        elif path == "/report" and (report := self.server.report()) is not None:
            self._give(report.read_bytes(), HTML, ITSELF)
        else:
            self._refuse(HTTPStatus.NOT_FOUND, "There is no such page.")

    def do_POST(self) -> None:
        """Abort the test."""
        origin = self.headers.get("Origin", self._own_origin())
        if not self._is_addressed() or origin != self._own_origin():
            self._refuse(HTTPStatus.FORBIDDEN, "Only the page of this dashboard may ask for this.")
        elif not self._is_known(self.headers.get(TOKEN, "")):
            self._refuse(HTTPStatus.FORBIDDEN, "The token is missing, or is that of another dashboard.")
        elif self.path != "/abort":
            self._refuse(HTTPStatus.NOT_FOUND, "There is no such action.")
        elif (abort := self.server.hub.abort) is None:
            self._refuse(HTTPStatus.CONFLICT, "No test is running.")
        else:
            abort()
            self._give(b"asked for", "text/plain")

    def log_message(self, format: str, *args: Any) -> None:
        """Say nothing on the terminal."""

    def _own_origin(self) -> str:
        return f"http://{self.headers.get('Host', '')}"

    def _is_addressed(self) -> bool:
        own = {f"{name}:{self.server.server_port}" for name in (HOST, "localhost")}
        return self.headers.get("Host", "") in own

    def _is_known(self, token: str) -> bool:
        return secrets.compare_digest(token.encode(), self.server.token.encode())

    def _give_file(self, path: str) -> None:
        package, name, kind = FILES[path]
        self._give(files(package).joinpath(name).read_bytes(), kind)

    def _give(self, content: bytes, kind: str, policy: str = OWN) -> None:
        self._begin(HTTPStatus.OK, kind, policy)
        self.send_header("Content-Length", str(len(content)))
        self.end_headers()
        self.wfile.write(content)

    def _refuse(self, status: HTTPStatus, sentence: str) -> None:
        self._begin(status, "text/plain")
        self.end_headers()
        self.wfile.write(sentence.encode())

    def _stream(self) -> None:
        """Send events (server-sent, HTML standard, section 9.2) until the page has gone."""
        self._begin(HTTPStatus.OK, "text/event-stream")
        self.end_headers()
        for name, text in self.server.hub.follow():
            self.wfile.write(f"event: {name}\ndata: {text}\n\n".encode())

    def _begin(self, status: HTTPStatus, kind: str, policy: str = OWN) -> None:
        self.send_response(status)
        headers = {
            "Content-Type": f"{kind}; charset=utf-8",
            "Content-Security-Policy": f"{policy}; {NOBODY}",
            "Cache-Control": "no-store",
            "Referrer-Policy": "no-referrer",
            "X-Content-Type-Options": "nosniff",
        }
        for name, value in headers.items():
            self.send_header(name, value)
