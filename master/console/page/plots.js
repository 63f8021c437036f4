// Live line plots on a canvas of their own: ten seconds, a few lines, scaled to what is seen.
const kSpan_s = 10, kPoints = 1024, kLeast = 0.1;

export class Plot {
  constructor(canvas, output, lines, format) {
    this.canvas = canvas;
    this.output = output;
    this.lines = lines;      // colours, and dashes so that colour alone tells nothing
    this.format = format;
    this.t = new Float64Array(kPoints).fill(-Infinity);
    this.values = lines.map(() => new Float32Array(kPoints));
    this.next = 0;
    this.drawn = 0;
    this.top = 1;
  }

  clear() {
    this.t.fill(-Infinity);
    this.next = 0;
  }

  push(t_s, numbers) {
    const at = this.next++ % kPoints;
    this.t[at] = t_s;
    numbers.forEach((number, n) => { this.values[n][at] = Number.isFinite(number) ? number : 0; });
    this.newest = numbers;
  }

  fit() {
    const ratio = Math.min(2, window.devicePixelRatio || 1);
    const width = Math.round(this.canvas.clientWidth * ratio), height = Math.round(this.canvas.clientHeight * ratio);
    if (this.canvas.width !== width) this.canvas.width = width;
    if (this.canvas.height !== height) this.canvas.height = height;
    return ratio;
  }

  draw(now_s) {
    const ratio = this.fit();
    const { width, height } = this.canvas;
    const context = this.canvas.getContext("2d");
    context.clearRect(0, 0, width, height);
    const from_s = now_s - kSpan_s;
    const first = Math.max(0, this.next - kPoints);
    let most = 0;
    for (let n = first; n < this.next; ++n) {
      const at = n % kPoints;
      if (this.t[at] < from_s) continue;
      for (const line of this.values) most = Math.max(most, line[at]);
    }
    // The scale follows upwards at once and downwards slowly, in steps of 1, 2 and 5.
    const step = 10 ** Math.floor(Math.log10(Math.max(most, kLeast)));
    const wanted = [1, 2, 5, 10].map((k) => k * step).find((top) => top >= most) ?? 1;
    this.top = wanted > this.top ? wanted : this.top > 2.5 * wanted ? wanted : this.top;
    context.strokeStyle = "#39414a";
    context.fillStyle = "#aab3bd";
    context.font = `${11 * ratio}px system-ui, sans-serif`;
    context.lineWidth = 1;
    context.setLineDash([]);
    for (const share of [0, 0.5, 1]) {
      const y = Math.round((1 - share) * (height - 2)) + 0.5;
      context.beginPath();
      context.moveTo(0, y);
      context.lineTo(width, y);
      context.stroke();
      if (share) context.fillText(String(+(share * this.top).toPrecision(2)), 2, y + 11 * ratio);
    }
    context.lineWidth = 1.6 * ratio;
    this.values.forEach((line, n) => {
      context.strokeStyle = this.lines[n].colour;
      context.setLineDash((this.lines[n].dash ?? []).map((d) => d * ratio));
      context.beginPath();
      let begun = false, column = -1, last_s = -Infinity;
      for (let i = first; i < this.next; ++i) {
        const at = i % kPoints;
        if (this.t[at] < from_s) continue;
        const x = ((this.t[at] - from_s) / kSpan_s) * width;
        if (Math.floor(x) === column) continue;
        column = Math.floor(x);
        const y = (1 - Math.min(1, line[at] / this.top)) * (height - 2) + 1;
        if (begun && this.t[at] - last_s < 0.5) context.lineTo(x, y);
        else context.moveTo(x, y);
        begun = true;
        last_s = this.t[at];
      }
      context.stroke();
    });
    if (this.newest && ++this.drawn % 10 === 0) this.output.value = this.format(this.newest);
  }
}

// How deep the contour is cut, piece by piece along it, and the depth that is wished.
export class DepthStrip {
  constructor(canvas, output) {
    Object.assign(this, { canvas, output, depths: [], wished_m: 0 });
  }

  // `depths`: metres, or null: as before.
  show(depths, wished_m = 0) {
    if (!depths && wished_m === this.wished_m) return;
    this.depths = depths ?? this.depths;
    this.wished_m = wished_m;
    this.draw();
  }

  draw() {
    const ratio = Plot.prototype.fit.call(this), { width, height } = this.canvas;
    const cut = [...this.depths].filter((depth) => depth > 0);
    const mean = cut.reduce((sum, depth) => sum + depth, 0) / (cut.length || 1);
    this.output.value = cut.length ? `${(mean * 1e3).toFixed(2)} on ${Math.round(100 * cut.length / this.depths.length)} %` : "";
    if (!width) return;
    const context = this.canvas.getContext("2d");
    const top = 1.15 * Math.max(this.wished_m, ...this.depths, 1e-6), y = (depth) => (depth / top) * (height - 2);
    context.clearRect(0, 0, width, height);
    context.fillStyle = "#e69f00";
    this.depths.forEach((depth, n) => {
      context.fillRect(n * width / this.depths.length, 0, Math.max(1, width / this.depths.length), y(depth));
    });
    context.strokeStyle = "#eef1f4";
    context.setLineDash([6 * ratio, 4 * ratio]);
    context.lineWidth = 1.5 * ratio;
    if (this.wished_m) { context.beginPath(); context.moveTo(0, y(this.wished_m)); context.lineTo(width, y(this.wished_m)); context.stroke(); }
  }
}
