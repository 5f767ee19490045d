"""A web server on the loopback that hands the page its files and tasks, and takes its answers."""

import contextlib
import json
import queue
import threading
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

from pagecamera import SPLATS_ADDRESS

KINDS = {".html": "text/html", ".js": "text/javascript", ".ply": "application/octet-stream"}
ISOLATION = {"Cross-Origin-Opener-Policy": "same-origin", "Cross-Origin-Embedder-Policy": "require-corp"}
"""With these a page may share memory with its sorters, and its clock ticks in microseconds."""
WAIT = 10.0
"""Seconds that a page waits for a task before it asks again."""
LARGEST_ANSWER = 1 << 28


class PageServer:
    """One page's server, in threads of its own until ``close``. ``address`` is where the page is."""

    def __init__(self, page: Path, packages: Path, splats: Path, settings: dict[str, Any]) -> None:
        self.tasks: queue.Queue[dict[str, Any] | None] = queue.Queue()
        self.answers: queue.Queue[dict[str, Any]] = queue.Queue()
        self._folders = {"page": page.resolve(), "packages": packages.resolve()}
        self._splats = splats
        self._settings = json.dumps(settings).encode()
        self._server = ThreadingHTTPServer(("127.0.0.1", 0), self._handler())
        self._server.daemon_threads = True
        threading.Thread(target=self._server.serve_forever, name="page server", daemon=True).start()
        self.address = f"http://127.0.0.1:{self._server.server_port}/page/index.html"

    def close(self) -> None:
        """Tell the page that it is over, and stop."""
        self.tasks.put(None)
        self._server.shutdown()
        self._server.server_close()

    def found(self, address: str) -> tuple[str, bytes] | None:
        """Media type and bytes of what may be served, else None."""
        if address == "/settings.json":
            return "application/json", self._settings
        if address == SPLATS_ADDRESS:
            return KINDS[".ply"], self._splats.read_bytes()
        _, _, rest = address.partition("/")
        top, _, inside = rest.partition("/")
        folder = self._folders.get(top)
        if folder is None or not inside:
            return None
        file = (folder / inside).resolve()
        if file.is_relative_to(folder) and file.suffix in KINDS and file.is_file():
            return KINDS[file.suffix], file.read_bytes()
        return None

    def next_answer(self, seconds: float) -> dict[str, Any]:
        """What the page found for the oldest task that was not answered; raises queue.Empty when it takes longer."""
        return self.answers.get(timeout=seconds)

    def next_task(self) -> tuple[HTTPStatus, bytes]:
        """The next task as JSON; NO_CONTENT when there is none yet, GONE at the end."""
        try:
            task = self.tasks.get(timeout=WAIT)
        except queue.Empty:
            return HTTPStatus.NO_CONTENT, b""
        return (HTTPStatus.GONE, b"") if task is None else (HTTPStatus.OK, json.dumps(task).encode())

    def _handler(self) -> type[BaseHTTPRequestHandler]:
        server = self

        class Handler(BaseHTTPRequestHandler):
            protocol_version = "HTTP/1.1"

            def do_GET(self) -> None:
                address = self.path.partition("?")[0]
                if address == "/task":
                    self._send(*server.next_task(), "application/json")
                elif (found := server.found(address)) is not None:
                    self._send(HTTPStatus.OK, found[1], found[0])
                else:
                    self._send(HTTPStatus.NOT_FOUND, b"", "text/plain")

            def do_POST(self) -> None:
                length = int(self.headers.get("Content-Length", 0))
                if self.path != "/answer" or not 0 < length <= LARGEST_ANSWER:
                    self._send(HTTPStatus.BAD_REQUEST, b"", "text/plain")
                    return
                body = self.rfile.read(length)
                is_json = self.headers.get("Content-Type") == "application/json"
                server.answers.put(json.loads(body) if is_json else {"pixels": body})
                self._send(HTTPStatus.NO_CONTENT, b"", "text/plain")

            def _send(self, status: HTTPStatus, body: bytes, kind: str) -> None:
                self.send_response(status)
                self.send_header("Content-Type", kind)
                if status is not HTTPStatus.NO_CONTENT:
                    self.send_header("Content-Length", str(len(body)))
                self.send_header("Cache-Control", "no-store")
                for name, value in ISOLATION.items():
                    self.send_header(name, value)
                with contextlib.suppress(ConnectionError):  # a browser that is gone needs no answer
                    self.end_headers()
                    self.wfile.write(body)

            def log_message(self, format: str, *args: Any) -> None:
                """Nothing: the bench prints a table, not requests."""

        return Handler
