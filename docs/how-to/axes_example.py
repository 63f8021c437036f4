#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The axes of an imaging unit in one file: the other end of `--imaging udp:HOST:PORT`.

The class Axis simulates a motor on a screw, so that the file runs as it is. Put your encoders, switches and
amplifiers in its place and keep the rest. The page imaging-unit.md explains every field.

    python3 docs/how-to/axes_example.py --port 7100
    build/bin/telekerf-vision --imaging udp:127.0.0.1:7100 --camera 0
"""
import argparse
import math
import signal
import socket
import struct
import time

CURRENTS = struct.Struct("<IIQ2d")  # Telekerf -> axes, 32 bytes
READING = struct.Struct("<IIQQ2d2I")  # axes -> Telekerf, 48 bytes
CURRENTS_MAGIC = 0x43494B54
READING_MAGIC = 0x52494B54
WATCHDOG_S = 0.020  # no currents for this long: the motors are switched off


class Axis:
    """A motor that moves a mass along a screw, with friction. Metres from the lower switch."""

    def __init__(self, mass_kg, force_n_per_a, dry_n, damping_n_s_per_m, travel_m, start_m):
        self.mass_kg, self.force_n_per_a = mass_kg, force_n_per_a
        self.dry_n, self.damping_n_s_per_m = dry_n, damping_n_s_per_m
        self.travel_m, self.zero_m = travel_m, start_m
        self.position_m, self.speed_m_per_s, self.current_a = start_m, 0.0, 0.0

    def move(self, dt):
        free = self.speed_m_per_s + dt * self.force_n_per_a * self.current_a / self.mass_kg
        dry = dt * self.dry_n / self.mass_kg  # friction stops the axis, it never turns it round
        rest = math.copysign(max(0.0, abs(free) - dry), free)
        self.speed_m_per_s = rest / (1.0 + dt * self.damping_n_s_per_m / self.mass_kg)
        wanted_m = self.position_m + dt * self.speed_m_per_s
        self.position_m = min(max(wanted_m, -0.0004), self.travel_m)
        if wanted_m != self.position_m:
            self.speed_m_per_s = 0.0

    def encoder_m(self):
        return round((self.position_m - self.zero_m) / 0.5e-6) * 0.5e-6

    def at_lower_end(self):
        return self.position_m <= 0.0


class Unit:
    """Obeys the newest currents, answers each datagram, and switches off when nothing comes."""

    def __init__(self, axes):
        self.axes = axes
        self.newest, self.tick, self.heard_s = 0, 0, -math.inf
        self.moved_s = time.monotonic()

    def advance(self):
        now_s = time.monotonic()
        while self.moved_s < now_s:
            dt = min(0.00025, now_s - self.moved_s)
            self.moved_s += dt
            for axis in self.axes:
                axis.move(dt)

    def hear(self, datagram):
        """The answer to send back, or None."""
        if len(datagram) != CURRENTS.size:
            return None
        magic, _, sequence, *currents_a = CURRENTS.unpack(datagram)
        if magic != CURRENTS_MAGIC or not all(math.isfinite(current) for current in currents_a):
            return None
        now_s = time.monotonic()
        if now_s - self.heard_s > 0.5:
            self.newest = 0  # a new controller begins anew
        if sequence <= self.newest:
            return None  # overtaken on the way
        self.newest, self.heard_s = sequence, now_s
        self.advance()
        for axis, current_a in zip(self.axes, currents_a):
            axis.current_a = max(-2.0, min(current_a, 2.0))
        self.tick += 1
        return READING.pack(READING_MAGIC, 1, sequence, self.tick, *(axis.encoder_m() for axis in self.axes),
                            *(int(axis.at_lower_end()) for axis in self.axes))

    def watch(self):
        if time.monotonic() - self.heard_s > WATCHDOG_S:
            self.advance()
            for axis in self.axes:
                axis.current_a = 0.0


def main():
    parser = argparse.ArgumentParser(description="axes for --imaging udp:HOST:PORT")
    parser.add_argument("--address", default="127.0.0.1", help="of this host, where currents arrive")
    parser.add_argument("--port", type=int, default=7100, help="0: any free one")
    flags = parser.parse_args()
    for ending in (signal.SIGINT, signal.SIGTERM):
        signal.signal(ending, signal.default_int_handler)
    unit = Unit([Axis(4.0, 40.0, 12.0, 60.0, 0.08, 0.010), Axis(2.0, 20.0, 3.0, 30.0, 0.03, 0.008)])
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as link:
        link.bind((flags.address, flags.port))
        link.settimeout(0.005)
        print(f"axes: udp:{flags.address}:{link.getsockname()[1]}", flush=True)
        try:
            while True:
                try:
                    datagram, sender = link.recvfrom(2048)
                    answer = unit.hear(datagram)
                    if answer is not None:
                        link.sendto(answer, sender)
                except TimeoutError:
                    pass
                unit.watch()
        except KeyboardInterrupt:
            print(f"axes: {unit.tick} steps", flush=True)


if __name__ == "__main__":
    main()
