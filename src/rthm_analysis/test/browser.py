"""Chromium without a window, driven over its DevTools protocol: what a page really does."""

from __future__ import annotations

import asyncio
import base64
import json
import shutil
import subprocess
from itertools import count
from pathlib import Path
from typing import Any

from tornado.websocket import WebSocketClientConnection, websocket_connect

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")

LARGEST_MESSAGE = 200_000_000
PATIENCE = 60.0
"""Seconds until a page that does nothing counts as hung."""


class Browser:
    """One page at a time, in a process of its own; what it logs and asks for is kept."""

    def __init__(self, profile: Path) -> None:
        assert CHROMIUM is not None
        self._loop = asyncio.new_event_loop()
        options = ("--headless", "--no-sandbox", "--disable-gpu", "--remote-debugging-port=0")
        self._process = subprocess.Popen(
            [CHROMIUM, *options, f"--user-data-dir={profile}", "about:blank"],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        self._numbers = count(1)
        self.events: list[dict[str, Any]] = []
        self._connection = self._run(self._connect(profile / "DevToolsActivePort"))
        for domain in ("Page", "Runtime", "Network", "Log"):
            self.call(f"{domain}.enable")

    def open(self, page: Path, width: int = 1300, *, dark: bool = False, phone: bool = False) -> None:
        """Load a page anew and wait until its plots are drawn; forget what happened before."""
        size = {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": phone}
        self.call("Emulation.setDeviceMetricsOverride", **size)
        self.call("Emulation.setTouchEmulationEnabled", enabled=phone)
        scheme = {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}
        self.call("Emulation.setEmulatedMedia", features=[scheme])
        self.events.clear()
        self.call("Page.navigate", url=page.resolve().as_uri())
        ready = (
            "document.readyState == 'complete' && (!window.Bokeh || document.documentElement.dataset.ready)"
        )
        self.evaluate(
            f"new Promise(done => {{ const look = () => {ready} ? done(1) : setTimeout(look, 20); look(); }})"
        )

    def evaluate(self, script: str) -> Any:
        """Value of an expression in the page, awaited where it is a promise."""
        told = self.call("Runtime.evaluate", expression=script, awaitPromise=True, returnByValue=True)
        if "exceptionDetails" in told:
            raise AssertionError(told["exceptionDetails"])
        return told["result"].get("value")

    def press(self, key: str) -> None:
        """Press a key, as Tab or Enter."""
        codes = {"Tab": 9, "Enter": 13}
        text = {"text": "\r"} if key == "Enter" else {}
        for kind in ("keyDown", "keyUp"):
            self.call("Input.dispatchKeyEvent", type=kind, key=key, windowsVirtualKeyCode=codes[key], **text)

    def swipe(self) -> None:
        """Draw a finger up the middle of what is shown."""
        for y in range(600, 270, -30):
            kind = "touchStart" if y == 600 else "touchMove"
            self.call("Input.dispatchTouchEvent", type=kind, touchPoints=[{"x": 200, "y": y}])
        self.call("Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])
        self.evaluate("new Promise(done => setTimeout(done, 200))")

    def printed(self) -> bytes:
        """The page as PDF, A4."""
        told = self.call("Page.printToPDF", paperWidth=8.27, paperHeight=11.69, preferCSSPageSize=True)
        return base64.b64decode(told["data"])

    def picture(self) -> bytes:
        """The whole page as PNG."""
        told = self.call("Page.captureScreenshot", captureBeyondViewport=True)
        return base64.b64decode(told["data"])

    @property
    def complaints(self) -> list[str]:
        """Errors and warnings of the page since it was opened."""
        told = [e["params"] for e in self.events if e["method"] == "Runtime.exceptionThrown"]
        logged = [
            e["params"]
            for e in self.events
            if e["method"] == "Runtime.consoleAPICalled" and e["params"]["type"] in ("error", "warning")
        ]
        entries = [e["params"] for e in self.events if e["method"] == "Log.entryAdded"]
        return [json.dumps(one)[:400] for one in (*told, *logged, *entries)]

    @property
    def requests(self) -> list[str]:
        """Addresses outside the page that it asked for."""
        asked = [e["params"] for e in self.events if e["method"] == "Network.requestWillBeSent"]
        return [
            url for one in asked if not (url := one["request"]["url"]).startswith(("file:", "data:", "blob:"))
        ]

    def call(self, method: str, **parameters: Any) -> dict[str, Any]:
        """Call a method of the protocol, and keep the events that come before its answer."""
        return self._run(self._call(method, parameters))

    def close(self) -> None:
        """End the process."""
        self._connection.close()
        self._process.terminate()
        self._process.wait(20)
        self._loop.close()

    def _run(self, work: Any) -> Any:
        return self._loop.run_until_complete(asyncio.wait_for(work, PATIENCE))

    async def _connect(self, told: Path) -> WebSocketClientConnection:
        while not told.is_file() or len(told.read_text().split()) < 2:
            assert self._process.poll() is None, "Chromium did not start."
            await asyncio.sleep(0.02)
        port, path = told.read_text().split()[:2]
        address = f"ws://127.0.0.1:{port}{path}"
        connection = await websocket_connect(address, max_message_size=LARGEST_MESSAGE)
        self._connection, self._session = connection, {}
        made = await self._call("Target.createTarget", {"url": "about:blank"})
        joined = await self._call("Target.attachToTarget", {"targetId": made["targetId"], "flatten": True})
        self._session = {"sessionId": joined["sessionId"]}
        return connection

    async def _call(self, method: str, parameters: dict[str, Any]) -> dict[str, Any]:
        number = next(self._numbers)
        asked = {"id": number, "method": method, "params": parameters, **self._session}
        await self._connection.write_message(json.dumps(asked))
        while True:
            text = await self._connection.read_message()
            assert text is not None, "Chromium ended."
            told = json.loads(text)
            if told.get("id") == number:
                assert "error" not in told, told
                return dict(told["result"])
            if "method" in told:
                self.events.append(told)
