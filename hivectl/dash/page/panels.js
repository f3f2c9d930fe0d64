// The panels of one drone and of one connection.
"use strict";
import { Advice } from "./advice.js";
import { exception_rows } from "./exceptions.js";
import { LiveImage, ask, careful_button, duration, element, error_text, known, line_of, order, path, per_second, percent, runs,
         write } from "./parts.js";

const every_ms = 2000;

/// What both have: a title, a place for answers, and a look at the server every two seconds while the page is seen.
class Panel {
  constructor(title, close) {
    this.facts = element("p", { className: "facts" });
    this.answer = element("p", { role: "status", className: "answer" });
    this.body = element("div");
    this.head = element("div", { className: "title" }, element("h2", { textContent: title }),
      element("button", { type: "button", textContent: "×", "aria-label": "Close", onclick: close }));
  }
  start() {
    const look = async () => {
      if (!document.hidden) await this.refresh();
      if (!this.stopped) this.timer = setTimeout(look, every_ms);  // a drone that does not answer is not asked twice
    };
    look();
  }
  stop() {
    this.stopped = true;
    clearTimeout(this.timer);
  }
  say(result, done) {
    this.answer.className = "answer " + (result.error ? "bad" : "good");
    write(this.answer, result.error ? error_text(result.error) : done);
  }
  async act(what, done) {
    write(this.answer, "…");
    this.say(await order(what), done);
    this.refresh();
  }
}

/// One parameter with its control. The control shows what the drone has, or what is on its way to it.
class Parameter {
  constructor(drone, info) {
    this.drone = drone;
    this.info = info;
    this.answer = element("small", { className: "answer", role: "status" });
    const id = "parameter-" + info.name;
    this.make_control(id);
    const range = known(info.min) && known(info.max) ? `${info.min} to ${info.max}, ` : known(info.min) ? `from ${info.min}, ` : "";
    const shown = info.default === "" ? "empty" : JSON.stringify(info.default)?.replace(/^"|"$/g, "");
    const hint = element("small", { textContent: `${info.help ? info.help + "; " : ""}${range}default ${shown}`, id: id + "-hint" });
    this.control.setAttribute("aria-describedby", hint.id);
    this.row = element("div", { className: "parameter", "data-parameter": info.name },
      element("label", { htmlFor: id, textContent: info.name + (info.unit ? ` (${info.unit})` : "") }),
      element("div", { className: "control" }, ...this.controls), hint, this.answer);
  }

  make_control(id) {
    const { type, min, max, choices } = this.info, number = type === "integer" || type === "number";
    if (type === "flag") this.control = element("input", { type: "checkbox", id, role: "switch" });
    else if (choices?.length) this.control = element("select", { id }, ...choices.map(word => element("option", { textContent: word })));
    else this.control = element("input", { type: number ? "number" : "text", id, step: type === "integer" ? 1 : "any" });
    this.controls = [this.control];
    if (number && known(min)) this.control.min = min;
    if (number && known(max)) this.control.max = max;
    this.control.oninput = () => { this.edited = true; };
    this.control.onblur = () => { this.edited = false; };
    this.control.onchange = () => this.send(this.value());
    if (number && known(min) && known(max)) {
      this.slider = element("input", { type: "range", min, max, step: type === "integer" ? 1 : "any", "aria-label": this.info.name });
      this.slider.oninput = () => { this.control.value = this.rounded(this.slider.valueAsNumber); this.send(Number(this.control.value)); };
      this.controls.unshift(this.slider);
    }
  }
  rounded(value) {
    const { type, min, max } = this.info;
    if (type === "integer") return value;
    return Number(value.toFixed(Math.max(0, 3 - Math.floor(Math.log10(max - min || 1)))));
  }
  value() {
    const { type } = this.info;
    return type === "flag" ? this.control.checked : type === "text" ? this.control.value : this.control.valueAsNumber;
  }

  /// One set at a time; of a slider that moves on meanwhile, the last value is sent next.
  async send(value) {
    this.next = value;
    if (this.sending) return;
    this.sending = true;
    while (this.next !== undefined) {
      const sent = this.next;
      this.next = undefined;
      const result = await order({ do: "set", drone: this.drone, values: { [this.info.name]: sent } });
      this.answer.className = "answer " + (result.error ? "bad" : "good");
      const applied = result.values?.[this.info.name];
      write(this.answer, result.error ? error_text(result.error) : applied === sent ? "" : "the drone applied " + applied);
      if (this.next === undefined) this.show(result.error ? this.present : applied, true);
    }
    this.sending = false;
  }

  show(value, answered = false) {
    this.present = value;
    const busy = (this.sending || this.edited || (this.slider && document.activeElement === this.slider)) && !answered;
    if (busy || value === undefined) return;
    this.edited = false;
    if (this.info.type === "flag") this.control.checked = value;
    else this.control.value = value;
    if (this.slider) this.slider.value = value;
  }
  enable(possible) { for (const control of this.controls) control.disabled = !possible; }
}

export class DronePanel extends Panel {
  /// @param page  close(), select(what), and the swarm with its edges
  constructor(name, page) {
    super(name, page.close);
    this.name = name;
    this.page = page;
    this.images = element("div");
    this.lines = element("div");
    this.edges = element("ul");
    this.parameters = element("div");
    this.exceptions = element("ul", { className: "exceptions" });
    this.log = element("pre", { tabIndex: 0, "aria-label": "Log of " + name });
    this.buttons = element("div", { className: "row" });
    for (const [what, name_shown] of [["halt", "Halt"], ["resume", "Resume"]])
      this.buttons.append(element("button", { type: "button", textContent: name_shown, onclick: () => this.act({ do: what, drone: name }, "done") }));
    this.buttons.append(
      careful_button("Replace", `Replace ${name} by a new process?`, () => this.act({ do: "replace", drone: name }, "replaced")),
      careful_button("Stop", `Stop ${name}?`, () => this.act({ do: "stop", drone: name }, "stopped")));
    const part = (title, node) => element("section", {}, element("h3", { textContent: title }), node);
    this.advice = part("Advice", new Advice(name).all);
    this.advice.hidden = true;  // until it receives
    this.all = [this.head, this.facts, this.buttons, this.answer, this.images, this.lines, part("Parameters", this.parameters),
      part("Connections", this.edges), this.advice, part("Exceptions", this.exceptions), part("Log", this.log)];
  }

  stop() {
    super.stop();
    this.image?.stop();
  }

  async refresh() {
    const [details, asked] = await Promise.all([ask(path("drone", this.name)), ask(path("ask", this.name))]);
    if (details?.error) return this.say(details);
    if (!details) {
      write(this.facts, "this drone does not run");
      return this.hide_images();
    }
    this.show_details(details);
    this.show_edges();
    this.show_exceptions(details, asked.failures ?? []);
    if (asked.error) return write(this.log, error_text(asked.error));
    this.show_parameters(asked);
    this.show_log(asked.log ?? asked.log_problem);
  }

  show_details({ drone, pid, version, uptime_us, per_s, busy_percent }) {
    const parts = [drone.kind, drone.state, drone.host, ...runs(drone) ? [`process ${pid}`, `up ${duration(uptime_us)}`] : [],
      version && `Hive ${version}`];
    write(this.facts, parts.filter(Boolean).join(" · ") + (drone.note ? `. ${drone.note}` : ""));
    if (runs(drone)) this.show_images(drone);
    else this.hide_images();
    const line = (name, values, top, text) => element("div", { className: "line" },
      element("span", { textContent: name }), line_of(values, top), element("b", { textContent: text }));
    this.lines.replaceChildren(line("events", per_s, 1, per_second(per_s.at(-1))),
      line("busy", busy_percent, 100, percent(busy_percent.at(-1))));
  }

  /// Written only if they change: an image that is in place is not fetched again.
  show_exceptions({ exceptions, on_exception }, failures) {
    const key = JSON.stringify([exceptions, failures]);
    if (key === this.exceptions_shown) return;
    this.exceptions_shown = key;
    const opened = [...this.exceptions.querySelectorAll("details[open]")].map(each => each.id);
    const rows = exception_rows(this.name, exceptions, failures, opened);
    this.exceptions.replaceChildren(...rows.length ? rows : [`none; on an exception: ${on_exception}`]);
  }

  /// A source on demand that nobody receives would produce for the page alone, so its image is shown only if asked for.
  show_images(drone) {
    const names = [...drone.images, ...drone.held];
    if (this.image || !names.length) return;
    const box = element("div"), first = names[0], show = name => {
      this.image?.stop();
      this.image = new LiveImage(`${this.name}.${name}`, 640);
      box.replaceChildren(this.image.box);
    };
    if (drone.held.includes(first)) {
      if (this.images.children.length) return;
      box.append(element("button", { type: "button", textContent: "Show images; this takes events from the source", onclick: () => show(first) }));
    } else show(first);
    const choice = element("select", { "aria-label": "Output", onchange: () => show(choice.value) },
      ...names.map(name => element("option", { textContent: name })));
    this.images.replaceChildren(...names.length > 1 ? [choice] : [], box);
  }
  hide_images() {
    this.image?.stop();
    this.image = null;
    this.images.replaceChildren();
  }

  show_edges() {
    const edges = this.page.swarm().edges.filter(edge => edge.sender === this.name || edge.receiver === this.name);
    this.advice.hidden = !edges.some(edge => edge.receiver === this.name);
    const key = JSON.stringify(edges.map(edge => [edge.id]));
    if (key === this.edges_shown) return;
    this.edges_shown = key;
    const rows = edges.map(edge => element("li", {}, element("button", {
      type: "button", textContent: `${edge.from} → ${edge.to}`, onclick: () => this.page.select({ edge: edge.id }) })));
    this.edges.replaceChildren(...rows.length ? rows : ["none"]);
  }

  /// A drone that crashed has none, and can only be stopped.
  show_parameters({ interface: offered, values }) {
    const parameters = offered?.parameters ?? [];
    const key = JSON.stringify(parameters);
    if (key !== this.parameters_shown) {
      this.parameters_shown = key;
      this.controls = parameters.map(info => new Parameter(this.name, info));
      this.parameters.replaceChildren(...this.controls.length ? this.controls.map(each => each.row) : ["none"]);
    }
    for (const control of this.controls) {
      control.show(values[control.info.name]);
      control.enable(this.page.may_change(this.name));
    }
    for (const button of this.buttons.querySelectorAll("button")) button.disabled = !this.page.may_change(this.name) || (!offered && !["Stop", "Cancel"].includes(button.textContent));
  }

  show_log(text) {
    if (text === this.log.textContent) return;
    const at_end = this.log.scrollTop + this.log.clientHeight >= this.log.scrollHeight - 4;
    write(this.log, text);
    if (at_end) this.log.scrollTop = this.log.scrollHeight;
  }
}

export class EdgePanel extends Panel {
  constructor(edge, page) {
    super(`${edge.from} → ${edge.to}`, page.close);
    this.edge = edge;
    this.page = page;
    this.why = element("p", { role: "status" });
    this.table = element("table", { className: "counts" });
    this.form = element("form", { className: "options", onsubmit: event => { event.preventDefault(); this.change(); } });
    const part = (title, node) => element("section", {}, element("h3", { textContent: title }), node);
    const drones = element("div", { className: "row" }, ...[edge.sender, edge.receiver].map(drone => element("button", {
      type: "button", textContent: drone, onclick: () => page.select({ drone }) })));
    this.all = [this.head, this.facts, drones, this.why, part("How events travel", this.form), this.answer,
      part("Account", this.table)];
  }

  async refresh() {
    const { edge } = this;
    const details = await ask(path("edge", edge.id));
    if (details?.error) return this.say(details);
    if (!details) return write(this.facts, "there is no such connection now");
    this.show(details);
    const receiver_runs = runs(this.page.swarm().drones.find(drone => drone.name === edge.receiver));
    if (receiver_runs) this.explain(await ask(path("why", edge.from, edge.to)));
    if (receiver_runs && !this.form.children.length) this.make_form(details.counts, await ask(path("ask", edge.sender)));
  }

  explain({ error, causes }) {
    if (error) return;
    const cause = causes[0];
    this.why.className = cause ? (cause.blocks ? "bad" : "warn") : "good";
    write(this.why, cause ? cause.text + (cause.evidence ? ` (${cause.evidence})` : "") + (cause.command ? `; try: ${cause.command}` : "")
      : "Nothing holds it up.");
  }

  show({ audit, counts }) {
    const state = [counts.state, counts.transfer, counts.group ? "group " + counts.group : "", "age " + duration(counts.age_us),
      known(counts.round_trip_us) ? "round trip " + duration(counts.round_trip_us) : "",
      known(counts.clock_offset_us) ? "clocks differ by " + duration(counts.clock_offset_us) : "", counts.way ? "by " + counts.way : "",
      counts.encoding ?? ""];
    write(this.facts, state.filter(Boolean).join(" · "));
    const promised = new Map(audit.losses.map(loss => [loss.fate, loss.promised]));
    const at_sender = ["came", "acknowledged", "skipped", "dropped", "passed_on", "abandoned", "lost_connection", "lost_killed",
      "lost_cut_off", "lost_left", "in_flight"];
    const at_receiver = ["received", "processed", "dropped_by_receiver", "abandoned_by_receiver", "unmatched", "duplicates", "discarded",
      "queued", "in_hand"];
    const row = (end, key) => element("tr", {}, element("td", { textContent: key.replaceAll("_", " ") }),
      element("td", { textContent: counts[key], className: "number" + (counts[key] > 0 && promised.get(key.replace("_by_receiver", "")) ? " bad" : "") }),
      element("td", { textContent: end }));
    const rows = [...at_sender.map(key => row(edge_end(audit.from), key)), ...at_receiver.map(key => row(edge_end(audit.to), key))]
      .filter(each => each.children[1].textContent !== "" && (each.children[1].textContent !== "0" || ["came", "received"].includes(each.firstChild.textContent)));
    const verdict = audit.differences.length ? audit.differences.join("; ") : audit.lost ? `${audit.lost} lost: ${audit.fates}` : "nothing lost";
    this.table.replaceChildren(element("caption", { textContent: verdict, className: audit.verdict === "ok" ? "good" : "bad" }),
      element("tbody", {}, ...rows));
  }

  make_form(counts, { interface: offered }) {
    const output = offered?.outputs.find(each => this.edge.from.endsWith("." + each.name));
    const select = (name, words) => element("select", { name }, ...words.map(([value, text]) => element("option", { value, textContent: text })));
    const window_box = element("input", { name: "window", type: "number", min: 1, max: 64, value: counts.window });
    const transfer = select("transfer", [["sync", "sync: the newest"], ["stream", "stream: every event"]]);
    const words = (output?.encodings ?? []).flatMap(({ word }) => word === "jpeg" ? ["jpeg", "jpeg:80", "jpeg:60", "jpeg:40"] : [word]);
    const encoding = select("encoding", [["=", `keep: ${counts.encoding ?? "default"}`], ["", "default"], ...words.map(word => [word, word])]);
    transfer.value = counts.transfer;
    const follow = () => { window_box.disabled = transfer.value === "stream"; };
    transfer.onchange = follow;
    transfer.disabled = !!counts.group;
    follow();
    const label = (text, control) => [element("label", { htmlFor: control.id = "edge-" + control.name, textContent: text }), control];
    this.form.replaceChildren(...label("Transfer", transfer), ...label("Window", window_box), ...label("Encoding", encoding), element("button", { textContent: "Change", disabled: !this.page.may_change(this.edge.receiver) }));
  }

  /// What is not chosen stays as it is.
  change() {
    const values = new FormData(this.form), what = { do: "connect", from: this.edge.from, to: this.edge.to };
    for (const key of ["transfer", "encoding"]) if (values.has(key) && values.get(key) !== "=") what[key] = values.get(key);
    if (values.has("window")) what.window = Number(values.get("window"));
    return this.act(what, "changed");
  }
}

const edge_end = end => end.slice(0, end.lastIndexOf("."));
