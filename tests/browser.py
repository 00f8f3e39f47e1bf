"""Chromium without a screen, asked by a script in a page: what it says comes back as JSON."""

import json
import shutil
import subprocess
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, HTTPServer
from pathlib import Path
from queue import Queue
from typing import Any

import pytest

PATIENCE = 60


def ask(page: Path, script: str, profile: Path, size: tuple[int, int] = (1280, 900)) -> Any:
    """What `script`, an async function's body, returns in a page; skips without a browser."""
    browser = shutil.which("chromium") or shutil.which("chromium-browser")
    if browser is None:
        pytest.skip("no chromium; `make test` installs it")
    with _listening() as (port, answers):
        asking = page.with_name(f"asked-{page.name}")
        asking.write_text(page.read_text(encoding="utf-8") + _ASK % (script, port))
        process = subprocess.Popen(
            [browser, "--headless", "--no-sandbox", "--disable-gpu", "--no-first-run",
             "--disable-background-networking", "--disable-component-update", "--disable-sync",
             "--remote-debugging-port=0", f"--user-data-dir={profile}",
             f"--window-size={size[0]},{size[1]}", asking.as_uri()],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip
        try:
            told = json.loads(answers.get(timeout=PATIENCE))
        finally:
            process.terminate()
            process.wait()
    assert "fault" not in told, told
    return told["found"]


_ASK = """<script>
addEventListener("load", async () => {
  let told;
  try { told = { found: await (async () => { %s })() }; }
  catch (error) { told = { fault: String(error) }; }
  fetch("http://127.0.0.1:%d/", { method: "POST", mode: "no-cors", body: JSON.stringify(told) });
});
</script>"""


@contextmanager
def _listening() -> Iterator[tuple[int, Queue[bytes]]]:
    """A port of this machine, and what is posted to it."""
    answers: Queue[bytes] = Queue()

    class Listener(BaseHTTPRequestHandler):
        def do_POST(self) -> None:
            answers.put(self.rfile.read(int(self.headers["Content-Length"])))
            self.send_response(204)
            self.end_headers()

        def log_message(self, *_: object) -> None:
            pass

    server = HTTPServer(("127.0.0.1", 0), Listener)
    thread = threading.Thread(target=server.serve_forever, daemon=True)
    thread.start()
    try:
        yield server.server_port, answers
    finally:
        server.shutdown()
        server.server_close()
        thread.join()
