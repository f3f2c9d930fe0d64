// Shows the result of hivectl advise for a drone: where the time of its events goes, and commands that help.
"use strict";
import { ask, command_line, duration, element, error_text, path, per_second, write } from "./parts.js";

const goals = [["fps", "more events"], ["latency", "younger events"]];

export class Advice {
  constructor(drone) {
    this.drone = drone;
    this.goal = element("select", { "aria-label": "Goal" },
      ...goals.map(([value, text]) => element("option", { value, textContent: text })));
    this.status = element("p", { role: "status" });
    this.lines = element("div");
    const button = element("button", { type: "button", textContent: "Advise", onclick: () => this.measure() });
    this.all = element("div", { className: "advice" }, element("div", { className: "row" }, this.goal, button), this.status,
      this.lines);
  }

  async measure() {
    if (this.measuring) return;
    this.measuring = true;
    this.say("measuring for 2 s");
    const advice = await ask(path("advice", this.drone, this.goal.value));
    this.measuring = false;
    this.lines.replaceChildren(...(advice.lines ?? []).flatMap(line => line_rows(line, advice.goal)));
    this.say(advice.error ? error_text(advice.error) : "", !!advice.error);
  }
  say(text, bad = false) {
    this.status.className = bad ? "bad" : "facts";
    write(this.status, text);
  }
}

const limit_text = ({ what, at, max_per_s }) => `${what} at ${at}, at most ${per_second(max_per_s)}`;
const old = us => us > 0 ? `, ${duration(us)} old` : "";

function line_rows({ from, to, per_s, latency_us, stations, limits, proposals }, goal) {
  const cell = (text, number) => element("td", { textContent: text, className: number ? "number" : "" });
  const rows = stations.map(({ what, at, time_us, max_per_s }) => element("tr", {}, cell(what), cell(at),
    cell(duration(time_us), true), cell(max_per_s > 0 ? per_second(max_per_s) : "", true)));
  const table = element("table", {}, element("caption", { textContent: `${from} → ${to}: ${per_second(per_s)}${old(latency_us)}` }),
    element("thead", {}, element("tr", {}, ...["step", "at", "time", "at most"].map((text, i) => element("th",
      { textContent: text, scope: "col", className: i > 1 ? "number" : "" })))),
    element("tbody", {}, ...rows));
  return [table, element("p", { textContent: verdict(per_s, limits, proposals, goal) }), ...proposals.map(proposal_row)];
}

function verdict(per_s, limits, proposals, goal) {
  if (!limits.length) return per_s > 0 ? "No step is the bottleneck: the model does not explain the rate." : "No events came.";
  const bottleneck = `Bottleneck: ${limit_text(limits[0])}.`;
  return proposals.length ? bottleneck : `${bottleneck} No known change would make it ${goal === "fps" ? "faster" : "younger"}.`;
}

function proposal_row({ text, command, predicted_per_s, predicted_us, next, sure, unsure }) {
  return element("div", { className: "proposal" }, element("p", { textContent: text }),
    element("p", { className: "facts", textContent: `predicted: ${per_second(predicted_per_s)}${old(predicted_us)} (${sure} confidence`
      + (unsure ? `: ${unsure})` : ")") + (next ? `; then the limit is ${limit_text(next)}` : "") }),
    command_line(command));
}
