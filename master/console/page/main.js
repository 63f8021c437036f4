// The operator's page: ties link, hand, stage and plots together, and says in words what holds or hinders.
import { Link } from "./link.js";
import { Hand } from "./hand.js";
import { Stage } from "./stage.js";
import { DepthStrip, Plot } from "./plots.js";
import { Player } from "./play.js";
import { listenForLooks, showLevel } from "./look.js";

const kStale_ms = 190, kLapse_ms = 400, kRefusal_ms = 5000, kRefusals = 3;
const $ = (id) => document.getElementById(id);
let token = document.querySelector("meta[name=token]").content || location.hash.slice(1);
const mm = (m) => (m * 1e3).toFixed(Math.abs(m) < 1e-2 ? 1 : 0);
const quantile = (numbers, share) => {
  const sorted = [...numbers].sort((a, b) => a - b);
  return sorted.length ? sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))] : NaN;
};

const refusals = new Map();  // sentence -> when it goes
let words = { driver: "nobody", stopped: false, engaged: false, armed: false, contour: 0 };
let shownContour = -1;
let shownPicture = 0;
let showWaiting = false;
let shownStream = "";
let newest = null;
let echo_ms = NaN;
const trips_ms = [], drawn_ms = [], step_ms = [], trip_ms = [], frame_ms = [], script_ms = [];
const remember = (list, number) => { list.push(number); if (list.length > 5000) list.splice(0, 1000); };

const stage = new Stage($("workpiece"));
const link = new Link({
  open() {
    link.command("rate", { value: document.hidden ? 1 : 60 });
    renewToken();
  },
  closed() { hand.setLease(0); shownContour = -1; shownPicture = 0; setWords({ ...words, driver: "nobody", lease: 0 }); },
  hello(m) {
    $("cell").textContent = m.cell;
    const chosen = $("profile").value;
    $("profile").replaceChildren(new Option("as it is", ""), ...m.profiles.map((name) => new Option(name, name)));
    $("profile").value = chosen;
    $("material").replaceChildren(...m.materials.map((word) => new Option(word)));
    if (words.material) $("material").value = words.material;
    for (const [name, all] of Object.entries(m.stream)) $(name).replaceChildren(...all.map((word) => new Option(word)));
    showStream();
  },
  words: setWords,
  lease(m) { hand.setLease(m.lease); refusals.clear(); openRefusals(false); drawn_ms.length = 0; },
  refused(m) { say(m.why); showStream(); showDepth(words); showProfile(); },
  pong(m) { remember(trip_ms, performance.now() - m.at); },
  mark(first, places) { stage.addMark(first, places); },
  depths(all) { depths.show(all, words.depth_m); },
  state(s) {
    newest = stage.state = s;
    const t = performance.now() / 1e3;
    speed.push(t, [s.speed_m_per_s * 1e3, s.slave_speed_m_per_s * 1e3]);
    error.push(t, [Math.abs(s.off_line_m) * 1e6, s.tracking_m * 1e6, s.prediction_m * 1e6]);
    remember(trips_ms, s.round_trip_s * 1e3);
    if (trips_ms.length > 600) trips_ms.shift();
    trip.push(t, [s.round_trip_s * 1e3, (s.round_trip_s + s.playout_s) * 1e3]);
    bytes.push(t, [s.command_bytes_per_s / 1e3, s.state_bytes_per_s / 1e3]);
    if (Number.isFinite(s.echo_ms) && s.echo_ms !== echo_ms && s.step_s) remember(step_ms, s.step_s * 1e3);
  },
});
const hand = new Hand(link, stage);
stage.listen(() => hand.lease !== 0 && !hand.panning);
stage.cover = () => {
  const buttons = $("zoom").offsetWidth + 12, { offsetWidth, offsetHeight } = $("legend");
  return { top: Math.min(110, stage.canvas.clientHeight / 4), bottom: 0, corner: [[buttons + offsetWidth, 0], [buttons, offsetHeight]] };
};

const figures = [...document.querySelectorAll("#plots figure")].map((f) => [f.querySelector("canvas"), f.querySelector("output")]);
const line = (colour, dash) => ({ colour, dash });
const speed = new Plot(...figures[0], [line("#56b4e9"), line("#e69f00", [6, 3])], ([a, b]) => `${a.toFixed(1)} · slave ${b.toFixed(1)}`);
const error = new Plot(...figures[1], [line("#2bb58a"), line("#e69f00", [6, 3]), line("#f0e442", [2, 3])],
  (n) => n.map((e) => e.toFixed(e < 100 ? 1 : 0)).join(" · "));
const trip = new Plot(...figures[2], [line("#56b4e9"), line("#cc79a7", [6, 3])],
  () => `p50 ${quantile(trips_ms, 0.5).toFixed(1)} · p99 ${quantile(trips_ms, 0.99).toFixed(1)}`);
const bytes = new Plot(...figures[3], [line("#56b4e9"), line("#e69f00", [6, 3])], ([a, b]) => `${a.toFixed(1)} · ${b.toFixed(1)}`);

const depths = new DepthStrip($("depths"), $("depth-now"));
$("work").addEventListener("toggle", () => depths.draw());
const player = new Player(figures, () => (hand.lease ? "Let go of the hand first: who drives looks at the cell" : ""), say);

function setWords(m) {
  words = m;
  if (m.sentence !== undefined) $("sentence").textContent = m.sentence;
  if (m.beam !== undefined) $("beam").textContent = m.beam;
  const you = m.driver === "you";
  if (!you) hand.setLease(0);
  else if (m.lease && m.lease !== hand.lease) hand.setLease(m.lease);
  $("driver").textContent = `${{ you: "You drive", other: "Another page drives", nobody: "Nobody drives" }[m.driver]}` +
    (m.watchers ? ` · ${m.watchers} watch` : "");
  const press = (id, on, yes, no) => { $(id).setAttribute("aria-pressed", on); $(id).textContent = on ? yes : no; };
  press("take", you, "Let go of the hand", "Take the hand");
  press("engage", m.engaged, "Disengage", "Engage");
  press("arm", m.armed, "Laser armed", "Arm the laser");
  document.body.classList.toggle("watching", !you);
  document.body.classList.toggle("engaged", m.engaged);
  document.body.classList.toggle("stopped", m.stopped);
  $("clear-stop").hidden = !m.stopped;
  $("clear-stop").textContent = you ? "Clear the stop" : "Clear the stop: take the hand first";
  showProfile();
  showDepth(m);
  showLevel(m.level);
  if (JSON.stringify(m.stream) !== shownStream) { shownStream = JSON.stringify(m.stream); showStream(); }
  if (m.waiting === undefined || !link.open) return;
  $("waiting").hidden = !m.waiting;
  showWaiting = showWaiting && m.waiting !== 0;
  press("show-waiting", showWaiting, "Back to the one in force", "Look at it");
  $("imaging").hidden = !m.imaging;
  $("imaging-text").textContent = m.imaging;
  if (document.activeElement !== $("axis")) $("axis").value = m.zoom;
  const id = showWaiting ? m.waiting : m.contour;
  if (id !== shownContour) loadContour(id);
  loadPicture(id, m.pictures[id] ?? m.pictures[0]);
  nameWaiting(m.waiting);
}

// The network that the cell is told to emulate; somebody else may have chosen one that is not shipped.
function showProfile() {
  const name = words.profile ?? "";
  if (![...$("profile").options].some((o) => o.value === name)) $("profile").add(new Option(name));
  if (document.activeElement !== $("profile")) $("profile").value = name;
}

function showDepth(m) {
  if (m.depth === undefined) return;
  $("material").value = m.material;
  if (document.activeElement !== $("depth")) $("depth").value = m.depth_m * 1e3;
  $("depth-shown").value = m.depth_m ? `${(m.depth_m * 1e3).toFixed(2)} mm` : "none";
  $("depth-text").textContent = m.depth;
  depths.show(null, m.depth_m);
}

// What is in force, whatever was asked for.
const kStream = ["law", "estimator", "codec", "block", "keep", "redundancy"];
function showStream() {
  for (const name of kStream) {
    const value = String(words.stream?.[name] ?? "");
    if (value && ![...$(name).options].some((o) => o.value === value)) $(name).add(new Option(value));
    $(name).value = value;
  }
}

const title = (contour) => `${contour.source.split("/").pop()}, ${contour.mode}, ${contour.closed ? "closed" : "open"}`;

// The contour that waits: its name, and its lines dashed over the one that is shown.
let waitingContour = null, askedWaiting = 0;
async function nameWaiting(id) {
  if (id !== askedWaiting) {
    askedWaiting = id;
    waitingContour = null;
    try {
      if (id) waitingContour = await (await fetch(`contour?id=${id}`)).json();
    } catch { askedWaiting = 0; }
    if (waitingContour && waitingContour.id !== words.waiting) return;  // another one waits meanwhile
    $("waiting-text").textContent = waitingContour?.id ? title(waitingContour) : "";
  }
  // Each contour has a frame of its own; the picture lies in both.
  const from = words.pictures?.[id], to = words.pictures?.[shownContour];
  const same = waitingContour?.id && from && to && !showWaiting;
  stage.setPreview(same ? waitingContour : null, same && { scale: to.width_m / from.width_m, from, to });
}

// A newer picture replaces the shown one when it is there.
let loadingPicture = false;
function loadPicture(id, picture) {
  if (!picture || !$("show-picture").checked) {
    if (shownPicture) stage.setPicture(null);
    shownPicture = 0;
    return;
  }
  if (picture.number === shownPicture || loadingPicture || document.hidden) return;
  loadingPicture = true;
  const image = new Image();
  image.onload = () => {
    loadingPicture = false;
    shownPicture = picture.number;
    stage.setPicture({ image, ...picture });
  };
  image.onerror = () => { loadingPicture = false; };
  image.src = `picture?id=${id in words.pictures ? id : 0}&number=${picture.number}`;
}

// A console that was started anew has another token, which stands in the page that it serves to this host.
async function renewToken() {
  try {
    const page = new DOMParser().parseFromString(await (await fetch("./")).text(), "text/html");
    token = page.querySelector("meta[name=token]").content || token;
  } catch { /* the next connection asks again */ }
}

async function loadContour(id) {
  shownContour = id;
  try {
    const contour = await (await fetch(`contour?id=${id}`)).json();
    stage.setContour(contour);
    $("contour-text").textContent = contour.id ? title(contour) : "none yet";
  } catch { shownContour = -1; }
}

// The same sentence stands there once, several below each other, the newest first. Two lines are seen until somebody
// opens it: the contour stays clear.
function say(why) {
  refusals.delete(why);
  refusals.set(why, performance.now() + kRefusal_ms);
  if (refusals.size > kRefusals) refusals.delete(refusals.keys().next().value);
}
function showRefusals(now_ms) {
  const open = $("refusal").classList.contains("open");
  for (const [why, ends_ms] of refusals) if (now_ms > ends_ms && !open) refusals.delete(why);
  const text = [...refusals.keys()].reverse().join("\n"), shown = $("refusal-text");
  if (shown.textContent === text) return;
  shown.textContent = text;
  $("refusal").hidden = !text;
  $("refusal-more").hidden = !open && shown.scrollHeight <= shown.clientHeight;
}
function openRefusals(open) {
  $("refusal").classList.toggle("open", open);
  $("refusal-more").setAttribute("aria-expanded", open);
  $("refusal-more").textContent = open ? "less" : "more";
  if (!open) for (const why of refusals.keys()) refusals.set(why, performance.now() + kRefusal_ms);
}

function stop() {
  hand.release();
  link.command("stop");
  if (!link.open) say("STOP is said as soon as the console is heard again. Use the machine's own stop!");
}

$("refusal-more").addEventListener("click", () => openRefusals($("refusal-more").textContent === "more"));
$("stop").addEventListener("pointerdown", stop);
$("stop").addEventListener("click", stop);
$("take").addEventListener("click", () => {
  player.close();
  hand.lease ? link.command("leave") : link.command("take", { text: token });
});
$("engage").addEventListener("click", () => link.command(words.engaged ? "disengage" : "engage"));
$("arm").addEventListener("click", () => link.command("arm", { value: words.armed ? 0 : 1 }));
$("clear-stop").addEventListener("click", () => link.command("clear-stop"));
$("beta").addEventListener("input", () => { $("beta-shown").value = Number($("beta").value).toFixed(2); });
$("beta").addEventListener("change", () => { link.command("beta", { value: Number($("beta").value) }); $("beta").blur(); });
$("profile").addEventListener("change", () => { if ($("profile").value) link.command("netem", { text: $("profile").value }); $("profile").blur(); });
for (const name of kStream)
  $(name).addEventListener("change", () => { link.command("stream", { text: `${name} ${$(name).value}` }); $(name).blur(); });
$("material").addEventListener("change", () => { link.command("material", { text: $("material").value }); $("material").blur(); });
$("depth").addEventListener("input", () => { $("depth-shown").value = `${Number($("depth").value).toFixed(2)} mm`; });
$("depth").addEventListener("change", () => { link.command("depth", { value: Number($("depth").value) / 1e3 }); $("depth").blur(); });
$("burn").addEventListener("change", () => { hand.burnWhilePulling = $("burn").checked; });
$("press").addEventListener("change", () => { hand.burnByPressure = $("press").checked; });
listenForLooks(link, hand, stage);
$("show-waiting").addEventListener("click", () => { showWaiting = !showWaiting; setWords(words); });
$("take-contour").addEventListener("click", () => { showWaiting = false; link.command("take-contour"); });
$("show-picture").addEventListener("change", () => setWords(words));
$("axis").addEventListener("change", () => { link.command("zoom", { value: Number($("axis").value) }); $("axis").blur(); });
$("refocus").addEventListener("click", () => link.command("refocus"));
const shown = () => (player.run ? player.stage : stage);
const middle = () => { const b = stage.canvas.getBoundingClientRect(); return [b.left + b.width / 2, b.top + b.height / 2]; };
$("zoom-in").addEventListener("click", () => shown().zoom(1.4, ...middle()));
$("zoom-out").addEventListener("click", () => shown().zoom(1 / 1.4, ...middle()));
$("zoom-fit").addEventListener("click", () => shown().fit());

$("fire").addEventListener("pointerdown", (e) => { $("fire").setPointerCapture(e.pointerId); hand.setFire(true); });
for (const end of ["pointerup", "pointercancel", "lostpointercapture", "contextmenu"])
  $("fire").addEventListener(end, (e) => { e.preventDefault(); hand.setFire(false); });

// Esc and Space stop, wherever the focus is; buttons are pressed with Enter.
window.addEventListener("keydown", (e) => {
  if (e.code === "Escape" || e.code === "Space") {
    e.preventDefault();
    e.stopImmediatePropagation();
    if (!e.repeat) stop();
  } else if (e.code === "KeyF" && !e.repeat && !e.ctrlKey && !e.metaKey && !e.altKey && !e.target.closest?.("input, select")) {
    hand.setFire(true);
  }
}, true);
window.addEventListener("keyup", (e) => {
  if (e.code === "Space") e.preventDefault();
  if (e.code === "KeyF") hand.setFire(false);
}, true);
window.addEventListener("beforeunload", (e) => { if (words.engaged && hand.lease) e.preventDefault(); });
document.addEventListener("visibilitychange", () => link.command("rate", { value: document.hidden ? 1 : 60 }));
setInterval(() => link.command("ping", { value: performance.now() }), 500);

// Old numbers look old, also where nothing is drawn any more.
function age() {
  const old_ms = performance.now() - link.state_ms;
  const silent_s = newest ? newest.master_age_s : -1;
  const stale = old_ms > kStale_ms || silent_s < 0 || silent_s > 0.2;
  document.body.classList.toggle("stale", stale);
  document.body.classList.toggle("live", !stale);
  document.body.classList.toggle("unheard", !link.open || old_ms > kStale_ms);  // what the console says is old, too
  $("link").textContent = !link.open ? "reconnecting" : stale ? "nothing new" : "live";
  if (!stale) return;
  const seconds = (Number.isFinite(old_ms) ? old_ms / 1e3 : 0) + Math.max(0, silent_s);
  $("age").textContent = newest && silent_s >= 0 ? `This picture is ${seconds.toFixed(1)} s old` : "No picture yet";
}
setInterval(age, 50);

function pullText(s) {
  if (!hand.held || !stage.contour) return "";
  if (words.deaf) return "The master does not listen to this page: it has to be started with --hand browser";
  if (!s.held && performance.now() - hand.pressed_ms > kLapse_ms)
    return "The hold ended, because nothing was heard of this page for a tenth of a second: let go and press anew";
  const off = stage.nearest(hand.at.x, hand.at.y);
  const tool = stage.nearest(s.tool_x_m, s.tool_y_m);
  const force = Math.hypot(s.hand_x_n, s.hand_y_n).toFixed(1);
  const where = `tool ${(tool.distance_m * 1e6).toFixed(tool.distance_m < 1e-5 ? 1 : 0)} µm from the line, ${force} N`;
  if (off.distance_m > 1e-3) return `You pull ${mm(off.distance_m)} mm off the line: it holds (${where})`;
  return `You pull along the line (${where})`;
}

let slow = 0;
function frame(now_ms) {
  const begun = performance.now();
  if (frame.last) remember(frame_ms, now_ms - frame.last);
  frame.last = now_ms;
  hand.poll(now_ms);
  const s = newest;
  if (s && Number.isFinite(s.echo_ms) && s.echo_ms !== echo_ms) {
    echo_ms = s.echo_ms;
    if (hand.lease) remember(drawn_ms, begun - echo_ms);
  }
  if (player.run) {
    player.frame(now_ms);
  } else {
    stage.draw(hand.held ? hand.at : null);
    for (const plot of [speed, error, trip, bytes]) plot.draw(begun / 1e3);
  }
  document.body.classList.toggle("burning", Boolean(s?.laser_on));
  document.body.classList.toggle("trigger", hand.trigger);
  showRefusals(begun);
  if (s && ++slow % 6 === 0) {
    $("pull").textContent = pullText(s);
    $("round-trip").textContent = s.master_age_s < 0 ? "–" : `${(s.round_trip_s * 1e3).toFixed(1)} ms`;
    $("playout").textContent = s.slave_age_s < 0 ? "–" : `${(s.playout_s * 1e3).toFixed(0)} ms`;
    if (trip_ms.length) $("page-trip").textContent = `${quantile(trip_ms.slice(-20), 0.5).toFixed(1)} ms`;
    $("lost").textContent = s.lost.toFixed(0);
    $("late").textContent = s.late_frames.toFixed(0);
    const recent = drawn_ms.slice(-300);
    $("drawn").textContent = hand.lease && recent.length ? `${quantile(recent, 0.5).toFixed(0)} ms, p99 ${quantile(recent, 0.99).toFixed(0)} ms` : "–";
    if (hand.device) $("device").textContent = hand.device;
    if (hand.device.startsWith("pen")) $("pressure").textContent = `pressure ${hand.pressure.toFixed(2)}`;
    if (document.activeElement !== $("beta")) {
      $("beta").value = s.beta;
      $("beta-shown").value = s.beta.toFixed(2);
    }
  }
  remember(script_ms, performance.now() - begun);
  requestAnimationFrame(frame);
}
requestAnimationFrame(frame);

// For tests and the benchmark: what is known here, in numbers.
window.telekerf = {
  stage, hand, link, player,
  get state() { return newest; },
  get words() { return words; },
  figures: () => ({ drawn_ms: [...drawn_ms], step_ms: [...step_ms], trip_ms: [...trip_ms], frame_ms: [...frame_ms], script_ms: [...script_ms] }),
};
