# SPDX-License-Identifier: Apache-2.0
"""A person cuts from the console's page, in a real browser, and the page lets go whenever it should.

test_page.py PROGRAMS FOLDER DOMAIN: figures on standard output, screenshots in FOLDER."""
import os
import sys
import time

from cell import Cell, Page, said
from layout import nothing_covers_the_contour, targets_are_large

programs, folder, domain = sys.argv[1:4]


def shot(page, name):
    page.driver.save_screenshot(os.path.join(folder, f"{name}.png"))


def hold(page, place):
    """Presses until the master is held: a page that gets no time for a tenth of a second has let go."""
    for _ in range(10):
        page.press(place)
        if cell.line.becomes(held=True, timeout_s=2):
            return
        page.let_go(place)
    raise AssertionError("the master's hand is never held")


def brightness_under_the_contour(page):
    """Mean grey of the camera's picture where the contour lies, and of the whole of it."""
    return page.js("""
        const { image, left_m, top_m, width_m, height_m } = telekerf.stage.picture;
        const canvas = document.createElement("canvas");
        [canvas.width, canvas.height] = [image.naturalWidth, image.naturalHeight];
        const context = canvas.getContext("2d");
        context.drawImage(image, 0, 0);
        const pixels = context.getImageData(0, 0, canvas.width, canvas.height).data;
        const at = (x, y) => pixels[4 * (y * canvas.width + x)];
        const points = telekerf.stage.contour.points;
        let line = 0, all = 0, count = 0;
        for (let n = 0; n < points.length; n += 2)
          line += at(Math.floor((points[n] - left_m) / width_m * canvas.width),
                     Math.floor((top_m - points[n + 1]) / height_m * canvas.height));
        for (let n = 0; n < pixels.length; n += 4000, ++count) all += pixels[n];
        return [line / (points.length / 2), all / count];""")


def look(page, words):
    """Says something of the picture, as a driver; what comes of it is looked at, and then worked on."""
    before, waits = page.js("return [telekerf.words.contour, telekerf.words.waiting]")
    page.choose("mode", words)
    page.until(f"telekerf.words.waiting && telekerf.words.waiting !== {waits}")
    assert page.js("return telekerf.words.contour") == before, "a contour was taken unasked"
    page.click("show-waiting")
    page.until("telekerf.stage.contour.id === telekerf.words.waiting")
    page.click("take-contour")
    page.until(f"!telekerf.words.waiting && telekerf.words.contour !== {before}")
    page.until("telekerf.stage.contour.id === telekerf.words.contour")
    page.until("telekerf.words.sentence.startsWith('You may move')")


def draw(page):
    """A line by hand over the picture, round the middle of the contour."""
    page.choose("click", "draw")
    places = page.js("""
        const places = [];
        for (let n = 0; n <= 60; ++n) {
          const c = telekerf.stage.toClient(4e-3 * Math.cos(n / 60 * 6.28), 4e-3 * Math.sin(n / 60 * 6.28));
          places.push([c.x, c.y]);
        }
        return places;""")
    page.press(places[0])
    for place in places:
        page.move(place)
    page.let_go(places[-1])
    page.choose("click", "")
    page.until("telekerf.words.waiting")
    page.click("show-waiting")
    page.until("telekerf.stage.contour.mode === 'drawn'")
    shot(page, "drawn")
    radii = page.js("""
        const p = telekerf.stage.contour.points, radii = [];
        for (let n = 0; n < p.length; n += 2) radii.push(Math.hypot(p[n], p[n + 1]));
        return [Math.min(...radii), Math.max(...radii), telekerf.stage.contour.closed];""")
    assert radii[2] and 3.9e-3 < radii[0] and radii[1] < 4.1e-3, radii
    page.click("show-waiting")
    said(f"a line drawn over the picture waits as a contour, {1e3 * radii[0]:.2f} to {1e3 * radii[1]:.2f} mm round the middle")


def picture(page):
    page.until("telekerf.stage.picture")
    line, whole = brightness_under_the_contour(page)
    assert line < 90 < 180 < whole, f"the contour is not where the picture's ink is: {line:.0f} of {whole:.0f}"
    middle = page.js("return telekerf.stage.contour.points.length")
    look(page, "mode outline")
    shot(page, "picture")
    assert page.js("return telekerf.stage.contour.mode") == "outline"
    draw(page)
    look(page, "anew")
    assert page.js("return telekerf.stage.contour.points.length") == middle
    said(f"ink under the contour {line:.0f}, picture {whole:.0f}; outlines chosen and taken, and back")


def threshold(page):
    """A slider moves the borders; what comes of it is drawn over the picture, and taken only when that is said."""
    before = page.js("return telekerf.words.contour")
    lengths = []
    for share in ("0.2", "0.8"):
        waits = page.js("return telekerf.words.waiting")
        page.js("""
            const slider = document.getElementById("level");
            slider.value = arguments[0];
            slider.dispatchEvent(new Event("input"));""", share)
        page.until(f"telekerf.words.waiting && telekerf.words.waiting !== {waits}")
        page.until("telekerf.stage.preview?.id === telekerf.words.waiting")
        lengths.append(page.js("""
            const p = telekerf.stage.preview.lines[0].points;
            let sum = 0;
            for (let n = 2; n < p.length; n += 2) sum += Math.hypot(p[n] - p[n - 2], p[n + 1] - p[n - 1]);
            return sum;"""))
        if share == "0.2":
            shot(page, "threshold")
    assert page.js("return telekerf.words.contour") == before, "a contour was taken unasked"
    off_um = 1e6 * page.js("""
        const p = telekerf.stage.preview.lines[0].points;
        let most = 0;
        for (let n = 0; n < p.length; n += 20) most = Math.max(most, telekerf.stage.nearest(p[n], p[n + 1]).distance_m);
        return most;""")
    assert off_um < 500, f"what waits is drawn {off_um:.0f} um off the line that it is of"
    page.click("level-auto")
    page.until("!telekerf.words.waiting && !telekerf.stage.preview")
    said(f"threshold 0.2 and 0.8: {1e3 * lengths[0]:.1f} and {1e3 * lengths[1]:.1f} mm long, drawn over the picture")


def another_law(page):
    """Between two engagements; refused with the reason while engaged."""
    page.js("document.getElementById('stream').open = true; document.getElementById('work').open = true")
    for name, value in (("law", "local"), ("codec", "dpcm"), ("block", "32")):
        page.choose(name, value)
        page.until(f"String(telekerf.words.stream.{name}) === '{value}'")
    for name, value in (("law", "anchored"), ("codec", "sdct"), ("block", "16")):
        page.choose(name, value)
        page.until(f"String(telekerf.words.stream.{name}) === '{value}'")
    page.choose("material", "fibreglass")
    page.until("telekerf.words.material === 'fibreglass'")
    page.js("const e = document.getElementById('depth'); e.value = 0.1; e.dispatchEvent(new Event('change'))")
    page.until("telekerf.words.depth_m === 0.0001")
    text = page.js("return document.getElementById('depth-text').textContent")
    assert text.startswith("fibreglass gets ") and "mm/s" in text, text
    targets_are_large(page, 1280)
    page.js("document.getElementById('work').scrollIntoView()")
    shot(page, "settings")
    page.js("document.querySelector('aside').scrollTop = 0; document.getElementById('stream').open = false")
    said(f"law, codec and block changed and back; {text}")


def cut(page):
    page.until("telekerf.words.sentence?.startsWith('You may move')")
    page.until("telekerf.stage.contour")
    nothing_covers_the_contour(page, shot)
    shot(page, "watching")
    targets_are_large(page, 1280)
    page.click("engage")
    page.until("document.getElementById('refusal').textContent.includes('take the hand first')", 10)
    said("who watches is told why nothing comes of a press")
    page.click("take")
    page.until("telekerf.hand.lease")
    picture(page)
    threshold(page)
    another_law(page)
    page.click("engage")
    page.until("telekerf.words.sentence.includes('the slave follows')")
    page.choose("law", "local")
    page.until("document.getElementById('refusal').textContent.includes('disengage first')")
    page.until("document.getElementById('law').value === 'anchored'")
    page.click("arm")
    page.until("telekerf.words.armed")
    page.click("burn")
    page.watch_the_line()
    time.sleep(1)  # the slave comes to the master
    marks = page.js("return telekerf.stage.mark.length / 2")
    for _ in range(15):  # on a machine that is short of time the beam is off where a step came late
        places = page.along(70)
        hold(page, page.tool())
        for place in places:
            page.move(place)
            time.sleep(0.03)
        grown = page.js("return telekerf.stage.mark.length / 2") - marks
        if grown > 100:
            break
        page.let_go(places[-1])
    shot(page, "cutting")
    assert grown > 100, f"the mark has grown by {grown} places"
    said(f"the mark has grown by {grown:.0f} places of 40 um")
    page.until("document.getElementById('depth-now').value.includes('%')")
    said(f"depth along the contour: {page.js('return document.getElementById(`depth-now`).value')}")

    for _ in range(6):
        off = page.beside(5e-3)
        if not cell.line.held:
            page.let_go(off)
            hold(page, page.tool())
        page.move(off)
        for _ in range(15):  # a hand never rests
            page.move((off[0] + 1, off[1]))
            page.move(off)
            time.sleep(0.04)
        text = page.js("return document.getElementById('pull').textContent")
        if cell.line.held:
            break
    assert "off the line: it holds" in text, text
    shot(page, "held")
    farthest_um = 1e6 * page.js("return telekerf.farthest")
    assert farthest_um < 300, f"{farthest_um} um off the line"
    said(f"{text}; never more than {farthest_um:.0f} um off the line")
    page.let_go(off)
    cell.line.wait(held=False)
    said(f"let go: the master's step {cell.line.release_ms:.1f} ms after the console heard it")


def under_the_beam(page):
    """Another network is refused at both sites alike, whoever asks, and the page says so and shows what is in force."""
    def lit():
        for _ in range(10):
            hold(page, page.tool())
            for place in page.along(40):
                page.move(place)
                time.sleep(0.02)
                if page.js("return telekerf.state.laser_on"):
                    return True
            page.let_go(page.tool())
        return False
    assert lit(), "the beam is never on"
    page.choose("profile", "lan")
    page.until("document.getElementById('refusal').textContent.includes('No other network while the beam is on')", 5)
    page.let_go(page.tool())
    shown = page.js("return [document.getElementById('profile').value, telekerf.words.profile]")
    assert shown == ["", ""], shown
    page.until("!telekerf.state.laser_on", 5)  # the slave learns of it after the network's delay
    said("another network under the beam: refused, and the page shows the one in force")


def another_network(page):
    for profile, sign, bound in (("lan", "<", 0.02), ("thesis-constant", ">", 0.09)):
        page.choose("profile", profile)
        page.until(f"telekerf.words.profile === '{profile}'", 10)
        assert page.js("return document.getElementById('profile').value") == profile
        page.until(f"telekerf.state.round_trip_s {sign} {bound}", 10)
    said("another network, and back: the round trip followed")


def lets_go(page):
    place = page.tool()
    hold(page, place)
    page.driver.switch_to.new_window("tab")
    cell.line.wait(held=False)
    said(f"another tab in front: released, {cell.line.release_ms:.1f} ms after the page let go")
    page.driver.close()
    page.driver.switch_to.window(page.driver.window_handles[0])
    page.until("!document.hidden")
    page.let_go(place)
    hold(page, page.tool())
    page.js("window.dispatchEvent(new Event('blur'))")
    cell.line.wait(held=False)
    said("focus lost: released")
    page.let_go(page.tool())
    for what, freeze in (("page frozen", lambda: page.js(
            "const until = performance.now() + 600; while (performance.now() < until);")),
                         ("line pulled", lambda: cell.stall("console", 0.6))):
        hold(page, page.tool())
        cell.line.release_ms = None
        freeze()
        after = cell.line.held_frames + 5
        until = time.monotonic() + 5
        while cell.line.held_frames < after and time.monotonic() < until:
            time.sleep(0.02)
        assert cell.line.held_frames >= after, "the page still holds"
        assert not cell.line.held, "who still holds is not heard before he lets go"
        assert cell.line.release_ms >= 99, cell.line.release_ms
        said(f"{what}: released {cell.line.release_ms:.0f} ms after the last frame, and not held again by itself")
        page.let_go(page.tool())


def stops(page):
    page.until("telekerf.hand.lease")
    page.driver.execute_cdp_cmd("Input.dispatchKeyEvent", {"type": "keyDown", "code": "Escape", "key": "Escape"})
    page.until("telekerf.words.stopped && telekerf.words.sentence.startsWith('Stopped by operator')", 10)
    page.until("telekerf.state.mode === 4", 10)
    page.until("!telekerf.hand.lease && telekerf.words.driver === 'nobody'", 10)
    shot(page, "stopped")
    said("Esc stopped the cell, and took the hand away")
    page.click("clear-stop")
    page.until("document.getElementById('refusal').textContent.includes('take the hand first')", 10)
    page.click("take")
    page.until("telekerf.hand.lease", 10)
    page.click("engage")
    page.until("document.getElementById('refusal').textContent.includes('clear the stop first')", 10)
    page.until("telekerf.words.sentence.startsWith('Stopped by')", 10)
    time.sleep(0.7)  # every station is asked for at least so long
    page.click("clear-stop")
    page.until("!telekerf.words.stopped", 10)


def comes_back(page):
    marks = page.js("return telekerf.stage.mark.length / 2")
    assert marks > 100, marks
    cell.end("console")
    page.until("document.body.classList.contains('stale')", 10)
    text = page.js("return document.getElementById('age').textContent")
    assert "old" in text, text
    shot(page, "stale")
    page.js("Object.assign(telekerf.words, { material: 'old', depth_m: -1, profile: 'old' })")
    cell.start_console()
    page.until("document.body.classList.contains('live')", 10)
    page.until(f"telekerf.stage.mark.length / 2 >= {marks}", 10)
    page.until("telekerf.words.material === 'fibreglass' && telekerf.words.depth_m === 0.0001", 10)
    page.until("telekerf.words.profile === 'thesis-constant' && document.getElementById('profile').value === 'thesis-constant'", 10)
    said(f"the console ended and came back, and the page with it, its mark of {marks:.0f} places, material, depth and network")
    time.sleep(0.3)
    page.click("take")
    page.until("telekerf.hand.lease", 10)


def on_a_phone(page):
    page.size(360, 640, mobile=True)
    page.driver.get(f"http://127.0.0.1:{cell.port}/")
    page.until("telekerf.words.sentence?.startsWith('You may move')")
    targets_are_large(page, 360)
    assert page.js("const b = document.getElementById('stop').getBoundingClientRect(); "
                   "return b.top >= 0 && b.right <= innerWidth && b.bottom <= innerHeight")
    time.sleep(0.3)
    shot(page, "phone")
    said("360 x 640: targets are large enough, the stop is in sight")


def killed(page):
    page.click("take")
    page.until("telekerf.hand.lease")
    hold(page, page.tool())
    time.sleep(0.2)
    os.kill(page.pid, 9)
    cell.line.wait(held=False)
    said(f"browser killed: released {cell.line.release_ms:.0f} ms after its last frame")


cell = Cell(programs, folder, domain)
page = None
try:
    page = Page(cell.port)
    cut(page)
    under_the_beam(page)
    another_network(page)
    lets_go(page)
    stops(page)
    assert not page.errors(), page.errors()
    comes_back(page)
    on_a_phone(page)
    killed(page)
    said("good")
finally:
    if page:
        page.close()
    cell.close()
