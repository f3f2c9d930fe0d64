// The page, its style and its script, which polls status.json and writes texts, never HTML.
#include "page.hpp"

namespace view {

const std::string_view page_html = R"(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>Hive view</title>
<link rel="icon" href="data:,">
<link rel="stylesheet" href="view.css">
<script src="view.js" defer></script>
</head>
<body>
<header>
<span id="light" class="off"></span>
<h1 id="sender">waiting</h1>
<span id="source"></span>
<a href="plain/picture.jpg" download>Save image</a>
</header>
<main><img id="picture" src="plain/stream.mjpg" alt="The live image"></main>
<footer>
<dl>
<div><dt>rate</dt><dd id="rate">–</dd></div>
<div><dt>age</dt><dd id="age">–</dd></div>
<div><dt>size</dt><dd id="size">–</dd></div>
<div><dt>capture</dt><dd id="sequence">–</dd></div>
</dl>
<p id="message" role="status"></p>
</footer>
</body>
</html>
)";

const std::string_view page_css = R"(:root { color-scheme: dark; }
* { box-sizing: border-box; margin: 0; }
body { display: flex; flex-direction: column; height: 100vh; height: 100dvh; background: #14161a; color: #e8eaed;
       font: 16px/1.4 system-ui, sans-serif; }
header, footer { display: flex; flex-wrap: wrap; align-items: center; }
header, footer { gap: .3rem .7rem; padding: .6rem 1rem; background: #1e2127; }
h1 { font-size: 1.05rem; font-weight: 600; overflow-wrap: anywhere; }
#source, dt { color: #9aa0a8; }
#light { width: .7rem; height: .7rem; border-radius: 50%; background: #6b7280; }
#light.on { background: #3ddc84; }
#light.late { background: #f5a524; }
#light.lost { background: #ef5350; }
a { margin-left: auto; color: #8ab4f8; text-decoration: none; white-space: nowrap; }
a:hover, a:focus { text-decoration: underline; }
main { flex: 1; min-height: 0; display: flex; }
img { width: 100%; height: 100%; object-fit: contain; }
dl { display: flex; flex-wrap: wrap; gap: .2rem 1.6rem; font-variant-numeric: tabular-nums; }
dl div { display: flex; gap: .5rem; }
#message { margin-left: auto; color: #f5a524; }
)";

const std::string_view page_js = R"("use strict";
const at = id => document.getElementById(id);
const write = (id, text) => { if (at(id).textContent !== text) at(id).textContent = text; };
const long = ms => ms < 60000 ? (ms / 1000).toFixed(1) + " s" : Math.round(ms / 60000) + " min";
const time = ms => ms < 1000 ? ms + " ms" : long(ms);
let lost = false;

function look_again() { at("picture").src = "plain/stream.mjpg?" + Date.now(); }

function light(state, message) {
  at("light").className = state;
  write("message", message);
}

function show(status) {
  const some = status.number > 0;
  write("sender", some ? status.sender : "waiting");
  const drone = status.sender.slice(0, status.sender.lastIndexOf("."));
  write("source", some && drone !== status.source ? "from " + status.source : "");
  write("rate", status.rate > 0 ? status.rate.toFixed(1) + " fps" : "–");
  write("age", status.age_ms === null ? "–" : time(status.age_ms));
  write("size", some ? status.width + " × " + status.height : "–");
  write("sequence", some ? "#" + status.sequence : "–");
  document.title = (some ? status.sender + " – " : "") + "Hive view";
  if (!some)
    light("off", "no image yet: connect a drone to this one");
  else if (status.since_ms > 2000 && status.rate === 0)
    light("late", "no image for " + time(status.since_ms));
  else
    light("on", "");
}

async function poll() {
  try {
    const answer = await fetch("status.json", { cache: "no-store", signal: AbortSignal.timeout(3000) });
    show(await answer.json());
    if (lost) look_again();
    lost = false;
  } catch {
    lost = true;
    light("lost", "the drone does not answer");
  }
  setTimeout(poll, 1000);
}

at("picture").addEventListener("error", () => setTimeout(look_again, 1000));
document.addEventListener("visibilitychange", () => { if (!document.hidden) look_again(); });
poll();
)";

}  // namespace view
