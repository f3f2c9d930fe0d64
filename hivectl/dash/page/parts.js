// What every view uses: elements, numbers as texts, the server, live images.
"use strict";

export function element(name, properties = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(properties))
    if (key in made) made[key] = value;
    else made.setAttribute(key, value);
  made.append(...children);
  return made;
}

/// Texts are written only if they change, so that nothing is read aloud or drawn again.
export function write(node, text) {
  if (node.textContent !== text) node.textContent = text;
}

export const known = value => value !== null && value !== undefined;
export const per_second = value => known(value) ? value.toFixed(1) + "/s" : "–";
export const percent = value => known(value) ? Math.round(value) + " %" : "–";
export function duration(us) {
  if (!known(us)) return "–";
  const ms = Math.abs(us) / 1000, sign = us < 0 ? "−" : "";
  if (ms < 1) return sign + Math.round(ms * 1000) + " µs";
  if (ms < 1000) return sign + ms.toFixed(ms < 10 ? 1 : 0) + " ms";
  if (ms < 60000) return sign + (ms / 1000).toFixed(1) + " s";
  return sign + (ms < 7200000 ? Math.round(ms / 60000) + " min" : Math.round(ms / 3600000) + " h");
}
export function size(bytes) {
  return bytes < 1000 ? bytes + " B" : bytes < 1e6 ? (bytes / 1000).toFixed(1) + " kB" : (bytes / 1e6).toFixed(1) + " MB";
}
export const clock = us => new Date(us / 1000).toLocaleTimeString();

/// "good", "warn", "bad" or "": of the state of a drone.
export function mood(state) {
  if (["silent", "crashed", "failed"].includes(state)) return "bad";
  return ["halted", "starting", "stopping"].includes(state) ? "warn" : "";
}

/// Is it a drone that may answer?
export const runs = drone => !!drone?.host && !["crashed", "failed"].includes(drone.state);

export function path(...words) { return "/" + words.map(encodeURIComponent).join("/"); }

/// What the server says: JSON, or an object with an error.
async function answer_to(request) {
  try {
    const answer = await request;
    if (answer.ok) return await answer.json();
    return { error: { text: (await answer.text()).trim(), advice: "" } };
  } catch {
    return { error: { text: "hivectl dash does not answer", advice: "start it again: hivectl dash" } };
  }
}
export const ask = where => answer_to(fetch(where, { cache: "no-store" }));
export const order = what => answer_to(fetch("/orders", {
  method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(what) }));
export const error_text = error => error.text + (error.advice ? "; " + error.advice : "");

/// A command, with a button that copies it for a terminal.
export function command_line(text) {
  const code = element("code", { textContent: text }), said = element("small", { role: "status" });
  const copy = async () => {
    getSelection().selectAllChildren(code);  // a page without TLS from another machine has no clipboard
    write(said, await navigator.clipboard?.writeText(text).then(() => true, () => false) ? "copied" : "selected");
  };
  return element("p", { className: "command" }, code,
    element("button", { type: "button", textContent: "Copy", "aria-label": "Copy " + text, onclick: copy }), said);
}

/// A button that asks once more before it acts.
export function careful_button(name, question, act) {
  const place = element("span", { className: "row" });
  const button = element("button", { type: "button", textContent: name });
  const back = () => { place.replaceChildren(button); button.focus(); };
  button.onclick = () => {
    const keep = element("button", { type: "button", textContent: "Cancel", onclick: back });
    const go = element("button", { type: "button", textContent: name, className: "bad", "aria-label": "Yes: " + question,
                                   onclick: () => { back(); act(); } });
    place.replaceChildren(element("span", { textContent: question, role: "alert" }), go, keep);
    keep.focus();
  };
  place.onkeydown = event => {
    if (event.key !== "Escape" || place.contains(button)) return;
    event.stopPropagation();
    back();
  };
  place.append(button);
  return place;
}

/// The values of the last minutes as a line.
export function line_of(values, least_top) {
  const space = "http://www.w3.org/2000/svg", top = Math.max(least_top, ...values);
  const svg = document.createElementNS(space, "svg"), line = document.createElementNS(space, "polyline");
  svg.setAttribute("viewBox", "0 0 180 30");
  svg.setAttribute("preserveAspectRatio", "none");
  svg.setAttribute("aria-hidden", "true");
  line.setAttribute("points", values.map((value, i) => `${180 - values.length + i},${29 - 28 * value / top}`).join(" "));
  svg.append(line);
  return svg;
}

/// Shows the newest image of an output, and asks for the next one when it is drawn.
export class LiveImage {
  constructor(output, width) {
    this.canvas = element("canvas", { role: "img", "aria-label": "Live image of " + output });
    this.message = element("p", { textContent: "waiting for an image" });
    this.box = element("div", { className: "image", "data-output": output }, this.canvas, this.message);
    this.output = output;
    this.width = width;
    this.run();
  }
  stop() { this.stopped = true; }
  say(text) {
    write(this.message, text);
    this.message.hidden = text === "";
    this.canvas.classList.toggle("old", text !== "");
  }
  async run() {
    for (let version = 0; !this.stopped;) {
      if (document.hidden) await new Promise(seen => document.addEventListener("visibilitychange", seen, { once: true }));
      else version = await this.next(version);
    }
  }
  async next(version) {
    const pause = ms => new Promise(done => setTimeout(done, ms));
    try {
      const answer = await fetch(path("image", this.output, this.width, version), { cache: "no-store" });
      if (answer.status === 204) return version;
      if (!answer.ok) {
        this.say((await answer.text()).trim());
        await pause(500);
        return version;
      }
      const image = await createImageBitmap(await answer.blob());
      if (this.canvas.width !== image.width) this.canvas.width = image.width;
      if (this.canvas.height !== image.height) this.canvas.height = image.height;
      this.canvas.getContext("2d").drawImage(image, 0, 0);
      this.canvas.dataset.images = Number(this.canvas.dataset.images || 0) + 1;
      image.close();
      this.say("");
      return Number(answer.headers.get("ETag").replaceAll('"', ""));
    } catch {
      this.say("no image can be read");
      await pause(1000);
      return version;
    }
  }
}
