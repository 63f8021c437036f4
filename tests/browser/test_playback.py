# SPDX-License-Identifier: Apache-2.0
"""Recorded runs in the console's page, in a real browser: listed, played, stepped, fetched; also one that still goes on.

test_playback.py PROGRAMS FOLDER DOMAIN: figures on standard output, screenshots in FOLDER."""
import csv
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
import urllib.error
import urllib.request

from cell import Page, free_port, said

programs, folder, domain = sys.argv[1:4]
runs = tempfile.mkdtemp(prefix="telekerf-runs-")
port = free_port()
children = []


def program(name, *words, log=subprocess.DEVNULL):
    return subprocess.Popen([os.path.join(programs, f"telekerf-{name}"), *words], stdout=log, stderr=subprocess.STDOUT)


def get(target):
    """Status and bytes."""
    try:
        with urllib.request.urlopen(f"http://127.0.0.1:{port}/{target}", timeout=30) as answer:
            return answer.status, answer.read()
    except urllib.error.HTTPError as error:
        return error.code, error.read()


def file(name):
    with open(os.path.join(runs, "one", name), "rb") as opened:
        return opened.read()


def things_are_fetched():
    status, text = get("runs")
    listed = {run["name"]: run for run in json.loads(text)["runs"]}
    assert status == 200 and set(listed) == {"one", "broken"}, text
    assert listed["broken"]["state"] == "damaged" and listed["one"]["state"] == "closed", text
    assert abs(listed["one"]["seconds"] - 8.0) < 0.01, text
    for name in ("report.json", "master.csv", "slave.csv", "contour.csv", "cut.png", "master.h5", "slave.h5"):
        assert get(f"run?name=one&what={name}") == (200, file(name)), name
    outside = os.path.join(runs, "outside")
    for target, word in (("run?name=..&what=playback", b"No run"), ("run?name=%2Fetc&what=playback", b"No run"),
                         ("run?name=none&what=playback", b"holds no recording"), ("run?name=one&what=nothing", b"must be one of"),
                         (f"run?name=one&what=--out={outside}", b"No run"), ("run?name=broken&what=playback", b"broken"),
                         ("run", b"No run")):
        status, text = get(target)
        assert status == 404 and word in text, (target, status, text)
    assert not os.path.exists(outside)
    said("seven files fetched as they are; nothing outside of the folder")


def the_record_is_played(page):
    page.js("document.getElementById('runs').open = true")
    page.until("document.getElementById('run').options.length === 1")
    page.click("play-run")
    page.until("telekerf.player.run && telekerf.player.row > 100")
    page.click("play-pause")
    row = page.js("return telekerf.player.row")
    time.sleep(0.2)
    assert page.js("return telekerf.player.row") == row, "it plays on while paused"
    with open(os.path.join(runs, "one", "master.csv"), newline="", encoding="utf-8") as opened:
        master = list(csv.DictReader(opened))
    with open(os.path.join(runs, "one", "slave.csv"), newline="", encoding="utf-8") as opened:
        slave = list(csv.DictReader(opened))
    for place in (0, 3500, len(master) - 1):
        page.js("telekerf.player.seek(arguments[0])", place)
        page.until(f"telekerf.player.stage.state && Math.round(telekerf.player.stage.state.t_s * 1e3) === {place}")
        s = page.js("return telekerf.player.stage.state")
        beta = float(master[place]["beta"])
        assert abs(s["tool_x_m"] - beta * float(master[place]["tool_x_m"])) < 1e-8, place
        assert abs(s["slave_x_m"] - float(slave[place]["tool_x_m"])) < 1e-8, place
        assert s["laser_on"] == (float(slave[place]["laser_w"]) > 0), place
    shot = page.js("return telekerf.player.stage.mark.length / 2")
    lit = sum(float(row["laser_w"]) > 0 for row in slave)
    assert lit > 500 and 50 < shot <= lit, (lit, shot)
    before = "return getComputedStyle(document.getElementById('sentence'), '::before').content"
    assert "The cell, now" in page.js(before), "what the cell says now reads like the record"
    page.driver.save_screenshot(os.path.join(folder, "playback.png"))
    page.js("telekerf.player.seek(4000)")
    for name, row in (("step-on", 4001), ("step-on", 4002), ("step-back", 4001)):
        page.click(name)
        assert page.js("return telekerf.player.row") == row
    page.until("telekerf.player.stage.state.t_s < 4.01")
    assert page.js("return telekerf.player.stage.mark.length / 2") < shot, "the mark does not shrink on the way back"
    said(f"played, paused, sought and stepped; {shot:.0f} places marked of {lit} lit ticks")
    page.choose("play-rate", "10")
    page.js("telekerf.player.seek(0)")
    page.click("play-pause")
    took_s = page.until("!telekerf.player.running", 15)
    assert took_s < 6, f"8 s at tenfold rate took {took_s:.1f} s"
    page.size(360, 640, mobile=True)
    small = page.js("""
        return [...document.querySelectorAll("#playback button, #playback select, #playback input, #runs a")].filter((e) => {
          const box = e.getBoundingClientRect();
          return box.height < 44 || box.width < 44;
        }).map((e) => e.id || e.textContent)""")
    wide = page.js("return document.documentElement.scrollWidth - document.documentElement.clientWidth")
    assert not small and wide <= 0, (small, wide)
    time.sleep(0.2)
    page.driver.save_screenshot(os.path.join(folder, "playback-phone.png"))
    page.size(1280, 800)
    page.click("play-end")
    assert not page.js("return document.body.classList.contains('playing')")
    assert page.js(before) == "none"
    assert page.js("return document.querySelector('#plots figcaption').textContent").startswith("Speed, mm/s")


def one_that_goes_on(page):
    cell = ["--domain", domain, "--cell", "cell-1"]
    live = os.path.join(runs, "live")
    for name, words in (("vision", ["--image", "heart"]), ("slave", ["--stop-file", "off", "--record", live]),
                        ("master", ["--stop-file", "off", "--engage", "--record", live])):
        children.append(program(name, *cell, *words))
    until = time.monotonic() + 30
    while not os.path.exists(os.path.join(live, "master.h5")) and time.monotonic() < until:
        time.sleep(0.1)
    page.js("return telekerf.player.list()")
    page.until("[...document.getElementById('run').options].some((o) => o.value === 'live')")
    time.sleep(1)
    page.choose("run", "live")
    page.click("play-run")
    page.until("telekerf.player.run?.head.name === 'live'")
    assert page.js("return telekerf.player.run.head.state") == "recording"
    rows = page.js("return telekerf.player.run.head.rows")
    page.until(f"telekerf.player.run.head.rows > {rows} + 1500", 30)
    said(f"a run that goes on is played, and read on from {rows} ticks to {page.js('return telekerf.player.run.head.rows')}")


try:
    assert program("experiment", "lap", "--record", "--duration-s", "8", "--out", os.path.join(runs, "one")).wait(60) == 0
    os.makedirs(os.path.join(runs, "broken"))
    with open(os.path.join(runs, "broken", "master.h5"), "wb") as opened:
        opened.write(b"\x89HDF\r\n\x1a\n" + bytes(4000))
    children.append(program("console", "--domain", domain, "--port", str(port), "--runs", runs))
    page = Page(port)
    try:
        page.until("telekerf.link.open")
        things_are_fetched()
        the_record_is_played(page)
        one_that_goes_on(page)
        errors = page.errors()
        assert not errors, errors
        said("good")
    finally:
        page.close()
finally:
    for child in children:
        child.terminate()
    for child in children:
        child.wait(15)
    shutil.rmtree(runs)
