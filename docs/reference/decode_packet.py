#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A decoder of SDCT packets, written from packet.md alone, to read beside it.

decode(bytes, anchor) returns the blocks, newest first: each a list of axes, each a list of N samples. `anchor`: for each
axis position and change a sample, as the message carries them (zeros for streams that have none).

    python3 docs/reference/decode_packet.py FILE

checks lines of "position, change a sample (three axes); packet (hex); the newest block's samples" and says how many hold.
An empty line begins another stream.
"""
import math
import struct
import sys

ANCHORED = ["curve", "line", "hold", "intra", "runs", "raw"]
FREE = ["intra", "curve", "line", "runs", "raw", "hold"]


class Bits:
    def __init__(self, data):
        self.data, self.at = data, 0

    def u(self, count):
        value = 0
        for _ in range(count):
            value = 2 * value + (self.data[self.at // 8] >> (7 - self.at % 8) & 1)
            self.at += 1
        return value

    def ue(self, order):
        zeros = 0
        while self.u(1) == 0:
            zeros += 1
        base = 1 << zeros | self.u(zeros)
        return (base - 1) << order | self.u(order)

    def se(self, order):
        return signed(self.ue(order))


def signed(code):
    return code >> 1 ^ -(code & 1)


def read_head(bits):
    head = {"version": bits.u(4), "codec": bits.u(4), "redundancy": bits.u(3), "anchored": bits.u(1),
            "adaptive": bits.u(1), "integrated": bits.u(1), "axes": bits.u(2), "n": bits.u(6) + 1, "zero": bits.u(1),
            "q": 2 ** ((bits.u(9) - 256) / 4), "period_ns": bits.u(32), "sequence": bits.u(16), "blocks": bits.u(3) + 1}
    head["count"] = bits.ue(2)
    head["step"] = bits.ue(2) if head["adaptive"] else 0
    head["level_order"] = bits.ue(3)
    head["value_order"] = bits.ue(2)
    if head["version"] != 3 or head["codec"] != 0:
        raise ValueError("no sdct packet of this version")
    octaves = (head["n"] - 1).bit_length()
    head["slope_q"] = head["q"] * 2.0 ** (2 - octaves)
    head["bend_q"] = head["q"] * 2.0 ** (3 - 2 * octaves)
    return head


def read_button(bits, n):
    """Bit i: held at sample i."""
    everything = (1 << n) - 1
    if bits.u(1) == 0:
        return everything if bits.u(1) else 0
    if bits.u(1):
        return bits.u(n)
    held_first = bits.u(1)
    before = (1 << bits.u(6)) - 1
    return before if held_first else everything & ~before


def read_mode(bits, head):
    """The mode, and whether its coefficients are a prefix."""
    modes = ANCHORED if head["anchored"] else FREE
    if bits.u(1) == 0:
        return modes[0], True
    place = 0
    while place < 5 and bits.u(1):
        place += 1
    if place == 0:
        return modes[0], False
    return modes[place], modes[place] in ("runs", "raw") or not bits.u(1)


def indices_of_rank(rank, n, count):
    indices = []
    for k in range(count, 0, -1):
        index = k - 1
        while math.comb(index + 1, k) <= rank:
            index += 1
        rank -= math.comb(index, k)
        indices.append(index)
    return indices[::-1]


def read_runs(bits, n):
    values, last, order = [0] * n, 0, 2
    for _ in range(bits.ue(1)):
        at = last + bits.ue(1) + 1
        code = bits.ue(order)
        values[last + 1:at] = [values[last]] * (at - last - 1)
        values[at] = values[last] + signed(code)
        order, last = min(max(code.bit_length() - 2, 0), 31), at
    values[last + 1:] = [values[last]] * (n - last - 1)
    return values


def read_axis(bits, head, newest, anchor, following):
    """Samples, and what the block before it in time needs to know: first sample, slope in quanta."""
    n, q, slope_q = head["n"], head["q"], head["slope_q"]

    def ends(samples, slope=None):
        return samples, (samples[0], round((samples[1] - samples[0]) / slope_q) if slope is None else slope)

    mode, prefix = read_mode(bits, head)
    if mode == "raw":
        return ends([struct.unpack(">f", struct.pack(">I", bits.u(32)))[0] for _ in range(n)])
    offset = head["step"] + bits.se(0) if head["adaptive"] else 0
    step = q * 2 ** (offset / 2)
    anchored_level = round(anchor[0] / q) if head["anchored"] and newest else 0

    if mode == "runs":
        values = read_runs(bits, n)
        if newest:
            first = round(q * anchored_level / step) + bits.se(2 if head["anchored"] else head["level_order"])
        else:
            first = round(following[0] / step) - (values[-1] - values[0]) + bits.se(2)
        return ends([step * (first + value) for value in values])

    has_slope = mode in ("line", "curve")
    has_level = has_slope or mode == "hold"
    zero_is_level = not (head["anchored"] and has_level)
    count = head["count"] + bits.se(0)
    named = range(count)
    if not prefix:
        named = indices_of_rank(bits.u((math.comb(n, count) - 1).bit_length()), n, count)
    values, order = {}, head["value_order"]
    for k in named:
        if k == 0 and zero_is_level and not newest:
            continue  # comes last
        code = bits.ue(head["level_order"] if k == 0 and zero_is_level else order)
        values[k] = signed(code + (0 if prefix else 1))
        if not (k == 0 and zero_is_level):
            order = min(max(abs(values[k]).bit_length() - 1, 0), 40)
    bend = bits.se(4) * head["bend_q"] if mode == "curve" else 0.0

    def step_of(k):
        return 1.75 * k * k * step if head["integrated"] else step

    shape = [0.5 * bend * i * i + math.sqrt(2 / n) * sum(
        value * step_of(k) * math.cos((2 * i + 1) * k * math.pi / (2 * n)) for k, value in values.items() if k > 0)
             for i in range(n)]

    slope = 0
    if has_slope:
        if not head["anchored"]:
            slope = bits.se(3)
        elif newest:
            slope = round(anchor[1] / slope_q) + bits.se(0)
        else:
            change = ((shape[-1] - shape[-2]) - (shape[1] - shape[0])) * n / (n - 2)
            slope = following[1] - round(change / slope_q) + bits.se(2)
    level = anchored_level
    if not newest:
        base = following[0] - slope_q * slope * n - (2 * shape[-1] - shape[-2])
        if not zero_is_level:
            level = round((base - values.get(0, 0) * step / math.sqrt(n)) / q) + bits.se(2)
        elif 0 in named:
            values[0] = round(base * math.sqrt(n) / step) + bits.se(2)
    base = (q * level if has_level else 0.0) + values.get(0, 0) * step / math.sqrt(n)
    return ends([base + slope_q * slope * i + shape[i] for i in range(n)], slope if has_slope else None)


def decode(data, anchor):
    bits = Bits(data)
    head = read_head(bits)
    blocks, following = [], [None] * head["axes"]
    for age in range(head["blocks"]):
        read_button(bits, head["n"])
        block = []
        for axis in range(head["axes"]):
            samples, following[axis] = read_axis(bits, head, age == 0, anchor[axis], following[axis])
            block.append(samples)
        blocks.append(block)
    left = 8 * len(data) - bits.at
    if left >= 8 or bits.u(left) != 0:
        raise ValueError("bits after the last block")
    return blocks


def main():
    before = []  # the newest blocks of the packets so far, newest first
    held = 0
    with open(sys.argv[1], encoding="ascii") as lines:
        for number, line in enumerate(lines):
            words = line.split()
            if not words:
                before = []
                continue
            anchor = [(float(words[2 * a]), float(words[2 * a + 1])) for a in range(3)]
            truth = [float(word) for word in words[7:]]
            before.insert(0, [truth[a::3] for a in range(3)])
            for block, expected in zip(decode(bytes.fromhex(words[6]), anchor), before):
                for samples, wanted in zip(block, expected):
                    if any(abs(x - y) > 1e-12 * max(1.0, abs(y)) for x, y in zip(samples, wanted)):
                        sys.exit(f"line {number + 1}: {samples} instead of {wanted}")
            held += 1
    print(f"{held} packets hold")


if __name__ == "__main__":
    main()
