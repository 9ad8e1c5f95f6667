"""A browser without a window, driven over its DevTools protocol: a page as a user has it."""

from __future__ import annotations

import asyncio
import base64
import json
import re
import shutil
import subprocess
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from tornado.httpclient import AsyncHTTPClient
from tornado.websocket import WebSocketClientConnection, websocket_connect

PROGRAMS = ("chromium", "chromium-browser", "google-chrome")
PATIENCE = 60.0
"""How long a browser on a busy host may take for anything, s."""


class Tab:
    """One page.

    Attributes
    ----------
    requests : list of str
        Addresses of everything that it asked for.
    complaints : list of str
        Exceptions, errors and warnings.
    said : list of str
        What else it wrote to the console.
    """

    def __init__(self, loop: asyncio.AbstractEventLoop, socket: WebSocketClientConnection) -> None:
        self._loop, self._socket, self._number = loop, socket, 0
        self.requests: list[str] = []
        self.complaints: list[str] = []
        self.said: list[str] = []
        for domain in ("Page", "Runtime", "Network", "Log"):
            self.call(f"{domain}.enable")

    def call(self, method: str, **parameters: Any) -> dict[str, Any]:
        """Call a method of the protocol and return its result."""
        self._number += 1
        message = json.dumps({"id": self._number, "method": method, "params": parameters})
        self._loop.run_until_complete(_send(self._socket, message))
        while (told := self._read()).get("id") != self._number:
            self._note(told)
        assert "error" not in told, (method, told["error"])
        return told["result"]

    def forget(self) -> None:
        """Forget what it asked for and wrote so far."""
        for told in (self.requests, self.complaints, self.said):
            told.clear()

    def open(self, address: str) -> None:
        """Go to an address."""
        self.call("Page.navigate", url=address)

    def resize(self, width: int, height: int = 900, *, dark: bool = False, phone: bool | None = None) -> None:
        """Be a screen of this size, px; by default a narrow one is a phone's, without touch."""
        self.call(
            "Emulation.setDeviceMetricsOverride",
            width=width,
            height=height,
            deviceScaleFactor=1,
            mobile=width < 500 if phone is None else phone,
        )
        self.call("Emulation.setTouchEmulationEnabled", enabled=bool(phone))
        scheme = {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}
        self.call("Emulation.setEmulatedMedia", features=[scheme])

    def value(self, expression: str) -> Any:
        """Value of an expression in the page."""
        answer = self.call("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        assert "exceptionDetails" not in answer, answer
        return answer["result"].get("value")

    def wait_for(self, expression: str) -> Any:
        """Wait until an expression is true in the page; return its value."""
        deadline = time.monotonic() + PATIENCE
        while not (found := self.value(expression)):
            assert time.monotonic() < deadline, f"never true: {expression}"
            time.sleep(0.05)
        return found

    def press(self, key: str, *, shift: bool = False) -> None:
        """Press and release a key."""
        codes = {"Tab": 9, "Enter": 13, "ArrowLeft": 37, "ArrowRight": 39}
        pressed = {"key": key, "code": key, "windowsVirtualKeyCode": codes[key], "modifiers": 8 * shift}
        text = {"text": "\r"} if key == "Enter" else {}
        self.call("Input.dispatchKeyEvent", type="keyDown", **pressed, **text)
        self.call("Input.dispatchKeyEvent", type="keyUp", **pressed)

    def swipe(self) -> None:
        """Draw a finger up the middle of what is shown."""
        for y in range(600, 270, -30):
            kind = "touchStart" if y == 600 else "touchMove"
            self.call("Input.dispatchTouchEvent", type=kind, touchPoints=[{"x": 200, "y": y}])
        self.call("Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])
        self.value("new Promise(done => setTimeout(done, 200))")

    def drag(self, x: float, y: float, by: float, *, finger: bool = False) -> None:
        """Draw what is at a place of the window sideways, px, by mouse or with a finger."""
        move = self._touch if finger else self._mouse
        for k in range(11):
            move("begin" if k == 0 else "move", x + 0.1 * k * by, y)
            self.value("new Promise(requestAnimationFrame)")
        move("end", x + by, y)
        self.value("new Promise(requestAnimationFrame)")

    def _mouse(self, what: str, x: float, y: float) -> None:
        kind = {"begin": "mousePressed", "move": "mouseMoved", "end": "mouseReleased"}[what]
        if what == "begin":
            self.call("Input.dispatchMouseEvent", type="mouseMoved", x=x, y=y)
        self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", buttons=1, clickCount=1)

    def _touch(self, what: str, x: float, y: float) -> None:
        kind = {"begin": "touchStart", "move": "touchMove", "end": "touchEnd"}[what]
        points = [] if what == "end" else [{"x": x, "y": y}]
        self.call("Input.dispatchTouchEvent", type=kind, touchPoints=points)

    def printed(self) -> bytes:
        """The page as PDF, A4."""
        told = self.call("Page.printToPDF", paperWidth=8.27, paperHeight=11.69, preferCSSPageSize=True)
        return base64.b64decode(told["data"])

    def picture(self, file: Path) -> None:
        """Write what the whole page looks like as PNG."""
        data = self.call("Page.captureScreenshot", captureBeyondViewport=True)["data"]
        file.write_bytes(base64.b64decode(data))

    def _read(self) -> dict[str, Any]:
        text = self._loop.run_until_complete(_received(self._socket))
        assert text is not None, "the browser has gone"
        return json.loads(text)

    def _note(self, told: dict[str, Any]) -> None:
        method, what = told.get("method"), told.get("params", {})
        if method == "Network.requestWillBeSent":
            self.requests.append(what["request"]["url"])
        elif method == "Runtime.consoleAPICalled":
            told_as = self.complaints if what["type"] in ("error", "warning") else self.said
            told_as.append(str([one.get("value") for one in what["args"]]))
        elif method == "Runtime.exceptionThrown":
            self.complaints.append(str(what["exceptionDetails"].get("exception") or what["exceptionDetails"]))
        elif method == "Log.entryAdded":
            self.complaints.append(f"{what['entry']['text']} {what['entry'].get('url', '')}")


@contextmanager
def browser() -> Iterator[Tab]:
    """A browser with one page; a test is skipped where there is none."""
    program = next(filter(None, map(shutil.which, PROGRAMS)), None)
    if program is None:
        pytest.skip(f"none of {', '.join(PROGRAMS)} is on this host")
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        command = [program, "--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage"]
        command += ["--remote-debugging-port=0", f"--user-data-dir={profile}", "about:blank"]
        log = open(Path(profile) / "log", "w+b")  # noqa: SIM115 - closed below, when its writer has gone
        process = subprocess.Popen(command, stdout=log, stderr=log)
        loop = asyncio.new_event_loop()
        try:
            port = _port(Path(log.name), process)
            socket = loop.run_until_complete(_connect(port))
            yield Tab(loop, socket)
            loop.run_until_complete(_close(socket))
        finally:
            process.terminate()
            process.wait(PATIENCE)
            log.close()
            loop.run_until_complete(asyncio.sleep(0))
            loop.close()


def _port(log: Path, process: subprocess.Popen[bytes]) -> int:
    deadline = time.monotonic() + PATIENCE
    while time.monotonic() < deadline and process.poll() is None:
        found = re.search(r"DevTools listening on ws://[^:]+:(\d+)/", log.read_text(errors="replace"))
        if found:
            return int(found[1])
        time.sleep(0.05)
    raise AssertionError(log.read_text(errors="replace"))


async def _send(socket: WebSocketClientConnection, message: str) -> None:
    await socket.write_message(message)


async def _close(socket: WebSocketClientConnection) -> None:
    socket.close()
    while await socket.read_message() is not None:
        pass


async def _received(socket: WebSocketClientConnection) -> str | bytes | None:
    return await asyncio.wait_for(socket.read_message(), PATIENCE)


async def _connect(port: int) -> WebSocketClientConnection:
    answer = await AsyncHTTPClient().fetch(f"http://127.0.0.1:{port}/json/list", request_timeout=PATIENCE)
    page = next(one for one in json.loads(answer.body) if one["type"] == "page")
    return await websocket_connect(page["webSocketDebuggerUrl"], max_message_size=2**28)
