// The graph that Graphviz has laid out: loaded when it changes, and filled with the numbers of each second.
"use strict";
import { duration, known, mood, per_second, write } from "./parts.js";

const max_labels = 24;  // of a graph that has no room for all

export class Graph {
  /// @param note  says which rates are shown if not all are
  constructor(place, select, note) {
    this.place = place;
    this.select = select;
    this.note = note;
    this.version = 0;
    this.zoom = 0;  // 0: as it fits
    place.addEventListener("wheel", event => {
      if (!event.ctrlKey) return;
      event.preventDefault();
      this.scale(event.deltaY < 0 ? 1.15 : 1 / 1.15);
    }, { passive: false });
    new ResizeObserver(() => this.resize()).observe(place);
  }

  async load(version) {
    if (version === this.version || this.loading) return;
    this.loading = true;
    try {
      const answer = await fetch("/graph.svg", { cache: "no-store" });
      const text = await answer.text();
      if (answer.ok) this.show(text);
      else this.place.replaceChildren(document.createTextNode(text + " The tab List has all drones."));
      this.version = version;
    } catch { /* it is loaded with the next numbers */ }
    this.loading = false;
    if (this.swarm) this.update(this.swarm);
  }

  show(text) {
    const svg = document.importNode(new DOMParser().parseFromString(text, "image/svg+xml").documentElement, true);
    this.size = { width: svg.viewBox.baseVal.width, height: svg.viewBox.baseVal.height };
    this.nodes = new Map(), this.edges = new Map();
    const focused = document.activeElement?.id;
    for (const node of svg.querySelectorAll("g.drone")) this.prepare_drone(node);
    for (const edge of svg.querySelectorAll("g.edge[id^='edge:']")) this.prepare_edge(edge);
    for (const title of svg.querySelectorAll("svg > g > title, g.cluster > title")) title.remove();
    svg.setAttribute("role", "group");
    svg.setAttribute("aria-label", "Drones; arrow keys go from one to the next");
    this.svg = svg;
    this.place.replaceChildren(svg);
    const first = this.nodes.values().next().value;
    first?.node.setAttribute("tabindex", "0");
    if (focused && svg.getElementById(focused)) svg.getElementById(focused).focus();
    this.resize();
  }

  prepare_drone(node) {
    const [name, detail] = node.querySelectorAll("text");
    detail?.classList.add("detail");
    node.setAttribute("role", "button");
    node.setAttribute("tabindex", "-1");
    const drone = node.id.slice("drone:".length);
    node.onclick = () => this.select({ drone });
    node.onkeydown = event => this.key(event, node, { drone });
    this.nodes.set(drone, { node, name, detail, title: node.querySelector("title") });
  }

  prepare_edge(edge) {
    const line = edge.querySelector("path"), near = line.cloneNode();
    near.classList.add("near");  // wide and transparent, so that it is easily hit
    line.after(near);
    const id = edge.id.slice("edge:".length);
    edge.onclick = () => this.select({ edge: id });
    const [label, age] = edge.querySelectorAll("text");
    this.edges.set(id, { node: edge, line, label, age, bare: !label, title: edge.querySelector("title") });
  }

  /// Enter selects; an arrow goes to the nearest drone in its direction.
  key(event, node, what) {
    const way = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
    if (event.key === "Enter" || event.key === " ") this.select(what);
    else if (way) this.go(node, way);
    else return;
    event.preventDefault();
  }
  go(from, [x, y]) {
    const middle = node => { const box = node.getBoundingClientRect(); return [box.x + box.width / 2, box.y + box.height / 2]; };
    const [left, top] = middle(from);
    let nearest = null, best = Infinity;
    for (const { node } of this.nodes.values()) {
      const [dx, dy] = [middle(node)[0] - left, middle(node)[1] - top];
      const ahead = dx * x + dy * y, aside = Math.abs(dx * y) + Math.abs(dy * x);
      if (node !== from && ahead > 1 && ahead + 2 * aside < best) [nearest, best] = [node, ahead + 2 * aside];
    }
    if (!nearest) return;
    from.setAttribute("tabindex", "-1");
    nearest.setAttribute("tabindex", "0");
    nearest.focus();
  }

  update(swarm) {
    this.swarm = swarm;
    if (!this.svg) return;
    for (const drone of swarm.drones) {
      const parts = this.nodes.get(drone.name);
      if (!parts) continue;
      const calm = !mood(drone.state);
      const rate = Math.max(drone.in_per_s ?? 0, drone.out_per_s ?? 0);
      const detail = !drone.kind && !drone.state ? "application"
        : drone.kind + (drone.kind ? ", " : "") + (calm && known(drone.in_per_s) ? per_second(rate) : drone.state);
      write(parts.detail, detail);
      parts.node.classList.toggle("warn", mood(drone.state) === "warn" || (calm && !!drone.note));
      parts.node.classList.toggle("bad", mood(drone.state) === "bad");
      parts.node.classList.toggle("application", !drone.host);
      const said = `${drone.name}, ${detail}` + (drone.note ? ", " + drone.note : "");
      if (parts.node.getAttribute("aria-label") !== said) parts.node.setAttribute("aria-label", said);
      write(parts.title, said);
    }
    this.label_busiest(swarm.edges);
    for (const edge of swarm.edges) this.update_edge(edge);
    this.mark();
  }

  /// If the drawing has no room for labels, connections that lose events get them, then those with the highest rates. Rates are
  /// rounded, so that labels do not change places each second.
  label_busiest(edges) {
    const bare = edges.filter(edge => this.edges.get(edge.id)?.bare);
    const rank = edge => (edge.losing ? 1e9 : 0) + Math.round(edge.per_s ?? 0);
    const busiest = new Set([...bare].sort((one, other) => rank(other) - rank(one)).slice(0, max_labels));
    for (const edge of bare) {
      const parts = this.edges.get(edge.id);
      if (!busiest.has(edge)) {
        parts.label?.remove();
        parts.label = null;
      } else if (!parts.label) {
        const middle = parts.line.getPointAtLength(parts.line.getTotalLength() / 2);
        parts.label = document.createElementNS(this.svg.namespaceURI, "text");
        for (const [name, value] of [["x", middle.x], ["y", middle.y], ["text-anchor", "middle"]]) parts.label.setAttribute(name, value);
        parts.node.append(parts.label);
      }
    }
    write(this.note, bare.length > max_labels ? `Rates of the ${max_labels} busiest of ${edges.length} connections; List has all.` : "");
  }

  update_edge(edge) {
    const parts = this.edges.get(edge.id);
    if (!parts) return;
    const lost = edge.lost > 0 ? `, ${edge.lost} lost` : "";
    const text = per_second(edge.per_s) + (edge.group ? ` ${edge.group}` : "") + lost;
    const is_connected = edge.state === "connected" && known(edge.age_us);
    if (parts.label) write(parts.label, parts.bare && is_connected ? `${text}, ${duration(edge.age_us)}` : text);
    if (parts.age) write(parts.age, is_connected ? duration(edge.age_us) : "");
    parts.node.classList.toggle("bad", edge.verdict !== "ok" || edge.losing);
    parts.node.classList.toggle("idle", edge.state !== "connected");
    write(parts.title, `${edge.from} to ${edge.to}: ${text}, age ${duration(edge.age_us)}`);
  }

  mark(selected = this.selected, fits = this.fits) {
    this.selected = selected;
    this.fits = fits;
    for (const [name, { node }] of this.nodes ?? []) {
      node.classList.toggle("selected", selected?.drone === name);
      node.classList.toggle("dim", !!fits && !fits(name));
    }
    for (const [id, { node }] of this.edges ?? []) {
      node.classList.toggle("selected", selected?.edge === id);
      node.classList.toggle("dim", !!fits && !id.split(">").slice(0, 2).some(end => fits(end.slice(0, end.lastIndexOf(".")))));
    }
  }

  /// As large as the view, but texts stay legible: what is larger then is scrolled.
  fitting() {
    const room = { width: this.place.clientWidth - 32, height: this.place.clientHeight - 32 };
    const fits = Math.min(room.width / this.size.width, room.height / this.size.height);
    return Math.min(1.6, Math.max(.75, fits));
  }
  scale(factor) {
    if (!this.svg) return;
    this.zoom = Math.min(4, Math.max(.1, (this.zoom || this.fitting()) * factor));
    this.resize();
  }
  fit() { this.zoom = 0; this.resize(); }
  resize() {
    if (!this.svg || !this.place.clientWidth) return;
    const scale = this.zoom || this.fitting();
    this.svg.setAttribute("width", Math.round(this.size.width * scale));
    this.svg.setAttribute("height", Math.round(this.size.height * scale));
  }
}
