// The page: one stream of events for all numbers, the bar on top, the views, and what is selected.
"use strict";
import { Graph } from "./graph.js";
import { DronePanel, EdgePanel } from "./panels.js";
import { LiveImage, duration, element, mood, per_second, percent, write } from "./parts.js";

const at = id => document.getElementById(id);
const shown_at_once = 24;  // images
let swarm = { drones: [], edges: [], bar: {} };
let view = "graph", panel = null, selected = null, stream = null, version = null;
const walls = new Map();  // live images by output
const graph = new Graph(at("graph"), select, at("rates"));

// --- what is selected ---

function select(what) {
  close_panel();
  const edge = what.edge && swarm.edges.find(each => each.id === what.edge);
  if (what.edge && !edge) return;
  selected = what;
  const page = { close: close_and_return, select, swarm: () => swarm, may_change };
  panel = edge ? new EdgePanel(edge, page) : new DronePanel(what.drone, page);
  at("panel").replaceChildren(...panel.all);
  at("panel").hidden = false;
  at("panel").scrollTop = 0;
  panel.start();
  panel.head.querySelector("button").focus({ preventScroll: true });
  graph.mark(selected);
}

function close_panel() {
  panel?.stop();
  panel = selected = null;
  at("panel").hidden = true;
  at("panel").replaceChildren();
  graph.mark(null);
}

function close_and_return() {
  const drone = selected?.drone;
  close_panel();
  document.getElementById("drone:" + drone)?.focus({ preventScroll: true });
}

/// Drones of other machines refuse holders of a viewer's key.
function may_change(name) {
  return !swarm.bar.viewer || swarm.drones.some(drone => drone.name === name && drone.host === "local");
}

// --- the bar ---

function show_bar({ verdict, clean, silent, worst, machines, clocks, viewer }) {
  at("verdict").className = "chip " + (clean && !silent.length ? "good" : "bad");
  write(at("verdict"), verdict + (silent.length ? `, ${silent.length} silent` : ""));
  const said = JSON.stringify([worst, swarm.drones.length > 0]);
  if (at("worst").dataset.said !== said) {
    at("worst").dataset.said = said;
    at("worst").className = worst ? (worst.blocks ? "bad" : "warn") : "";
    at("worst").replaceChildren(...worst ? [worst.text, ...worst.command ? [" – try ", element("code", { textContent: worst.command })] : []]
      : [swarm.drones.length ? "Nothing holds the drones up." : "No drone runs. Start one: hivectl start camera"]);
  }
  const offsets = new Map(clocks.map(clock => [clock.host, clock.offset_us]));
  const rows = machines.map(machine => {
    const clock = offsets.has(machine.host) ? `, clock ${duration(offsets.get(machine.host))}` : "";
    const count = machine.drones === 1 ? "1 drone" : machine.drones + " drones";
    return [machine.host, ` ${count}, processors busy ${percent(machine.busy_percent)}${clock}`];
  });
  if (at("machines").children.length !== rows.length)
    at("machines").replaceChildren(...rows.map(() => element("li", {}, element("b"), "")));
  rows.forEach(([host, text], i) => {
    write(at("machines").children[i].firstChild, host);
    at("machines").children[i].lastChild.data = text;
  });
  notice(viewer ? "This machine has a viewer's key: drones on other machines can be watched, not changed." : "");
}

function notice(text) {
  at("notice").hidden = text === "";
  write(at("notice"), text);
}

// --- the views ---

function fits(name) {
  const word = at("find").value.trim().toLowerCase();
  const drone = swarm.drones.find(each => each.name === name);
  return [name, drone?.kind, drone?.state, drone?.host].some(text => text?.toLowerCase().includes(word));
}

function table(title, heads, rows) {
  const cells = (name, row) => row.map(([text, kind], i) => element(name, { className: kind ?? "", scope: name === "th" ? "col" : "" },
    i === 0 && name === "td" ? row.button : String(text)));
  return element("table", {}, element("caption", { textContent: title }), element("thead", {}, element("tr", {}, ...cells("th", heads))),
    element("tbody", {}, ...rows.map(row => element("tr", {}, ...cells("td", row)))));
}

function row_of(id, what, cells) {
  const row = [["", ""], ...cells];
  row.button = element("button", { type: "button", id, textContent: id.slice(id.indexOf(":") + 1).replace(/>[^>]*$/, "").replace(">", " → "), onclick: () => select(what) });
  return row;
}

function show_list() {
  const focused = document.activeElement?.id;
  const right = text => [text, "number"];
  const drones = swarm.drones.filter(drone => fits(drone.name)).map(drone => row_of("row:" + drone.name, { drone: drone.name }, [
    [drone.kind || "application"], [drone.state + (drone.note ? ": " + drone.note : ""), mood(drone.state)], [drone.host],
    right(per_second(drone.in_per_s)), right(per_second(drone.out_per_s)), right(percent(drone.busy_percent)), right(duration(drone.age_us))]));
  const edges = swarm.edges.filter(edge => fits(edge.sender) || fits(edge.receiver)).map(edge => row_of("row:" + edge.id, { edge: edge.id }, [
    [edge.state + (edge.why ? ": " + edge.why.replaceAll("_", " ") : "")], [edge.group], right(per_second(edge.per_s)), right(duration(edge.age_us)),
    [edge.lost, edge.lost > 0 ? "number bad" : "number"]]));
  at("list").replaceChildren(
    table("Drones", [["name"], ["kind"], ["state"], ["machine"], right("in"), right("out"), right("busy"), right("age")], drones),
    table("Connections", [["connection"], ["state"], ["group"], right("rate"), right("age"), right("lost")], edges));
  if (focused?.startsWith("row:")) document.getElementById(focused)?.focus({ preventScroll: true });
}

/// The first 24 outputs that fit: an image that is not there costs its drone nothing.
function show_images() {
  const wanted = new Map();
  for (const drone of swarm.drones)
    for (const output of fits(drone.name) && !mood(drone.state) ? drone.images : [])
      if (wanted.size < shown_at_once) wanted.set(`${drone.name}.${output}`, drone.name);
  for (const [output, { image, figure }] of walls)
    if (!wanted.has(output)) {
      image.stop();
      figure.remove();
      walls.delete(output);
    }
  for (const [output, drone] of wanted) {
    if (walls.has(output)) continue;
    const image = new LiveImage(output, 320);
    const figure = element("figure", {}, image.box, element("figcaption", {},
      element("button", { type: "button", textContent: output, onclick: () => select({ drone }) })));
    walls.set(output, { image, figure });
    at("images").append(figure);
  }
  if (!walls.size) at("images").replaceChildren(element("p", { className: "empty", textContent: "No drone that fits has images." }));
  else at("images").querySelector(".empty")?.remove();
}

function stop_images() {
  for (const { image } of walls.values()) image.stop();
  walls.clear();
  at("images").replaceChildren();
}

function show_view() {
  if (view === "list") show_list();
  if (view === "images") show_images();
  if (view === "graph") graph.update(swarm);
}

function choose(next) {
  if (view === "images" && next !== "images") stop_images();
  view = next;
  for (const button of document.querySelectorAll("[data-view]")) button.setAttribute("aria-pressed", button.dataset.view === next);
  for (const id of ["graph", "list", "images"]) at(id).hidden = id !== next;
  at("zoom").hidden = at("rates").hidden = next !== "graph";
  show_view();
}

// --- the stream ---

function show(next) {
  if (version && version !== next.hivectl) location.reload();  // another hivectl has another page
  version = next.hivectl;
  swarm = next;
  for (const [rows, key] of [[swarm.drones, "name"], [swarm.edges, "id"]])
    rows.sort((a, b) => a[key].localeCompare(b[key], undefined, { numeric: true }));
  document.body.dataset.version = next.version;
  show_bar(next.bar);
  graph.load(next.drawing);
  show_view();
}

/// A browser closes the stream for good when it is refused, and goes on by itself when it ends. A page that is not seen
/// has none.
function listen() {
  if (document.hidden || stream) return;
  stream = new EventSource("/events");
  stream.onmessage = event => show(JSON.parse(event.data));
  stream.onerror = async () => {
    stop_listening();
    at("verdict").className = "chip warn";
    write(at("verdict"), "not connected");
    graph.version = null;  // another hivectl dash counts anew
    const answer = await fetch("/events", { method: "HEAD", cache: "no-store" }).catch(() => null);
    notice(answer?.status === 403 ? "Open the address that hivectl dash prints."
      : answer?.status === 405 ? "Connecting again. If this stays here, too many pages are open: close one."
      : "hivectl dash does not answer. The page goes on when it runs again.");
    setTimeout(listen, 1000);
  };
}
function stop_listening() {
  stream?.close();
  stream = null;
}

document.addEventListener("visibilitychange", () => document.hidden ? stop_listening() : listen());
for (const button of document.querySelectorAll("[data-view]")) button.onclick = () => choose(button.dataset.view);
at("find").oninput = () => { graph.mark(selected, at("find").value.trim() ? fits : null); show_view(); };
for (const button of document.querySelectorAll("[data-zoom]"))
  button.onclick = () => ({ in: () => graph.scale(1.25), out: () => graph.scale(.8), fit: () => graph.fit() })[button.dataset.zoom]();
document.addEventListener("keydown", event => {
  if (event.key === "Escape" && panel) close_and_return();
  if (event.key === "/" && !["INPUT", "SELECT"].includes(document.activeElement?.tagName)) {
    event.preventDefault();
    at("find").focus();
  }
});
listen();
