# SPDX-License-Identifier: Apache-2.0
"""A whole cell of real programs with a page in a real browser, and the hand's line between console and master in
between, where frames and answers are seen with both sides' own stamps (one clock: all run on this host)."""
import os
import select
import signal
import socket
import struct
import subprocess
import threading
import time

FRAME = struct.Struct("<IIIIQqdd")  # master/operator/udp_hand.h
ANSWER = struct.Struct("<IIIIQqdddd")
HELD = 1

begun = time.monotonic()


def said(text):
    print(f"{time.monotonic() - begun:5.1f} s  {text}", flush=True)


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class HandLine:
    """Passes datagrams on and remembers what matters: when the last held frame was sent, when a hold ended."""

    def __init__(self, master):
        self.front = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.front.bind(("127.0.0.1", 0))
        self.port = self.front.getsockname()[1]
        self.back = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.back.connect(("127.0.0.1", master))
        self.frames = 0
        self.held = False           # in the master's newest answer
        self.last_held_ns = 0       # console's stamp of the newest held frame
        self.first_free_ns = None   # of the first released frame after it
        self.held_frames = 0
        self.passed = []            # number of each frame in its lease
        self.release_ms = None      # of the last hold: from its last frame, or from the first that let go, to the
                                    # master's step without a hand
        self.console = None
        self.over = False
        self.thread = threading.Thread(target=self._run, daemon=True)
        self.thread.start()

    def _run(self):
        while not self.over:
            for end in select.select([self.front, self.back], [], [], 0.1)[0]:
                try:
                    if end is self.front:
                        data, self.console = end.recvfrom(256)
                        self._frame(data)
                        self.back.send(data)
                    else:
                        data = end.recv(256)
                        self._answer(data)
                        if self.console:
                            self.front.sendto(data, self.console)
                except ConnectionRefusedError:
                    pass  # the master does not listen (any more)

    def _frame(self, data):
        _, _, _, flags, number, sent_ns, _, _ = FRAME.unpack(data)
        self.frames += 1
        self.passed.append(number)
        if flags & HELD:
            self.last_held_ns, self.first_free_ns = sent_ns, None
            self.held_frames += 1
        elif self.first_free_ns is None:
            self.first_free_ns = sent_ns

    def _answer(self, data):
        _, _, _, flags, _, step_ns, *_ = ANSWER.unpack(data)
        held = bool(flags & HELD)
        if self.held and not held:
            last_ns = self.last_held_ns if self.first_free_ns is None else self.first_free_ns
            self.release_ms = (step_ns - last_ns) * 1e-6
        self.held = held

    def becomes(self, held, timeout_s=10.0):
        until = time.monotonic() + timeout_s
        while self.held != held and time.monotonic() < until:
            time.sleep(0.002)
        return self.held == held

    def wait(self, held):
        assert self.becomes(held), f"the master's hand is {'not ' if held else ''}held"


class Cell:
    """`record`: master and slave leave their figures in `folder`/master and /slave when they end."""

    def __init__(self, programs, folder, domain, netem="thesis-constant", hand=True, image="heart", record=False):
        self.programs, self.folder = programs, folder
        os.makedirs(folder, exist_ok=True)
        self.bus = ["--domain", str(domain), "--cell", "cell-1", "--netem", netem]
        self.port = free_port()
        self.running = {}
        hand_port = free_port()
        self.line = HandLine(hand_port)
        self.start("vision", "--image", image)
        kept = lambda name: ["--record", os.path.join(folder, name)] if record else []  # noqa: E731
        self.start("slave", "--stop-file", "off", *kept("slave"))
        self.start("master", "--stop-file", "off", *kept("master"),
                   *(["--hand", f"browser:127.0.0.1:{hand_port}"] if hand else ["--engage"]))
        self.start_console()

    def start(self, name, *words):
        log = open(os.path.join(self.folder, f"{name}.log"), "a")
        self.running[name] = subprocess.Popen([os.path.join(self.programs, f"telekerf-{name}"), *self.bus, *words],
                                              stdout=log, stderr=subprocess.STDOUT)

    def start_console(self):
        self.start("console", "--port", str(self.port), "--hand", f"127.0.0.1:{self.line.port}",
                   "--cut-file", os.path.join(self.folder, "console.cut"))

    def end(self, name):
        program = self.running.pop(name)
        program.terminate()
        try:
            return program.wait(10)
        except subprocess.TimeoutExpired:
            program.kill()
            raise

    def stall(self, name, for_s):
        """It neither runs nor dies."""
        pid = self.running[name].pid
        os.kill(pid, signal.SIGSTOP)
        time.sleep(for_s)
        os.kill(pid, signal.SIGCONT)

    def close(self):
        self.line.over = True
        for name in list(self.running):
            self.end(name)

    def cpu_s(self, name, first_thread=False):
        """Processor time of a program, or of its first thread alone."""
        pid = self.running[name].pid
        place = f"/proc/{pid}/task/{pid}" if first_thread else f"/proc/{pid}"
        fields = open(f"{place}/stat").read().rsplit(")", 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


class Page:
    """One browser with the console's page."""

    def __init__(self, port, size=(1280, 800)):
        from selenium import webdriver
        from selenium.webdriver.chrome.service import Service

        options = webdriver.ChromeOptions()
        for word in ("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage",
                     f"--window-size={size[0]},{size[1]}", "--no-first-run"):
            options.add_argument(word)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
        self.driver = webdriver.Chrome(options=options, service=Service("/usr/bin/chromedriver"))
        self.driver.set_script_timeout(20)
        self.pid = self.driver.capabilities.get("goog:processID")
        self.size(*size)
        self.driver.get(f"http://127.0.0.1:{port}/")

    def size(self, width, height, ratio=1, mobile=False):
        """Of what is seen, without the browser's own bars."""
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                                    {"width": width, "height": height, "deviceScaleFactor": ratio, "mobile": mobile})

    def js(self, text, *words):
        return self.driver.execute_script(text, *words)

    def until(self, condition, timeout_s=20.0):
        begun = time.monotonic()
        while not self.js(f"return Boolean({condition})"):
            if time.monotonic() - begun > timeout_s:
                raise AssertionError(f"not within {timeout_s} s: {condition}\n"
                                     f"{self.js('return JSON.stringify([telekerf.words, telekerf.state])')}")
            time.sleep(0.02)
        return time.monotonic() - begun

    def click(self, name):
        self.js("document.getElementById(arguments[0]).click()", name)

    def choose(self, name, value):
        self.js("""
            const list = document.getElementById(arguments[0]);
            list.value = arguments[1];
            list.dispatchEvent(new Event("change"));""", name, value)

    def mouse(self, kind, place, pressed):
        self.driver.execute_cdp_cmd("Input.dispatchMouseEvent", {
            "type": kind, "x": place[0], "y": place[1], "button": "left", "buttons": 1 if pressed else 0,
            "clickCount": 1 if kind != "mouseMoved" else 0})

    def press(self, place):
        self.mouse("mouseMoved", place, False)
        self.mouse("mousePressed", place, True)

    def move(self, place):
        self.mouse("mouseMoved", place, True)

    def let_go(self, place):
        self.mouse("mouseReleased", place, False)

    def tool(self):
        return self.js("const t = telekerf.stage.toolWorld(), c = telekerf.stage.toClient(t.x, t.y); return [c.x, c.y]")

    def along(self, count, step_m=0.4e-3):
        """Places on the contour from the tool on, as the page's pixels."""
        return self.js("""
            const s = telekerf.stage, t = s.toolWorld(), p = s.contour.points, count = p.length / 2;
            let n = 0, best = Infinity;
            for (let k = 0; k < count; ++k) {
              const d = Math.hypot(p[2 * k] - t.x, p[2 * k + 1] - t.y);
              if (d < best) { best = d; n = k; }
            }
            const places = [];
            for (let gone = 0; places.length < arguments[0]; n = (n + 1) % count) {
              const m = (n + 1) % count;
              gone += Math.hypot(p[2 * m] - p[2 * n], p[2 * m + 1] - p[2 * n + 1]);
              if (gone < arguments[1]) continue;
              gone = 0;
              const c = s.toClient(p[2 * m], p[2 * m + 1]);
              places.push([c.x, c.y]);
            }
            return places;""", count, step_m)

    def beside(self, off_m):
        """A place off the line at the tool, at right angles to it, outwards."""
        return self.js("""
            const s = telekerf.stage, t = s.toolWorld(), p = s.contour.points, count = p.length / 2;
            let n = 0, best = Infinity;
            for (let k = 0; k < count; ++k) {
              const d = Math.hypot(p[2 * k] - t.x, p[2 * k + 1] - t.y);
              if (d < best) { best = d; n = k; }
            }
            const a = (n + count - 5) % count, b = (n + 5) % count;
            const dx = p[2 * b] - p[2 * a], dy = p[2 * b + 1] - p[2 * a + 1], l = Math.hypot(dx, dy);
            const c = s.toClient(t.x - dy / l * arguments[0], t.y + dx / l * arguments[0]);
            return [c.x, c.y];""", off_m)

    def watch_the_line(self):
        """From now on the page keeps the farthest that the tool was off the line (telekerf.farthest, metres)."""
        self.js("""
            telekerf.farthest = 0;
            const look = () => {
              const t = telekerf.stage.toolWorld();
              telekerf.farthest = Math.max(telekerf.farthest, telekerf.stage.nearest(t.x, t.y).distance_m);
              requestAnimationFrame(look);
            };
            look();""")

    def errors(self):
        return [entry["message"] for entry in self.driver.get_log("browser") if entry["level"] == "SEVERE"]

    def close(self):
        try:
            self.driver.quit()
        except Exception:  # noqa: BLE001 a browser that was killed cannot be quit
            pass
