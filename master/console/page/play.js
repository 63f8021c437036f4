// Plays a recorded run on a stage of its own, above the live one: what is seen then is the record, never the cell.
import { Stage } from "./stage.js";
import { Plot } from "./plots.js";

const kSpan_s = 10, kPoints = 500, kGrid_m = 40e-6, kReadOn_ms = 2000;
const $ = (id) => document.getElementById(id);
const line = (colour, dash) => ({ colour, dash });
const one = (n) => (Number.isFinite(n) ? n.toFixed(n < 100 ? 1 : 0) : "–");
const all = (numbers) => numbers.map(one).join(" · ");
const kFiles = ["report.json", "cut.png", "master.csv", "slave.csv", "contour.csv", "master.h5", "slave.h5"];
// Caption, lines, and what they show of a moment.
const kPlots = [
  ["Speed of hand and slave, mm/s ", [line("#56b4e9"), line("#e69f00", [6, 3])], (s) => [s.speed_m_per_s * 1e3, s.slave_speed_m_per_s * 1e3]],
  ["Off the line, slave off the hand, predicted, µm ", [line("#2bb58a"), line("#e69f00", [6, 3]), line("#f0e442", [2, 3])],
    (s) => [Math.abs(s.off_line_m) * 1e6, s.tracking_m * 1e6, s.prediction_m * 1e6]],
  ["Slave behind the hand, ms ", [line("#cc79a7")], (s) => [s.behind_s * 1e3]],
  ["Laser, W; force at the slave, N ", [line("#e69f00"), line("#56b4e9", [6, 3])], (s) => [s.laser_w, s.slave_force_n]],
];

export class Player {
  // `figures`: canvas and output of each plot; `refusal`: why nothing may be played now, or empty.
  constructor(figures, refusal, say) {
    this.refusal = refusal;
    this.say = say;
    this.stage = new Stage($("record"));
    this.stage.listen(() => false);
    this.plots = figures.map(([canvas, output], n) => new Plot(canvas, output, kPlots[n][1], all));
    this.captions = figures.map(([, output]) => output.previousSibling);
    this.live = this.captions.map((text) => text.data);
    this.run = null;         // {head, rows, width}
    this.row = 0;
    this.rate = 1;
    this.running = false;
    this.marked = 0;
    $("runs").addEventListener("toggle", () => { if ($("runs").open) this.list(); });
    $("run").addEventListener("change", () => this.files());
    $("play-run").addEventListener("click", () => this.open($("run").value));
    $("play-pause").addEventListener("click", () => this.go(!this.running));
    $("step-back").addEventListener("click", () => this.seek(Math.round(this.row) - 1));
    $("step-on").addEventListener("click", () => this.seek(Math.round(this.row) + 1));
    $("play-at").addEventListener("input", () => this.seek(Number($("play-at").value)));
    $("play-rate").addEventListener("change", () => { this.rate = Number($("play-rate").value); });
    $("play-end").addEventListener("click", () => this.close());
  }

  async list() {
    try {
      const answer = await fetch("runs");
      if (!answer.ok) throw new Error(await answer.text());
      const { runs } = await answer.json();
      const chosen = $("run").value;
      $("run").replaceChildren(...runs.filter((r) => r.state !== "damaged").map((r) =>
        new Option(`${r.name} · ${r.seconds.toFixed(0)} s${r.state === "closed" ? "" : `, ${r.state}`}${r.label ? ` · ${r.label}` : ""}`, r.name)));
      if (chosen) $("run").value = chosen;
      $("no-runs").hidden = runs.length > 0;
      this.files();
    } catch (error) { this.say(error.message); }
  }

  files() {
    const name = $("run").value;
    $("run-files").replaceChildren(...(name ? kFiles : []).map((file) => {
      const link = document.createElement("a");
      link.href = `run?name=${encodeURIComponent(name)}&what=${file}`;
      link.download = `${name}-${file}`;
      link.textContent = file;
      return link;
    }));
  }

  async read(name) {
    const answer = await fetch(`run?name=${encodeURIComponent(name)}&what=playback`);
    if (!answer.ok) throw new Error(await answer.text());
    const buffer = await answer.arrayBuffer();
    const length = new DataView(buffer).getUint32(0, true);
    const head = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
    return { head, rows: new Float32Array(buffer, 4 + length), width: head.fields.length };
  }

  async open(name) {
    if (!name) return;
    if (this.refusal()) return this.say(this.refusal());
    try {
      const run = await this.read(name);
      if (!run.head.rows) throw new Error(`${name}: the master has recorded nothing`);
      if (this.refusal()) return;
      this.run = run;
      this.contour = -1;
      this.forget();
      document.body.classList.add("playing");
      this.captions.forEach((text, n) => { text.data = kPlots[n][0]; });
      $("play-at").max = run.head.rows - 1;
      this.stage.fitted = true;
      this.seek(0);
      this.go(true);
    } catch (error) { this.say(error.message); }
  }

  close() {
    this.run = null;
    this.running = false;
    document.body.classList.remove("playing");
    this.captions.forEach((text, n) => { text.data = this.live[n]; });
  }

  go(on) {
    if (on && this.run && this.row >= this.run.head.rows - 1) this.row = 0;
    this.running = on;
    this.last_ms = NaN;
    $("play-pause").textContent = on ? "Pause" : "Play";
  }

  seek(row) {
    this.go(false);
    this.row = Math.min(this.run.head.rows - 1, Math.max(0, row));
  }

  // What was at this row, under the names that the live page uses.
  moment(row) {
    const { head, rows, width } = this.run;
    const s = {};
    for (let n = 0; n < width; ++n) s[head.fields[n]] = rows[row * width + n];
    s.master_age_s = 0;
    s.slave_age_s = Number.isFinite(s.slave_x_m) ? 0 : -1;
    s.laser_on = s.laser_w > 0;
    s.mode = s.engaged ? 3 : 2;
    s.circle_is_line = 1;
    return s;
  }

  forget() {
    this.marked = 0;
    this.stage.mark = [];
    this.stage.dirty = true;
  }

  mark(row) {
    if (row < this.marked) this.forget();
    const { head, rows, width } = this.run;
    const [x, y, w] = ["slave_x_m", "slave_y_m", "laser_w"].map((name) => head.fields.indexOf(name));
    const mark = this.stage.mark;
    for (; this.marked <= row; ++this.marked) {
      const at = this.marked * width;
      if (!(rows[at + w] > 0)) continue;
      if (mark.length && Math.hypot(rows[at + x] - mark.at(-2), rows[at + y] - mark.at(-1)) < kGrid_m) continue;
      mark.push(rows[at + x], rows[at + y]);
    }
  }

  // A run that still goes on has grown meanwhile.
  async readOn(now_ms) {
    if (this.run.head.state !== "recording" || this.reading || now_ms - (this.read_ms ?? 0) < kReadOn_ms) return;
    this.reading = true;
    this.read_ms = now_ms;
    try {
      const before = this.run, run = await this.read(before.head.name);
      if (this.run === before && run.head.every === before.head.every) {
        this.run = run;
        $("play-at").max = run.head.rows - 1;
      }
    } catch { /* asked again */ } finally { this.reading = false; }
  }

  // What covers the stage at the top and at the bottom depends on the window.
  makeRoom() {
    const stage = this.stage, height = stage.canvas.clientHeight;
    const top = Math.min($("notes").clientHeight, height / 4), bottom = Math.min($("playback").clientHeight + 20, height / 2);
    if (top === this.top && bottom === stage.below) return;
    this.top = top;
    stage.below = bottom;
    stage.cover = () => ({ top, bottom, corner: [[0, 0]] });
    if (stage.fitted) stage.fit();
  }

  frame(now_ms) {
    this.makeRoom();
    const { head } = this.run;
    if (this.running) {
      if (Number.isFinite(this.last_ms)) this.row += (now_ms - this.last_ms) * 1e-3 * this.rate / head.step_s;
      this.last_ms = now_ms;
      if (this.row >= head.rows - 1) {
        this.row = head.rows - 1;
        if (head.state === "recording") this.readOn(now_ms);
        else this.go(false);
      }
    }
    const row = Math.round(this.row);
    const contour = head.contours.findLastIndex((c) => c.from_row <= row);
    if (contour !== this.contour) {
      this.contour = contour;
      this.stage.setContour(contour < 0 ? { id: 0 } : { id: contour + 1, further: [], ...head.contours[contour] });
    }
    const s = this.stage.state = this.moment(row);
    this.mark(row);
    this.stage.draw(null);
    const first = Math.max(0, row - Math.round(kSpan_s / head.step_s)), step = Math.max(1, Math.ceil((row - first) / kPoints));
    this.plots.forEach((plot) => plot.clear());
    for (let n = row - Math.floor((row - first) / step) * step; n <= row; n += step) {
      const then = this.moment(n);
      this.plots.forEach((plot, k) => plot.push(then.t_s, kPlots[k][2](then)));
    }
    this.plots.forEach((plot) => plot.draw(s.t_s));
    if (document.activeElement !== $("play-at")) $("play-at").value = row;
    $("play-time").value = `${s.t_s.toFixed(3)} s of ${((head.rows - 1) * head.step_s).toFixed(1)} s`;
    $("play-name").textContent = `Recording ${head.name}${head.state === "recording" ? ", still going on" : ""}` +
      (s.laser_on ? `: the beam was on, ${s.laser_w.toFixed(1)} W` : s.engaged ? ": engaged" : "");
  }
}
