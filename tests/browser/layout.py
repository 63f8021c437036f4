# SPDX-License-Identifier: Apache-2.0
"""What the console's page looks like at sizes from a phone to a desktop."""
import time


def targets_are_large(page, width):
    small = page.js("""
        return [...document.querySelectorAll("button, select, input[type=range], label.switch")].filter((e) => {
          const box = e.getBoundingClientRect();
          return box.width && (box.height < (e.id === "stop" ? 88 : 44) || box.width < 44);
        }).map((e) => e.id || e.textContent)""")
    assert not small, f"too small to be hit at {width} px: {small}"
    wide = page.js("return document.documentElement.scrollWidth - document.documentElement.clientWidth")
    assert wide <= 0, f"{wide} px stick out at {width} px"


def covered(page, names, texts=None):
    """Points of the contour that lie under these elements, which say these texts."""
    return page.js("""
        const [names, texts] = arguments;
        for (const [id, text] of Object.entries(texts)) document.getElementById(id).textContent = text;
        const boxes = names.map((id) => document.getElementById(id).getBoundingClientRect());
        const points = telekerf.stage.contour.points;
        let covered = 0;
        for (let n = 0; n < points.length; n += 2) {
          const at = telekerf.stage.toClient(points[n], points[n + 1]);
          covered += boxes.some((b) => at.x > b.left && at.x < b.right && at.y > b.top && at.y < b.bottom);
        }
        return covered;""", names, texts or {})


def nothing_covers_the_contour(page, shot):
    """Nor does the longest that is said, nor refusals of many lines, which can be opened."""
    longest = {"sentence": "Engaged: you push the tool off the line, so the beam waits until it is back",
               "beam": "Beam off: nobody knows how old the commands are: they answer no state of this slave",
               "pull": "You pull 5.0 mm off the line: it holds (tool 1.1 µm from the line, 15.2 N)"}
    cut_off = "(() => { const e = document.getElementById('refusal-text'); return e.scrollHeight - e.clientHeight; })()"
    for width, height in ((1024, 600), (1366, 768), (360, 640), (390, 844), (1280, 800)):
        page.size(width, height, mobile=width < 500)
        time.sleep(0.3)
        where = f"at {width} x {height}"
        assert not covered(page, ["legend", "zoom"]), f"the contour lies under legend or buttons {where}"
        shot(page, f"watching-{width}")
        under = covered(page, ["sentence", "beam", "pull"], longest)
        assert not under, f"{under} points of the contour lie under what is said {where}"
        for n in range(3):
            page.js("telekerf.link.heard.refused({ why: arguments[0] })", f"contour {n} refused" + 15 * ": it is longer than it may be")
        page.until("!document.getElementById('refusal').hidden")
        under = covered(page, ["sentence", "beam", "refusal"], longest)
        shot(page, f"refused-{width}")
        assert not under, f"{under} points of the contour lie under refusals {where}"
        assert page.js(f"return {cut_off}") > 20, f"all of them is seen {where}"
        targets_are_large(page, width)
        page.click("refusal-more")
        assert page.js(f"return {cut_off}") == 0, f"opened, not all of them is seen {where}"
        if width == 1280:
            time.sleep(5.2)
            assert page.js("return !document.getElementById('refusal').hidden"), "what somebody reads goes by itself"
        page.js("telekerf.link.heard.lease({ lease: 0 })")
        page.until("document.getElementById('refusal').hidden")
