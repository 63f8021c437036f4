#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A drive for Telekerf in one file: the other end of `--drive udp:HOST:PORT`.

The class Axes simulates three carriages, so that the file runs as it is. Put your encoders and amplifiers in
its place and keep the rest. The page add-a-drive.md explains every field.

    python3 docs/how-to/drive_example.py --port 7000
    build/bin/telekerf-slave --drive udp:127.0.0.1:7000
"""
import argparse
import math
import signal
import socket
import struct
import time

CURRENTS = struct.Struct("<IIQ3d")  # controller -> drive, 40 bytes
READING = struct.Struct("<IIQQq3d")  # drive -> controller, 56 bytes
CURRENTS_MAGIC = 0x43554B54
READING_MAGIC = 0x52554B54
LONGEST_PERIOD_NS = 100_000_000
WATCHDOG_S = 0.020  # no currents for this long: the motors are switched off
CONTROLLER_GONE_S = 0.5  # silence after which another controller may take over


class Axes:
    """Three carriages on their rails, each for itself. Positions in metres, currents in amperes."""

    MASS_KG = 0.11
    FORCE_N_PER_A = 6.43
    FRICTION_N_S_PER_M = 0.3

    def __init__(self, joints_m):
        self.joints_m = list(joints_m)
        self.speeds_m_per_s = [0.0] * 3
        self.currents_a = [0.0] * 3
        self.at_s = time.monotonic()

    def set_currents(self, currents_a):
        """Held until the next call."""
        self._move()
        self.currents_a = list(currents_a)

    def positions(self):
        """All three at one instant; None while they are not known (before homing)."""
        self._move()
        return self.joints_m

    def _move(self):
        now_s = time.monotonic()
        dt, self.at_s = now_s - self.at_s, now_s
        for i, current_a in enumerate(self.currents_a):
            force_n = self.FORCE_N_PER_A * current_a - self.FRICTION_N_S_PER_M * self.speeds_m_per_s[i]
            acceleration = force_n / self.MASS_KG
            self.joints_m[i] += dt * self.speeds_m_per_s[i] + 0.5 * dt * dt * acceleration
            self.speeds_m_per_s[i] += dt * acceleration


class Drive:
    """Obeys one controller, answers each of its datagrams, and switches off when it falls silent."""

    def __init__(self, axes, max_current_a):
        self.axes = axes
        self.max_current_a = max_current_a
        self.controller = None
        self.newest = 0  # sequence of the newest currents obeyed
        self.heard_s = -math.inf
        self.tick = 0  # readings taken
        self.live = False

    def hear(self, datagram, sender):
        """The answer to send back, or None."""
        if len(datagram) != CURRENTS.size:
            return None
        magic, period_ns, sequence, *currents_a = CURRENTS.unpack(datagram)
        if magic != CURRENTS_MAGIC or not 0 < period_ns <= LONGEST_PERIOD_NS:
            return None
        if not all(math.isfinite(current) for current in currents_a):
            return None
        now_s = time.monotonic()
        if sender != self.controller:
            if now_s - self.heard_s < CONTROLLER_GONE_S:
                return None  # one controller at a time
            self.controller, self.newest = sender, 0
        if sequence <= self.newest:
            return None  # overtaken on the way
        self.newest, self.heard_s, self.live = sequence, now_s, True
        self.axes.set_currents(max(-self.max_current_a, min(c, self.max_current_a)) for c in currents_a)
        joints_m = self.axes.positions()
        if joints_m is not None:
            self.tick += 1
        return READING.pack(READING_MAGIC, 0 if joints_m is None else 1, sequence, self.tick,
                            time.monotonic_ns(), *(joints_m or (0.0, 0.0, 0.0)))

    def watch(self):
        """Call every few milliseconds. True: the motors were switched off just now."""
        if not self.live or time.monotonic() - self.heard_s < WATCHDOG_S:
            return False
        self.switch_off()
        return True

    def switch_off(self):
        self.live = False
        self.axes.set_currents([0.0] * 3)


def main():
    parser = argparse.ArgumentParser(description="a drive for --drive udp:HOST:PORT")
    parser.add_argument("--address", default="127.0.0.1", help="of this host, where currents arrive")
    parser.add_argument("--port", type=int, default=7000, help="0: any free one")
    parser.add_argument("--joints-m", type=float, nargs=3, default=[0.02] * 3, help="where the carriages stand")
    parser.add_argument("--max-current-a", type=float, default=1.6, help="never exceeded")
    flags = parser.parse_args()
    for ending in (signal.SIGINT, signal.SIGTERM):
        signal.signal(ending, signal.default_int_handler)

    drive = Drive(Axes(flags.joints_m), flags.max_current_a)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as link:
        link.bind((flags.address, flags.port))
        link.settimeout(0.002)
        print(f"drive: udp:{flags.address}:{link.getsockname()[1]}", flush=True)
        try:
            while True:
                try:
                    datagram, sender = link.recvfrom(2048)
                    answer = drive.hear(datagram, sender)
                    if answer is not None:
                        link.sendto(answer, sender)
                except TimeoutError:
                    pass
                if drive.watch():
                    print("drive: no currents, motors off", flush=True)
        except KeyboardInterrupt:
            print(f"drive: {drive.tick} steps", flush=True)
        finally:
            drive.switch_off()


if __name__ == "__main__":
    main()
