// The list of a drone's exceptions and kept failures.
"use strict";
import { clock, command_line, element, path, size } from "./parts.js";

const is_same = (one, other) => ["source", "seq", "code", "text"].every(key => one[key] === other[key]);

/// Newest first.
/// @param exceptions  sampled, without inputs
/// @param failures    with inputs that are kept on this machine
/// @param opened      the ids of those whose inputs are shown
export function exception_rows(drone, exceptions, failures, opened) {
  const others = exceptions.filter(each => !failures.some(failure => is_same(each, failure)));
  return [...failures, ...others].sort((a, b) => b.time_us - a.time_us).map(each => element("li", {},
    element("time", { textContent: clock(each.time_us) }),
    ` ${each.code}: ${each.text}`, each.source ? ` [${each.source} ${each.seq}]` : "", ...each.number ? kept(drone, each, opened) : []));
}

/// The failures of drones of one name on two machines are kept together.
function kept(drone, { number, image, inputs }, opened) {
  const id = `failure-${number}`;
  drone = drone.split("@")[0];
  const given = element("details", { id, open: opened.includes(id) }, element("summary", { textContent: inputs.length === 1 ? "Input" : `${inputs.length} inputs` }),
    ...inputs.flatMap(input_rows));
  return [...image ? [element("img", { src: path("failure", drone, number), alt: `Input of failure ${number} of ${drone}` })] : [],
    given, command_line(`hivectl rerun ${drone} ${number}`)];
}

const input_rows = ({ input, sender, type, size: bytes, source, seq, header }) => [
  element("p", { textContent: `${input}: ${type}, ${size(bytes)}, ${sender ? `from ${sender}, ` : ""}event ${seq} of ${source}` }),
  element("pre", { textContent: header, tabIndex: 0, "aria-label": `Header of the event at ${input}` })];
