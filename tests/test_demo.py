"""The main job whole, on a machine that can fetch nothing: generated motion, so labelled."""

import html
import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from study.screen.priority import may_have_priority

ROOT = Path(__file__).resolve().parents[1]


@pytest.fixture(scope="module")
def demo(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, subprocess.CompletedProcess[str]]:
    out = tmp_path_factory.mktemp("demo")
    environment = {
        **{key: value for key, value in os.environ.items() if key != "SEGUE_MOTIONS"},
        "XDG_DATA_HOME": str(out / "home"),
        "PIP_NO_INDEX": "1",
        "PIP_FIND_LINKS": str(out / "nothing"),
    }
    done = subprocess.run(
        [sys.executable, "-m", "study.cli", "demo", "--out", str(out / "demo")],
        cwd=ROOT, env=environment, capture_output=True, text=True, timeout=400,
    )  # fmt: skip
    return out / "demo", done


def test_the_demo_ends_with_a_report(demo) -> None:
    out, done = demo
    assert done.returncode == 0, done.stderr
    page = Path(done.stdout.strip().removeprefix("report: "))
    assert page == out / "data/derivatives/segue/report.html"
    document = json.loads(page.with_suffix(".json").read_text())
    studies = {study["protocol"]: study for study in document["studies"]}
    assert studies["jnd-center"]["participants"] == 12
    sides = {
        entry["side"]
        for entry in studies["jnd-center"]["psychometric"]
        if entry["participant"] == entry["motion"] == "all"
    }
    assert sides == {"shorter", "longer"}


def test_what_is_generated_says_so(demo) -> None:
    out, done = demo
    assert "cannot be fetched" in done.stderr
    assert "GENERATED" in done.stderr
    manifest = json.loads((out / "stimuli/jnd-center-rehearsal/manifest.json").read_text())
    assert all("generated-walker" in p["from"]["clip"] for p in manifest["pairings"].values())


def test_the_rehearsal_was_a_session_in_the_real_window(demo) -> None:
    out, _ = demo
    sidecar = next((out / "data").glob("sub-rehearsal1/beh/*_beh.json"))
    facts = json.loads(sidecar.read_text())
    assert facts["Rehearsal"]
    assert facts["Finished"]
    assert facts["Display"]["kind"] == "psychopy"
    assert facts["Display"]["keyboard"] == ("ptb" if may_have_priority() else "x-server")
    assert list((out / "data/sourcedata").rglob("*_flips.tsv"))


MEASURE = """<script>
const figures = [...document.querySelectorAll("svg")];
const clipped = [...document.querySelectorAll("svg text")].filter(text => {
  const box = text.getBoundingClientRect();
  const frame = text.ownerSVGElement.getBoundingClientRect();
  return box.left < frame.left - 1 || box.right > frame.right + 1;
}).map(text => text.textContent);
document.title = JSON.stringify({
  overflow: document.documentElement.scrollWidth - window.innerWidth,
  figures: figures.length,
  empty: figures.filter(figure => figure.getBoundingClientRect().height < 50).length,
  remote: performance.getEntriesByType("resource").map(entry => entry.name),
  clipped,
});
</script>"""


@pytest.mark.parametrize("width", [1000, 600])
def test_the_report_reads_well_in_a_browser(demo, tmp_path: Path, width: int) -> None:
    browser = shutil.which("chromium") or shutil.which("chromium-browser")
    if browser is None:
        pytest.skip("no chromium; `make test` installs it")
    out, _ = demo
    page = tmp_path / "page.html"
    page.write_text((out / "data/derivatives/segue/report.html").read_text() + MEASURE)
    done = subprocess.run(
        [browser, "--headless", "--no-sandbox", "--disable-gpu", "--no-first-run",
         "--disable-background-networking", "--disable-component-update", "--disable-sync",
         f"--user-data-dir={tmp_path / 'profile'}", f"--window-size={width},1200", "--dump-dom",
         page.as_uri()],
        capture_output=True, text=True, timeout=120,
    )  # fmt: skip
    title = re.search(r"<title>(\{.*?\})</title>", done.stdout, re.DOTALL)
    assert title is not None, done.stderr
    found = json.loads(html.unescape(title[1]))
    assert found["figures"] >= 3
    assert found["empty"] == 0
    assert found["overflow"] <= 0
    assert found["remote"] == []
    assert found["clipped"] == []
