// The workpiece: contour, corridor, growing mark, tools. What rarely changes is drawn once, on a layer below.
const kCorridor_m = 0.5e-3, kKerf_m = 0.2e-3;
const kColour = { tool: "#56b4e9", predicted: "#f0e442", slave: "#e69f00", contour: "#0072b2", mark: "#1d1208", waiting: "#f5a3d7" };

export class Stage {
  constructor(canvas) {
    this.canvas = canvas;
    this.layer = document.createElement("canvas");
    this.contour = null;
    this.picture = null;     // {image, left_m, top_m, width_m, height_m}
    this.preview = null;     // {lines: [{points, closed}]} of the contour that waits, in the shown one's frame
    this.mark = [];          // x, y of every place, metres
    this.drawn = 0;          // of these on the layer
    this.dirty = true;
    this.centre = { x: 0, y: 0 };
    this.scale = 20000;      // pixels (CSS) a metre
    // Pixels that words and buttons cover: at the top, at the bottom, and in the corner at the right below, of which
    // either the width or the height may be kept clear: [width, height] of each way to do so.
    this.cover = () => ({ top: 0, bottom: 0, corner: [[0, 0]] });
    this.below = 0;          // of these, at the bottom
    this.fitted = true;      // the view follows the contour until somebody changes it
    this.state = null;
    this.drag = null;
    this.drawing = null;     // x, y of what somebody draws over the picture, metres
    this.fingers = new Map();
    canvas.addEventListener("wheel", (e) => { e.preventDefault(); this.zoom(Math.exp(-e.deltaY / 500), e.clientX, e.clientY); }, { passive: false });
    new ResizeObserver(() => { this.dirty = true; if (this.fitted) this.fit(); }).observe(canvas);
  }

  // Panning and pinching; `drives`: one pointer pulls the tool instead.
  listen(drives) {
    const c = this.canvas;
    c.addEventListener("pointerdown", (e) => {
      this.fingers.set(e.pointerId, { x: e.clientX, y: e.clientY });
      if (this.fingers.size === 2) { this.drag = null; this.drawing = this.drawing && []; }
      else if (e.button === 1 || (!drives() && !this.drawing)) this.drag = e.pointerId;
    });
    c.addEventListener("pointermove", (e) => {
      const before = this.fingers.get(e.pointerId);
      if (!before) return;
      const now = { x: e.clientX, y: e.clientY };
      if (this.fingers.size === 2) {
        const other = [...this.fingers].find(([id]) => id !== e.pointerId)[1];
        const apart = (a) => Math.hypot(a.x - other.x, a.y - other.y) || 1;
        this.zoom(apart(now) / apart(before), other.x, other.y);
      } else if (this.drag === e.pointerId) {
        this.pan(now.x - before.x, now.y - before.y);
      }
      this.fingers.set(e.pointerId, now);
    });
    for (const end of ["pointerup", "pointercancel"])
      c.addEventListener(end, (e) => { this.fingers.delete(e.pointerId); if (this.drag === e.pointerId) this.drag = null; });
  }

  setContour(contour) {
    this.contour = contour.id ? contour : null;
    this.dirty = true;
    this.fit();
  }

  // The contour that waits, or none; `map`: from its frame to the shown one's.
  setPreview(contour, map) {
    if (contour?.id === this.preview?.id && (!contour || map.scale === this.preview.scale && map.to.left_m === this.preview.left_m)) return;
    const moved = (points) => points.map((value, n) => (n % 2
      ? map.to.top_m + (value - map.from.top_m) * map.scale : map.to.left_m + (value - map.from.left_m) * map.scale));
    this.preview = contour && { id: contour.id, scale: map.scale, left_m: map.to.left_m,
      lines: [contour, ...contour.further].map((line) => ({ points: moved(line.points), closed: line.closed })) };
    this.dirty = true;
  }

  // The camera's picture under the contour, or none.
  setPicture(picture) {
    this.picture = picture;
    this.dirty = true;
  }

  addMark(first, places) {
    if (first === 0) { this.mark = []; this.dirty = true; }
    for (const number of places) this.mark.push(number);
  }

  fit() {
    this.fitted = true;
    this.dirty = true;
    const width = this.canvas.clientWidth || 1, height = this.canvas.clientHeight || 1;
    if (!this.contour) return;
    const p = this.contour.points;
    let x0 = Infinity, x1 = -Infinity, y0 = Infinity, y1 = -Infinity;
    for (let n = 0; n < p.length; n += 2) {
      x0 = Math.min(x0, p[n]); x1 = Math.max(x1, p[n]); y0 = Math.min(y0, p[n + 1]); y1 = Math.max(y1, p[n + 1]);
    }
    const { top, bottom, corner } = this.cover();
    const margin = Math.min(Math.min(width, height) * 0.06 + 24, (height - top - bottom) / 6);
    const [dx, dy] = [x1 - x0 || 1e-3, y1 - y0 || 1e-3];
    const ways = corner.map(([right, low]) => ({ right, low: bottom + low,
      scale: Math.min((width - right - 2 * margin) / dx, (height - top - bottom - low - 2 * margin) / dy) }));
    const { right, low, scale } = ways.reduce((best, way) => (way.scale > best.scale ? way : best));
    this.scale = Math.max(1000, scale);
    this.below = bottom;
    const aside = Math.max(0, this.scale * dx / 2 + right + margin / 2 - width / 2);  // in the middle, if that is free
    this.centre = { x: (x0 + x1) / 2 + aside / this.scale, y: (y0 + y1) / 2 + (top - low) / 2 / this.scale };
  }

  zoom(by, clientX, clientY) {
    const before = this.toWorld(clientX, clientY);
    this.scale = Math.min(2e6, Math.max(1000, this.scale * by));
    const after = this.toWorld(clientX, clientY);
    this.centre.x += before.x - after.x;
    this.centre.y += before.y - after.y;
    this.fitted = false;
    this.dirty = true;
  }

  pan(dx, dy) {
    this.centre.x -= dx / this.scale;
    this.centre.y += dy / this.scale;
    this.fitted = false;
    this.dirty = true;
  }

  toWorld(clientX, clientY) {
    const box = this.canvas.getBoundingClientRect();
    return { x: this.centre.x + (clientX - box.left - box.width / 2) / this.scale,
             y: this.centre.y - (clientY - box.top - box.height / 2) / this.scale };
  }

  toClient(x, y) {
    const box = this.canvas.getBoundingClientRect();
    return { x: box.left + box.width / 2 + (x - this.centre.x) * this.scale,
             y: box.top + box.height / 2 - (y - this.centre.y) * this.scale };
  }

  toolWorld() { return { x: this.state?.tool_x_m ?? 0, y: this.state?.tool_y_m ?? 0 }; }

  // Distance of a place to the contour, and its nearest point.
  nearest(x, y) {
    let best = { distance_m: Infinity, x: 0, y: 0 };
    const p = this.contour?.points ?? [];
    const count = p.length / 2, segments = this.contour?.closed ? count : count - 1;
    for (let n = 0; n < segments; ++n) {
      const ax = p[2 * n], ay = p[2 * n + 1], m = (n + 1) % count;
      const dx = p[2 * m] - ax, dy = p[2 * m + 1] - ay;
      const u = Math.min(1, Math.max(0, ((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy || 1)));
      const d = Math.hypot(x - ax - u * dx, y - ay - u * dy);
      if (d < best.distance_m) best = { distance_m: d, x: ax + u * dx, y: ay + u * dy };
    }
    return best;
  }

  place(context, ratio) {
    const { width, height } = this.canvas;
    const k = this.scale * ratio;
    context.setTransform(k, 0, 0, -k, width / 2 - k * this.centre.x, height / 2 + k * this.centre.y);
  }

  path(context, points, closed) {
    context.beginPath();
    for (let n = 0; n < points.length; n += 2) context.lineTo(points[n], points[n + 1]);
    if (closed) context.closePath();
  }

  drawLayer(ratio) {
    const { width, height } = this.canvas;
    const context = this.layer.getContext("2d");
    if (this.dirty) {
      this.layer.width = width;
      this.layer.height = height;
      context.fillStyle = "#d8ba8c";
      context.fillRect(0, 0, width, height);
      this.drawn = 0;
      if (this.picture) this.drawPicture(context, ratio);
      if (this.contour) {
        this.place(context, ratio);
        context.lineJoin = context.lineCap = "round";
        for (const line of this.contour.further) {
          this.path(context, line.points, line.closed);
          context.strokeStyle = "#7a6a52";
          context.lineWidth = 1.5 / this.scale;
          context.stroke();
        }
        this.path(context, this.contour.points, this.contour.closed);
        context.strokeStyle = "rgb(20 60 90 / .20)";
        context.lineWidth = 2 * kCorridor_m;
        context.stroke();
        context.strokeStyle = kColour.contour;
        context.lineWidth = 2.2 / this.scale;
        context.stroke();
      }
      if (this.preview) {
        this.place(context, ratio);
        this.preview.lines.forEach((line, n) => {
          this.path(context, line.points, line.closed);
          for (const [colour, width, dash] of [["#111", 4, []], [kColour.waiting, 2.4, n ? [3, 5] : [9, 5]]]) {
            context.strokeStyle = colour;
            context.lineWidth = width / this.scale;
            context.setLineDash(dash.map((d) => d / this.scale));
            context.stroke();
          }
        });
        context.setLineDash([]);
      }
      this.dirty = false;
    }
    if (this.drawn * 2 < this.mark.length) {
      this.place(context, ratio);
      context.fillStyle = kColour.mark;
      context.beginPath();
      const radius = Math.max(kKerf_m / 2, 1.5 / this.scale);
      for (let n = 2 * this.drawn; n < this.mark.length; n += 2) {
        context.moveTo(this.mark[n] + radius, this.mark[n + 1]);
        context.arc(this.mark[n], this.mark[n + 1], radius, 0, 7);
      }
      context.fill();
      this.drawn = this.mark.length / 2;
    }
  }

  drawPicture(context, ratio) {
    const { image, left_m, top_m, width_m, height_m } = this.picture;
    const k = this.scale * ratio;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.globalAlpha = 0.85;  // lines and words stay legible
    context.drawImage(image, this.canvas.width / 2 + (left_m - this.centre.x) * k,
      this.canvas.height / 2 - (top_m - this.centre.y) * k, width_m * k, height_m * k);
    context.globalAlpha = 1;
  }

  scaleBar(context, width, height) {
    const lengths_mm = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100];
    const mm = lengths_mm.find((l) => l * 1e-3 * this.scale > 70) ?? 100;
    const px = mm * 1e-3 * this.scale, x = 16, y = height - 20 - this.below;
    context.strokeStyle = context.fillStyle = "#111";
    context.lineWidth = 3;
    context.beginPath();
    context.moveTo(x, y - 6); context.lineTo(x, y + 6);
    context.moveTo(x, y); context.lineTo(x + px, y);
    context.moveTo(x + px, y - 6); context.lineTo(x + px, y + 6);
    context.stroke();
    context.font = "600 15px system-ui, sans-serif";
    context.fillText(`${mm} mm`, x + px + 8, y + 5);
  }

  // `pull`: where the hand pulls, or null.
  draw(pull) {
    const ratio = Math.min(2, window.devicePixelRatio || 1);
    const cssWidth = this.canvas.clientWidth, cssHeight = this.canvas.clientHeight;
    const width = Math.round(cssWidth * ratio), height = Math.round(cssHeight * ratio);
    if (this.canvas.width !== width || this.canvas.height !== height) {
      this.canvas.width = width;
      this.canvas.height = height;
      this.dirty = true;
    }
    if (!width || !height) return;
    this.drawLayer(ratio);
    const context = this.canvas.getContext("2d");
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.drawImage(this.layer, 0, 0);
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    this.scaleBar(context, cssWidth, cssHeight);
    if (this.drawing?.length) {
      this.place(context, ratio);
      this.path(context, this.drawing, false);
      context.strokeStyle = "#fff";
      context.lineWidth = 3 / this.scale;
      context.stroke();
      context.setTransform(ratio, 0, 0, ratio, 0, 0);
    }
    const s = this.state;
    if (!s || s.master_age_s < 0) return;
    const at = (x, y) => [cssWidth / 2 + (x - this.centre.x) * this.scale, cssHeight / 2 - (y - this.centre.y) * this.scale];
    if (s.mode >= 2 && s.mode <= 3) this.activeCircle(context, at, s);
    const tool = at(s.tool_x_m, s.tool_y_m);
    if (pull) {
      const to = at(pull.x, pull.y);
      context.strokeStyle = context.fillStyle = "#fff";
      context.lineWidth = 2.5;
      context.beginPath();
      context.moveTo(...tool); context.lineTo(...to);
      context.stroke();
      context.beginPath();
      context.arc(...to, 6, 0, 7);
      context.fill();
    }
    if (s.slave_age_s >= 0) {
      const slave = at(s.slave_x_m, s.slave_y_m);
      if (s.laser_on) {
        const glow = context.createRadialGradient(...slave, 2, ...slave, 24);
        glow.addColorStop(0, "rgb(255 250 220 / .95)");
        glow.addColorStop(0.3, "rgb(255 170 30 / .7)");
        glow.addColorStop(1, "rgb(255 140 0 / 0)");
        context.fillStyle = glow;
        context.beginPath(); context.arc(...slave, 24, 0, 7); context.fill();
      }
      this.outlined(context, kColour.slave, () => { context.arc(...slave, 6, 0, 7); }, true);
      if (s.mode === 3) {
        const [x, y] = at(s.predicted_x_m, s.predicted_y_m);
        this.outlined(context, kColour.predicted, () => {
          context.moveTo(x, y - 10); context.lineTo(x + 10, y); context.lineTo(x, y + 10); context.lineTo(x - 10, y); context.closePath();
        });
      }
    }
    this.outlined(context, kColour.tool, () => { context.arc(...tool, 14, 0, 7); });
  }

  outlined(context, colour, path, fill = false) {
    context.beginPath();
    path();
    context.strokeStyle = "#111";
    context.lineWidth = fill ? 3 : 6;
    context.stroke();
    if (fill) { context.fillStyle = colour; context.fill(); return; }
    context.strokeStyle = colour;
    context.lineWidth = 3.2;
    context.stroke();
  }

  activeCircle(context, at, s) {
    context.strokeStyle = "rgb(255 255 255 / .85)";
    context.lineWidth = 1.5;
    context.setLineDash([6, 6]);
    context.beginPath();
    const radius = s.circle_radius_m * this.scale;
    if (!s.circle_is_line && radius < 1e5) context.arc(...at(s.circle_x_m, s.circle_y_m), radius, 0, 7);
    context.stroke();
    context.setLineDash([]);
  }
}
