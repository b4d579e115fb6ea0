"use strict";
const shared = JSON.parse(document.getElementById("shared").textContent);
const MAP = bytesOf(shared.map);
const SUPPLIES = shared.supplies.map(rgbOf);
const still = window.matchMedia("(prefers-reduced-motion: reduce)");
const viewers = [];

function rgbOf(text) {
  const value = text.trim().replace("#", "");
  return [0, 2, 4].map((k) => parseInt(value.slice(k, k + 2), 16) / 255);
}

class Viewer {
  constructor(root) {
    this.root = root;
    this.stage = root.querySelector(".stage");
    this.state = root.querySelector(".state");
    this.sliders = [...root.querySelectorAll("input[type=range]")];
    this.levels = root.dataset.levels.split(" ").map(Number);
    this.packed = JSON.parse(root.querySelector(".shapes").textContent);
    this.camera = new Camera(this.packed);
    this.drawing = null;
    this.pointers = new Map();
    this.fixFrame();
    this.legend();
    this.listen();
    new IntersectionObserver((seen) => {
      this.isSeen = seen.some((one) => one.isIntersecting);
      if (this.isSeen) this.begin();
    }, { rootMargin: "200px" }).observe(root);
  }

  // The frame that holds every shape, so that nothing jumps between pressures.
  fixFrame() {
    const { offset, step, centroid, radius } = this.packed;
    this.middle = [...centroid];
    this.reach = Math.max(step * 65535, 2 * centroid[2], 2 * radius) * 0.62;
    this.middle[2] = Math.max(centroid[2], (offset[2] + step * 65535) / 2.6);
  }

  begin() {
    if (this.drawing || this.failed) return;
    const live = viewers.filter((one) => one.drawing);
    const away = live.filter((one) => !one.isSeen);
    if (live.length >= MOST_CONTEXTS && away.length) away[0].end();
    try {
      this.model = this.model || decodeModel(this.packed);
      this.canvas = this.stage.querySelector("canvas");
      this.stage.classList.add("live");
      this.drawing = new Drawing(this.canvas, this.packed, this.model, MAP);
    } catch (error) {
      this.failed = true;
      this.stage.classList.remove("live");
      return;
    }
    this.shown = null;
    this.canvas.addEventListener("webglcontextlost", (event) => {
      if (this.drawing && event.target === this.canvas) this.giveUp(); // not one that was given back
    });
    this.pick();
  }

  // The browser took the context away: the still picture takes the model's place.
  giveUp() {
    cancelAnimationFrame(this.frame);
    this.drawing = null;
    this.failed = true;
    this.stage.classList.remove("live");
  }

  // A lost context does not come back: a new canvas takes the old one's place.
  end() {
    this.drawing.release();
    this.drawing = null;
    const fresh = this.canvas.cloneNode(false);
    this.canvas.replaceWith(fresh);
    this.canvas = fresh;
    this.turnable();
  }

  legend() {
    const [low, high] = this.packed.stretch;
    const texts = [low, (low + high) / 2, high].map((one) => one.toFixed(high - low < 0.2 ? 3 : 2));
    [".low", ".mid", ".high"].forEach((name, k) => { this.stage.querySelector(name).textContent = texts[k]; });
    const pen = this.stage.querySelector(".ramp").getContext("2d");
    const image = pen.createImageData(256, 1);
    for (let k = 0; k < 256; k++) image.data.set([MAP[3 * k], MAP[3 * k + 1], MAP[3 * k + 2], 255], 4 * k);
    pen.putImageData(image, 0, 0);
  }

  get row() {
    const [a, b, c] = this.sliders.map((one) => Number(one.value));
    return this.levels.length ** 2 * a + this.levels.length * b + c;
  }

  choose(row) {
    const n = this.levels.length;
    [Math.floor(row / (n * n)), Math.floor(row / n) % n, row % n].forEach((level, k) => {
      this.sliders[k].value = level;
    });
    this.pick();
  }

  pick() {
    this.sliders.forEach((slider) => {
      const text = `${this.levels[Number(slider.value)]} kPa`;
      slider.setAttribute("aria-valuetext", text);
      slider.parentNode.querySelector("output").textContent = text;
    });
    const row = this.row;
    this.state.textContent = this.packed.said[row];
    this.state.classList.toggle("unanswered", !this.packed.answered[row]);
    for (const line of document.querySelectorAll(`[data-viewer="${this.root.id}"] tr[data-row]`)) {
      line.classList.toggle("current", Number(line.dataset.row) === row);
    }
    this.moveTo(Math.max(this.packed.of[row], -1));
  }

  moveTo(place) {
    if (!this.drawing) return;
    cancelAnimationFrame(this.frame); // else a shape that is still moving comes back
    if (place < 0) { // nothing to see: the undeformed body, its outline only
      this.shown = null;
      this.render();
      return;
    }
    const to = this.model.shapes[place], from = this.shown || to;
    const began = performance.now(), lasts = still.matches || !this.shown || from === to ? 0 : 320;
    const step = (now) => {
      const share = lasts ? Math.min(1, Math.max(0, (now - began) / lasts)) : 1;
      const eased = share * share * (3 - 2 * share);
      this.shown = share >= 1 ? to : {
        at: mixed(from.at, to.at, eased), normals: mixed(from.normals, to.normals, eased),
        levels: mixed(from.levels, to.levels, eased), line: mixed(from.line, to.line, eased),
      };
      if (this.drawing) {
        this.drawing.shape(this.shown.at, this.shown.normals, this.shown.levels, this.shown.line);
        this.render();
      }
      if (share < 1) this.frame = requestAnimationFrame(step);
    };
    step(began);
  }

  render() {
    if (!this.drawing) return;
    const scale = Math.min(window.devicePixelRatio || 1, 2);
    const width = Math.round(this.canvas.clientWidth * scale);
    const height = Math.round(this.canvas.clientHeight * scale);
    if (!width || !height) return;
    if (this.canvas.width !== width || this.canvas.height !== height) {
      this.canvas.width = width;
      this.canvas.height = height;
    }
    const colour = (name) => rgbOf(getComputedStyle(this.root).getPropertyValue(name));
    const ground = colour("--stage"), ink = colour("--ink");
    const is = (name) => this.root.querySelector(`[data-show=${name}]`).checked;
    const look = {
      ground, ink, plate: ground.map((one, k) => 0.86 * one + 0.14 * ink[k]), colours: SUPPLIES,
      solid: Boolean(this.shown),
      beam: is("beam"), ghost: is("ghost"), open: is("open"), supplies: is("supplies"),
    };
    this.stage.classList.toggle("by-supply", look.supplies);
    const { eye, turn } = this.camera.matrices(width / height, this.middle, this.reach);
    this.drawing.render(eye, turn, look);
  }

  listen() {
    for (const slider of this.sliders) slider.addEventListener("input", () => this.pick());
    for (const box of this.root.querySelectorAll("[data-show]")) box.addEventListener("change", () => this.render());
    const press = (name, act) => this.root.querySelector(name).addEventListener("click", () => { act(); this.render(); });
    press(".nearer", () => this.camera.nearer(1.25));
    press(".farther", () => this.camera.nearer(0.8));
    press(".reset", () => this.camera.reset());
    this.canvas = this.stage.querySelector("canvas");
    this.turnable();
    new ResizeObserver(() => this.render()).observe(this.stage);
  }

  turnable() {
    const canvas = this.canvas, pointers = this.pointers;
    const apart = () => {
      const [a, b] = [...pointers.values()];
      return Math.hypot(a.x - b.x, a.y - b.y) || 1;
    };
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    });
    canvas.addEventListener("pointermove", (event) => {
      const last = pointers.get(event.pointerId);
      if (!last) return;
      const before = pointers.size === 2 ? apart() : 0;
      const [dx, dy] = [event.clientX - last.x, event.clientY - last.y];
      [last.x, last.y] = [event.clientX, event.clientY];
      if (pointers.size === 1) this.camera.turnBy(0.009 * dx, 0.009 * dy);
      else if (pointers.size === 2) this.camera.nearer(apart() / before);
      this.render();
    });
    for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, (event) => pointers.delete(event.pointerId));
    canvas.addEventListener("wheel", (event) => { // else the page could not be scrolled past it
      if (document.activeElement !== canvas && !event.ctrlKey) return;
      event.preventDefault();
      this.camera.nearer(Math.exp(-0.0015 * event.deltaY));
      this.render();
    }, { passive: false });
    canvas.addEventListener("keydown", (event) => {
      const acts = {
        ArrowLeft: () => this.camera.turnBy(-0.12, 0), ArrowRight: () => this.camera.turnBy(0.12, 0),
        ArrowUp: () => this.camera.turnBy(0, -0.12), ArrowDown: () => this.camera.turnBy(0, 0.12),
        "+": () => this.camera.nearer(1.25), "=": () => this.camera.nearer(1.25),
        "-": () => this.camera.nearer(0.8), 0: () => this.camera.reset(),
      };
      if (!acts[event.key] || event.ctrlKey || event.metaKey || event.altKey) return;
      event.preventDefault();
      acts[event.key]();
      this.render();
    });
  }
}

function themeButton() {
  const button = document.getElementById("theme"), root = document.documentElement;
  const prefers = window.matchMedia("(prefers-color-scheme: dark)");
  const isDark = () => (root.dataset.theme || (prefers.matches ? "dark" : "light")) === "dark";
  const tell = () => {
    button.textContent = isDark() ? "Light" : "Dark";
    button.setAttribute("aria-pressed", String(isDark()));
    viewers.forEach((one) => one.render());
  };
  button.addEventListener("click", () => {
    root.dataset.theme = isDark() ? "light" : "dark";
    tell();
  });
  prefers.addEventListener("change", tell);
  tell();
}

function sortable(table) {
  const body = table.tBodies[0], first = [...body.rows];
  const value = (row, column) => {
    const text = row.cells[column].textContent.trim().replaceAll("−", "-").replaceAll(",", "");
    const found = parseFloat(text);
    return Number.isNaN(found) ? Infinity : found;
  };
  [...table.tHead.rows[0].cells].forEach((head, column) => {
    const button = document.createElement("button");
    button.type = "button";
    button.append(...head.childNodes);
    head.append(button);
    button.addEventListener("click", () => {
      const up = head.getAttribute("aria-sort") !== "ascending";
      for (const other of table.tHead.rows[0].cells) other.removeAttribute("aria-sort");
      head.setAttribute("aria-sort", up ? "ascending" : "descending");
      const isText = column === 1;
      const text = (row) => row.cells[column].textContent;
      const order = [...first].sort((a, b) => {
        if (column === 0) return Number(a.dataset.row) - Number(b.dataset.row);
        if (isText) return text(a) < text(b) ? -1 : text(a) > text(b) ? 1 : 0;
        return value(a, column) - value(b, column) || 0;
      });
      body.append(...(up ? order : order.reverse()));
    });
  });
}

for (const root of document.querySelectorAll(".viewer")) viewers.push(new Viewer(root));
themeButton();
for (const table of document.querySelectorAll(".sortable")) sortable(table);
document.addEventListener("click", (event) => {
  const show = event.target.closest(".show");
  if (show) {
    const root = document.getElementById(show.closest("table").dataset.viewer);
    viewers.find((one) => one.root === root).choose(Number(show.closest("tr").dataset.row));
    root.scrollIntoView({ block: "center", behavior: still.matches ? "auto" : "smooth" });
  }
  const save = event.target.closest(".save");
  if (save) {
    const link = document.createElement("a");
    link.href = save.closest("figure").querySelector("img").src;
    link.download = save.dataset.name;
    link.click();
  }
});
window.addEventListener("beforeprint", () => {
  for (const one of document.querySelectorAll("details")) one.open = true;
});
