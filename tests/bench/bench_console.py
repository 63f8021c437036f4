# SPDX-License-Identifier: Apache-2.0
"""Latency and cost of the operator's console, with real programs and a real browser without a GPU on this host.

bench_console.py PROGRAMS: a whole cell across thesis-constant, the hand by the page. All stamps are of one clock.
Last, what ten watchers cost the control loops: cells with and without them in turns, the hand simulated, each read by
a program that draws nothing.
Exit code 1: a hold outlived its lease by more than the bound, samples were lost, or what was said before a stall was
done after it; latencies and slack are only printed."""
import base64
import json
import os
import select
import socket
import statistics
import sys
import tempfile
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "browser"))
from cell import Cell, Page  # noqa: E402

kFreezes, kReleases, kRestarts = 50, 100, 5
kStalls, kStall_s, kOldest_ms = 3, 2.0, 150.0
kTurns, kTurn_s, kWatchers = 5, 8.0, 10
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
    """Core shares of the server and of the whole process, bytes a second and client; over five seconds."""
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
    cpu_s = lambda: (cell.cpu_s("console"), cell.cpu_s("console", first_thread=True))  # noqa: E731
    before, begun = cpu_s(), time.monotonic()
    time.sleep(5)
    all_s, server_s = ((b - a) / (time.monotonic() - begun) for a, b in zip(before, cpu_s()))
    sizes = page.js("return telekerf.watchers.map((s) => s.bytes)")
    page.js("for (const socket of telekerf.watchers) socket.close(); telekerf.watchers = []")
    each = f", {sum(sizes) / len(sizes) / 5e3:.1f} kB/s each" if sizes else ""
    print(f"  console, one page and {watchers} watchers: {100 * server_s:.1f} % of a core, {100 * all_s:.1f} % with "
          f"the bus's threads{each}", flush=True)


def stalled(cell, page):
    """Frames older than the age gate that the console passes on after it stood still: there must be none."""
    place = page.tool()
    page.press(place)
    cell.line.wait(held=True)
    page.js("telekerf.sent = []; telekerf.frame ??= telekerf.link.frame.bind(telekerf.link); "
            "telekerf.link.frame = (flags, number, ms, ...rest) => { telekerf.sent.push([number, performance.now()]); "
            "telekerf.frame(flags, number, ms, ...rest); }")
    time.sleep(0.3)
    before = len(cell.line.passed)
    cell.stall("console", kStall_s)
    over_ms = page.js("return performance.now()")
    time.sleep(0.5)
    sent = dict(page.js("return telekerf.sent"))
    page.let_go(place)
    ages_ms = [over_ms - sent[number] for number in cell.line.passed[before:] if number in sent]
    return sum(kOldest_ms + 50 < age < kStall_s * 1e3 - 50 for age in ages_ms), len(sent)


class Watchers:
    """Pages that read everything and draw nothing."""

    def __init__(self, port, count):
        self.sockets = []
        self.next_pong = 0.0
        for _ in range(count):
            s = socket.create_connection(("127.0.0.1", port))
            key = base64.b64encode(os.urandom(16)).decode()
            s.sendall((f"GET /ws HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                       f"Sec-WebSocket-Key: {key}\r\nSec-WebSocket-Version: 13\r\n\r\n").encode())
            self.sockets.append(s)

    def read(self, for_s):
        until, size = time.monotonic() + for_s, 0
        while (left := until - time.monotonic()) > 0:
            if not self.sockets:
                time.sleep(left)
                continue
            for s in select.select(self.sockets, [], [], left)[0]:
                got = len(s.recv(65536))
                assert got, "the console has let go of a watcher"
                size += got
            if time.monotonic() >= self.next_pong:
                self.next_pong = time.monotonic() + 1
                for s in self.sockets:
                    s.sendall(b"\x8a\x80\0\0\0\0")  # who answers no ping is let go of
            time.sleep(0.02)
        return size / for_s / 1e3 / max(1, len(self.sockets))

    def close(self):
        for s in self.sockets:
            s.close()


def turn(watchers, number):
    """Overruns and slack of both loops in one cell, and kB/s of each watcher."""
    folder = tempfile.mkdtemp(prefix=f"telekerf-bench-{os.getpid()}-")
    cell = Cell(sys.argv[1], folder, 1 + (os.getpid() + number) % 100, hand=False, record=True)
    try:
        until = time.monotonic() + 20
        while "http://" not in open(os.path.join(folder, "console.log")).read():
            assert time.monotonic() < until, "the console does not come up"
            time.sleep(0.05)
        time.sleep(2)
        pages = Watchers(cell.port, watchers)
        each = pages.read(kTurn_s)
        for name in ("master", "slave"):
            cell.end(name)
        pages.close()
    finally:
        cell.close()
    return [json.load(open(os.path.join(folder, name, f"{name}.json")))["figures"] for name in ("master", "slave")], each


def watched():
    """Cells with and without watchers in turns; the first is not counted."""
    turn(0, 0)
    slack = {(name, watchers): [] for name in ("master", "slave") for watchers in (0, kWatchers)}
    overruns = dict.fromkeys(slack, 0)
    each = 0.0
    for number in range(2 * kTurns):
        watchers = kWatchers if number % 2 else 0
        both, size = turn(watchers, number + 1)
        each = max(each, size)
        for name, figures in zip(("master", "slave"), both):
            slack[name, watchers].append(figures["slack_p99_us"])
            overruns[name, watchers] += int(figures["overruns"])
    for name in ("master", "slave"):
        without, with_them = (statistics.median(slack[name, watchers]) for watchers in (0, kWatchers))
        print(f"  {name}, {kTurns} runs each: slack p99 {without:.0f} us (of its runs {min(slack[name, 0]):.0f} to "
              f"{max(slack[name, 0]):.0f}), with {kWatchers} watchers {with_them:.0f} us "
              f"({min(slack[name, kWatchers]):.0f} to {max(slack[name, kWatchers]):.0f}): "
              f"{100 * (with_them / without - 1):+.1f} %  bar: within 5", flush=True)
        print(f"  {name}, overruns: {overruns[name, 0]} without, {overruns[name, kWatchers]} with {kWatchers} watchers  "
              "bar: none more", flush=True)
    print(f"  a watcher gets at most {each:.1f} kB/s  bar: 25", flush=True)


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

    late, sent = 0, 0
    for _ in range(kStalls):
        more = stalled(cell, page)
        late, sent = late + more[0], sent + more[1]
        page.js("telekerf.hand.lease || document.getElementById('take').click()")  # absent for too long
        page.until("telekerf.hand.lease")
        time.sleep(0.5)
    print(f"  of {sent} frames around {kStalls} stalls of {kStall_s:.0f} s, older than {kOldest_ms:.0f} ms and passed on: {late}  bar: 0")
    good = good and late == 0

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
watched()
sys.exit(0 if good else 1)
