// The hand: pointer (mouse, pen, touch) and gamepad. What ends a hold is never an event alone: the receiver lets
// it run out after 0.1 s of silence.
const kHeld = 1, kTrigger = 2;
const kRepeat_ms = 20, kIdle_ms = 250;
const kPadSpeed_m_per_s = 0.04;
const kPress = 0.3;

export class Hand {
  constructor(link, stage) {
    this.link = link;
    this.stage = stage;      // {canvas, toWorld(x, y), toolWorld()}
    this.lease = 0;          // 0: this page does not drive
    this.sequence = 0;
    this.pointer = null;     // the one that pulls
    this.at = { x: 0, y: 0 };
    this.pressure = 0;
    this.held = false;
    this.pressed_ms = 0;     // when the hold began
    this.fire = false;       // button or key
    this.burnWhilePulling = false;
    this.burnByPressure = false;
    this.panning = false;    // dragging moves the picture
    this.device = "";
    this.pad = false;
    this.pad_ms = 0;
    const canvas = stage.canvas;
    const raw = "onpointerrawupdate" in canvas;
    canvas.addEventListener("pointerdown", (e) => this.down(e));
    canvas.addEventListener(raw ? "pointerrawupdate" : "pointermove", (e) => this.move(e));
    for (const end of ["pointerup", "pointercancel", "lostpointercapture"])
      canvas.addEventListener(end, (e) => { if (e.pointerId === this.pointer) this.release(); });
    canvas.addEventListener("contextmenu", (e) => { e.preventDefault(); this.release(); });
    for (const end of ["blur", "pagehide"]) window.addEventListener(end, () => this.release());
    for (const end of ["visibilitychange", "freeze"])
      document.addEventListener(end, () => { if (end === "freeze" || document.hidden) this.release(); });
    setInterval(() => this.repeat(), kRepeat_ms);
  }

  setLease(lease) {
    if (lease === this.lease) return;
    this.release();
    this.lease = lease;
    this.sequence = 0;
    this.send();
  }

  get trigger() {
    return this.fire || (this.held && (this.burnWhilePulling || (this.burnByPressure && this.pressure > kPress)));
  }

  down(e) {
    if (this.panning || e.button !== 0 || this.pointer !== null) {
      if (this.pointer !== null) this.release();  // a second finger: not a pull any more
      return;
    }
    if (!this.lease) return;
    try { this.stage.canvas.setPointerCapture(e.pointerId); } catch { /* gone already */ }
    this.pointer = e.pointerId;
    this.device = e.pointerType + (e.pointerType === "pen" ? (e.pressure > 0 ? ", pressure" : ", no pressure") : "");
    this.take(e);
    this.send(e.timeStamp);  // "released", once, before anything is held
    this.held = true;
    this.pressed_ms = performance.now();
    this.send(e.timeStamp);
  }

  take(e) {
    this.at = this.stage.toWorld(e.clientX, e.clientY);
    this.pressure = e.pointerType === "pen" ? e.pressure : 0;
  }

  move(e) {
    if (e.pointerId !== this.pointer || !this.held) return;
    const samples = e.type === "pointermove" && e.getCoalescedEvents ? e.getCoalescedEvents() : [];
    for (const sample of samples.length ? samples : [e]) {
      this.take(sample);
      this.send(sample.timeStamp);
    }
  }

  release() {
    const was = this.held || this.trigger;
    const pointer = this.pointer;
    this.held = this.fire = this.pad = false;
    this.pointer = null;
    this.pressure = 0;
    if (pointer !== null) try { this.stage.canvas.releasePointerCapture(pointer); } catch { /* lost */ }
    if (was) this.send();
  }

  setFire(on) {
    if (on === this.fire) return;
    this.fire = on && this.lease !== 0;
    this.send();
  }

  send(page_ms = performance.now()) {
    if (!this.lease) return;
    const flags = (this.held ? kHeld : 0) | (this.trigger ? kTrigger : 0);
    this.sent_ms = performance.now();
    this.link.frame(flags, ++this.sequence, page_ms, this.at.x, this.at.y, this.pressure, this.lease);
  }

  repeat() {
    const quiet = performance.now() - (this.sent_ms ?? 0);
    if (quiet >= (this.held || this.trigger ? kRepeat_ms - 4 : kIdle_ms)) this.send();
  }

  // Once a drawn frame. Shoulder button holds, right trigger fires, the left stick leads the pointer.
  poll(now_ms) {
    const pad = [...(navigator.getGamepads?.() ?? [])].find((p) => p?.connected);
    const pressed = (n) => Boolean(pad?.buttons[n]?.pressed);
    if (!pad || !this.lease || !(pressed(4) || pressed(5))) {
      if (this.pad) this.release();
      return;
    }
    const dt = Math.min(0.1, (now_ms - this.pad_ms) / 1000);
    this.pad_ms = now_ms;
    if (!this.pad) {
      if (this.held) return;
      this.at = this.stage.toolWorld();
      this.device = "gamepad";
      this.send();
      this.pad = this.held = true;
      this.pressed_ms = performance.now();
      return;
    }
    const stick = (n) => (Math.abs(pad.axes[n] ?? 0) > 0.12 ? pad.axes[n] : 0);
    this.at = { x: this.at.x + stick(0) * kPadSpeed_m_per_s * dt, y: this.at.y - stick(1) * kPadSpeed_m_per_s * dt };
    this.fire = pressed(7);
    this.send();
  }
}
