// What is meant in the picture: clicked at, drawn over it, or told by mode and threshold. And the pointer that pans.
const kLook_ms = 300, kLevelTold_ms = 2500, kClose_m = 2e-3, kPlacesAtOnce = 9;
const $ = (id) => document.getElementById(id);

// Also when the page or the console was started anew: the threshold that vision looks with.
let levelWanted = null, levelSaid_ms = -Infinity;
export function showLevel(level) {
  if (typeof level !== "number" || levelWanted !== null || performance.now() - levelSaid_ms < kLevelTold_ms) return;
  if (document.activeElement === $("level")) return;
  $("level").value = level || 0.5;
  $("level-shown").value = level ? level.toFixed(2) : "by itself";
}

export function listenForLooks(link, hand, stage) {
  // A pointer that pans or chooses pulls nothing.
  let panning = false;
  function setPointer() {
    hand.release();
    stage.drawing = $("click").value === "draw" ? [] : null;
    hand.panning = panning || $("click").value !== "";
    $("pan").setAttribute("aria-pressed", panning);
  }
  $("pan").addEventListener("click", () => { panning = !panning; setPointer(); });
  $("click").addEventListener("change", () => { setPointer(); $("click").blur(); });
  let pressedAt = null;
  stage.canvas.addEventListener("pointerdown", (e) => { pressedAt = e.button === 0 ? [e.clientX, e.clientY] : null; });
  stage.canvas.addEventListener("click", (e) => {
    const what = $("click").value;
    if (!what || what === "draw" || !pressedAt || Math.hypot(e.clientX - pressedAt[0], e.clientY - pressedAt[1]) > 6) return;
    const { x, y } = stage.toWorld(e.clientX, e.clientY);
    link.command("look", { text: `${what} ${x.toFixed(7)},${y.toFixed(7)}` });
  });
  // A line over the picture: said in pieces, as long as one event may be.
  stage.canvas.addEventListener("pointerdown", (e) => {
    if (!stage.drawing || e.button !== 0 || stage.fingers.size > 1) return;
    stage.canvas.setPointerCapture(e.pointerId);
    const { x, y } = stage.toWorld(e.clientX, e.clientY);
    stage.drawing = [x, y];
  });
  stage.canvas.addEventListener("pointermove", (e) => {
    if (!stage.drawing?.length || !stage.fingers.has(e.pointerId)) return;
    for (const point of e.getCoalescedEvents?.() ?? [e]) {
      const { x, y } = stage.toWorld(point.clientX, point.clientY);
      const [lastX, lastY] = stage.drawing.slice(-2);
      if (Math.hypot(x - lastX, y - lastY) > 1e-4) stage.drawing.push(x, y);
    }
  });
  stage.canvas.addEventListener("pointerup", () => {
    const places = stage.drawing;
    if (!places?.length) return;
    stage.drawing = [];
    link.command("look", { text: "draw" });
    for (let n = 0; n < places.length; n += 2 * kPlacesAtOnce) {
      const piece = [];
      for (let k = n; k < Math.min(places.length, n + 2 * kPlacesAtOnce); k += 2)
        piece.push(`${places[k].toFixed(6)},${places[k + 1].toFixed(6)}`);
      link.command("look", { text: `draw ${piece.join(" ")}` });
    }
    const back = Math.hypot(places[0] - places.at(-2), places[1] - places.at(-1));
    link.command("look", { text: back < kClose_m ? "draw closed" : "draw open" });
  });
  stage.canvas.addEventListener("pointercancel", () => { if (stage.drawing) stage.drawing = []; });
  $("mode").addEventListener("change", () => {
    if ($("mode").value) link.command("look", { text: $("mode").value });
    if ($("mode").value === "anew") showNoLevel();
    $("mode").value = "";
    $("mode").blur();
  });
  // The threshold: one look at a time is on its way, and the newest place of the slider is said next. What comes of it
  // waits, and is drawn over the picture.
  function sayLevel() {
    if (levelWanted === null || performance.now() - levelSaid_ms < kLook_ms) return;
    link.command("look", { text: `level ${levelWanted}`.trim() });
    levelSaid_ms = performance.now();
    levelWanted = null;
  }
  setInterval(sayLevel, 50);
  $("level").addEventListener("input", () => {
    levelWanted = Number($("level").value).toFixed(2);
    $("level-shown").value = levelWanted;
  });
  $("level").addEventListener("change", () => $("level").blur());
  function showNoLevel() { $("level").value = 0.5; $("level-shown").value = "by itself"; }
  $("level-auto").addEventListener("click", () => { levelWanted = ""; showNoLevel(); });
}
