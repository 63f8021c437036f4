# SPDX-License-Identifier: Apache-2.0
"""Latency and cost of the operator's console, with real programs and a real browser without a GPU on this host.

bench_console.py PROGRAMS: a whole cell across thesis-constant, the hand by the page. All stamps are of one clock.
Exit code 1: a hold outlived its lease by more than the bound, or samples were lost; latencies are only printed."""
import os
import sys
import tempfile
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "browser"))
from cell import Cell, Page  # noqa: E402

kFreezes, kReleases, kRestarts = 50, 100, 5
kLongest_ms = 120.0


def quantiles(name, numbers, bar="", unit="ms"):
    numbers = sorted(numbers)
    if not numbers:
        print(f"  {name:<44} nothing was measured")
        return
    at = lambda share: numbers[min(len(numbers) - 1, int(share * len(numbers)))]  # noqa: E731
    print(f"  {name:<44} p50 {at(0.5):6.1f}  p99 {at(0.99):6.1f}  max {numbers[-1]:6.1f} {unit}  "
          f"({len(numbers)}){'  bar: ' + bar if bar else ''}", flush=True)


def load(cell, page, watchers):
    """Core share of the console and bytes a second and client, over five seconds."""
    page.js("""
        const all = telekerf.watchers ?? (telekerf.watchers = []);
        while (all.length < arguments[0]) {
          const socket = new WebSocket(`ws://${location.host}/ws`);
          socket.binaryType = "arraybuffer";
          socket.bytes = 0;
          socket.onmessage = (e) => { socket.bytes += e.data.byteLength ?? e.data.length; };
          all.push(socket);
        }""", watchers)
    time.sleep(1.5)
    page.js("for (const socket of telekerf.watchers) socket.bytes = 0")
    cpu_s, begun = cell.cpu_s("console"), time.monotonic()
    time.sleep(5)
    share = 100 * (cell.cpu_s("console") - cpu_s) / (time.monotonic() - begun)
    sizes = page.js("return telekerf.watchers.map((s) => s.bytes)")
    page.js("for (const socket of telekerf.watchers) socket.close(); telekerf.watchers = []")
    each = f", {sum(sizes) / len(sizes) / 5e3:.1f} kB/s each" if sizes else ""
    print(f"  console, one page and {watchers} watchers: {share:.1f} % of a core{each}", flush=True)


good = True
cell = Cell(sys.argv[1], tempfile.mkdtemp(prefix=f"telekerf-bench-{os.getpid()}-"), 1 + os.getpid() % 100)
page = None
try:
    page = Page(cell.port)
    paint = page.js("return performance.getEntriesByType('paint').map((e) => e.startTime)")
    page.until("telekerf.words.sentence?.startsWith('You may move')")
    print(f"  first paint {min(paint) if paint else float('nan'):.0f} ms  bar: 300")
    page.click("take")
    page.until("telekerf.hand.lease")
    page.click("engage")
    page.until("telekerf.words.sentence.includes('the slave follows')")
    time.sleep(1)

    places = page.along(250, 0.1e-3)
    page.press(places[0])
    for place in places:
        page.move(place)
        time.sleep(0.004)
    page.let_go(places[-1])
    figures = page.js("return telekerf.figures()")
    quantiles("event to drawn answer of the master", figures["drawn_ms"], "16 / 40")
    quantiles("page to console and back", figures["trip_ms"])
    quantiles("console to the master's control step", figures["step_ms"])
    frames = figures["frame_ms"][60:]
    print(f"  frames a second{'':<30} {1000 * len(frames) / sum(frames):.1f}  bar: 59")
    quantiles("script a frame", figures["script_ms"], "- / 4")

    released = []
    for _ in range(kReleases):
        place = page.tool()
        page.press(place)
        cell.line.wait(held=True)
        cell.line.release_ms = None
        page.let_go(place)
        cell.line.wait(held=False)
        released.append(cell.line.release_ms)
    half = sorted(figures["trip_ms"])[len(figures["trip_ms"]) // 2] / 2
    quantiles(f"release to the master's step, {half:.1f} ms to console incl.", [ms + half for ms in released], "6 / 20")

    frozen = []
    for _ in range(kFreezes):
        place = page.tool()
        page.press(place)
        cell.line.wait(held=True)
        cell.line.release_ms = None
        page.js("const until = performance.now() + 250; while (performance.now() < until);")
        page.let_go(place)
        if cell.line.release_ms is not None:
            frozen.append(cell.line.release_ms)
        time.sleep(0.05)
    quantiles("page frozen: last frame to the step without", frozen, f"{kLongest_ms:.0f}, all")
    within = sum(ms <= kLongest_ms for ms in frozen)
    print(f"  released within {kLongest_ms:.0f} ms: {within} of {kFreezes}")
    good = good and within == kFreezes

    before = cell.line.frames, page.js("return telekerf.hand.sequence")
    page.js("telekerf.pen = setInterval(() => telekerf.hand.send(), 4)")
    time.sleep(8)
    page.js("clearInterval(telekerf.pen)")
    time.sleep(0.2)
    sent = page.js("return telekerf.hand.sequence") - before[1]
    came = cell.line.frames - before[0]
    print(f"  a pen's {sent / 8:.0f} samples a second: {100 * min(came, sent) / sent:.2f} % reach the master  bar: 99.9")
    good = good and came >= 0.999 * sent

    for watchers in (0, 1, 10):
        load(cell, page, watchers)

    back = []
    for _ in range(kRestarts):
        cell.end("console")
        page.until("document.body.classList.contains('stale')", 3)
        cell.start_console()
        begun = time.monotonic()
        while "http://" not in open(os.path.join(cell.folder, "console.log")).read().split("ended in order")[-1]:
            assert time.monotonic() - begun < 10, "the console does not come up"
            time.sleep(0.005)
        back.append(1e3 * page.until("document.body.classList.contains('live')", 10))
    quantiles("console up again to live picture", back, "- / 1000")
finally:
    if page:
        page.close()
    cell.close()
sys.exit(0 if good else 1)
