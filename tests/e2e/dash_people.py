#!/usr/bin/env python3
"""hivectl dash for whom it is less easy: the keyboard alone, two people at once, several machines, a viewer's key, and 300
drones. dash_people.py SCENARIO, as dash_page.py."""
import json
import os
import pathlib
import subprocess
import time

from dash_page import Dash, eventually, hivectl, images, run_scenario, select

# An element, also after the list was drawn again; and what the keyboard has to reach: what can be seen and used.
KEY = "(e => e.id || e.tagName + e.getAttribute('aria-label') + e.textContent)"
CONTROLS = """[...document.querySelectorAll("button, input, select, pre, [role=button]")].filter(e =>
    e.getClientRects().length && !e.disabled && !e.matches("g[tabindex='-1']"))"""  # arrow keys go from one drone to the next


def tab_stops(page):
    """Presses Tab until it comes round, and returns how each element on the way was shown."""
    page.run("document.activeElement.blur(); window.stops = new Set()")
    stops = []
    for _ in range(200):
        page.key("Tab")
        stop = page.run(f"""(key => {{ const e = document.activeElement, style = getComputedStyle(e), path = e.querySelector("path");
            if (e === document.body) return {{}};
            if (stops.has(key(e))) return null;
            stops.add(key(e));
            return {{ text: e.outerHTML.slice(0, 80), seen: style.outlineStyle !== "none" && parseFloat(style.outlineWidth) >= 1
                || (path && parseFloat(getComputedStyle(path).strokeWidth) >= 2) }}; }})({KEY})""")
        if stop is None:
            return stops
        stops += [stop] if stop else []
    raise AssertionError("Tab does not come round")


def check_keyboard(page):
    stops = tab_stops(page)
    unseen = [stop["text"] for stop in stops if not stop["seen"]]
    assert not unseen, f"focus is not shown: {unseen}"
    missed = page.run(f"{CONTROLS}.filter(e => !stops.has({KEY}(e))).map(e => e.outerHTML.slice(0, 80))")
    assert not missed, f"Tab does not reach: {missed}"
    roles = {"button", "textbox", "searchbox", "spinbutton", "slider", "switch", "combobox"}
    nodes = page.call("Accessibility.getFullAXTree")["nodes"]
    controls = [node for node in nodes if node.get("role", {}).get("value") in roles and not node["ignored"]]
    assert len(controls) >= len(stops) / 2, nodes
    unnamed = [node for node in controls if not node.get("name", {}).get("value")]
    assert not unnamed, f"without a label: {unnamed}"


def keyboard(browser, dash):
    """Tab reaches each control in each view, with a focus that is seen and a name that is read aloud; the rest goes by keys."""
    hivectl("start", "camera")
    hivectl("start", "sleeper", "--as", "worker")
    hivectl("connect", "camera", "worker")
    page = browser.open(dash.url)
    page.until("!!document.getElementById('drone:worker')")
    check_keyboard(page)
    page.run("document.getElementById('drone:camera').focus()")
    page.key("ArrowRight")
    page.key("Enter")
    page.see("#panel h2", "worker")
    page.until("document.querySelectorAll('.parameter').length > 0")
    check_keyboard(page)
    page.run("document.querySelector('#panel li button').focus()")
    page.key("Enter")
    page.see("#panel h2", "camera.image → worker.image")
    page.until("!!document.querySelector('#edge-window')")
    check_keyboard(page)
    page.key("Escape")
    for view in ("List", "Images"):
        page.click("button", view)
        page.until(f"!document.getElementById('{view.lower()}').hidden")
        check_keyboard(page)


def together(browser, dash):
    """Two hivectl dash of one swarm: each shows what is changed at the other, and both may change at the same time."""
    hivectl("start", "camera", "fps=10", "width=320")
    with Dash() as other:
        pages = [browser.open(each.url, stranger=True) for each in (dash, other)]  # each in a window of its own
        for page in pages:
            select(page, "camera")
        pages[0].type("#parameter-fps", "20")
        pages[1].until("document.querySelector('#parameter-fps').value === '20'")
        pages[1].click("#panel button", "Halt")
        pages[0].until("document.getElementById('drone:camera').classList.contains('warn')")
        pages[0].click("#panel button", "Resume")
        pages[1].until("!document.getElementById('drone:camera').classList.contains('warn')")
        for _ in range(5):  # at once
            pages[0].type("#parameter-fps", "11")
            pages[1].type("#parameter-fps", "12")
        fps = eventually(lambda: int(float(hivectl("get", "camera", "fps"))) in (11, 12) and hivectl("get", "camera", "fps").strip())
        for page in pages:
            page.run("document.activeElement.blur()")
            page.until(f"Number(document.querySelector('#parameter-fps').value) === {float(fps)}")
            assert not page.text(".parameter[data-parameter=fps] .answer"), page.text("#panel")


def replaced(browser, dash):
    """While a drone is replaced again and again, the page shows it, goes on with its images, and sets what it has."""
    hivectl("start", "camera", "width=320")
    page = browser.open(dash.url)
    select(page, "camera")
    drawn = "Number(document.querySelector('#panel canvas')?.dataset.images)"
    page.until(f"{drawn} > 3")
    for fps in ("11", "12"):
        before = json.loads(hivectl("ps", "camera", "--json"))[0]["pid"]
        count = page.run(drawn)
        page.click("#panel button", "Replace")
        page.click("#panel button.bad", "Replace")
        page.type("#parameter-fps", fps)  # to the old one or the new one
        page.until("document.querySelector('#panel > .answer').textContent === 'replaced'")
        assert json.loads(hivectl("ps", "camera", "--json"))[0]["pid"] != before
        page.until(f"{drawn} > {count + 3}")
        page.see("#panel .facts", "process")
        page.until(f"document.querySelector('#parameter-fps').value === '{fps}'")
        assert float(hivectl("get", "camera", "fps")) == float(fps)
    assert page.run("document.querySelectorAll('g.drone').length") == 1
    page.until("document.getElementById('verdict').classList.contains('good')")


def machines(browser, dash, host):
    """A drone on another machine that ssh reaches: it is grouped there, shown and changed; then only a viewer's key is here."""
    hivectl("start", "camera", "--on", host, "source=scene", "width=320")
    hivectl("start", "sleeper", "--as", "worker")
    hivectl("connect", "camera", "worker")
    page = browser.open(dash.url)
    page.see("#machines b", host)
    page.until(f"[...document.querySelectorAll('g.machine text')].some(e => e.textContent.trim() === '{host}')")
    select(page, "camera")
    images(page, "#panel canvas")
    page.see("#panel pre", f"It runs on {host}. Read its log with: hivectl logs camera")
    page.type("#parameter-fps", "12")
    eventually(lambda: float(hivectl("get", "camera", "fps")) == 12)
    page.click("#panel button", "Replace")
    page.click("#panel button.bad", "Replace")
    page.until("document.querySelector('#panel > .answer').textContent === 'replaced'")
    key = pathlib.Path(os.environ["HOME"]) / ".config/hive"
    hivectl("key", "view")
    (key / "viewer.key").rename(key / "swarm.key")
    page.see("#notice", "This machine has a viewer's key: drones on other machines can be watched, not changed.")
    page.until("document.querySelector('#parameter-fps').disabled")
    page.until("[...document.querySelectorAll('#panel > .row button')].every(e => e.disabled)")
    count = page.run("Number(document.querySelector('#panel canvas').dataset.images)")
    page.until(f"Number(document.querySelector('#panel canvas').dataset.images) > {count + 3}")
    answer = page.run("fetch('/orders', { method: 'POST', headers: { 'Content-Type': 'application/json' }, body: "
                      "JSON.stringify({ do: 'set', drone: 'camera', values: { fps: 13 } }) }).then(a => a.json())")
    assert answer["error"]["code"] == "not_permitted", answer
    page.key("Escape")
    select(page, "worker")  # it is of this machine
    page.until("!document.querySelector('#parameter-work_ms').disabled")
    page.type("#parameter-work_ms", "3")
    eventually(lambda: int(hivectl("get", "worker", "work_ms")) == 3)


def processor_s(process):
    fields = pathlib.Path(f"/proc/{process.pid}/stat").read_text().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def hundreds(browser, dash):
    """300 drones: how long until they are shown, how often their numbers come, and what that costs."""
    names = {"source": {"kind": "ticker", "count": 30, "set": {"fps": 1}}, "worker": {"kind": "sleeper", "count": 270}}
    wires = [{"from": f"source-{i}", "to": f"worker-{9 * (i - 1) + j}"} for i in range(1, 31) for j in range(1, 10)]
    file = pathlib.Path(os.environ["HIVE_HOME"]) / "many.json"
    file.write_text(json.dumps({"swarm": "many", "drones": names, "connections": wires}))
    subprocess.run(["hivectl", "up", str(file), "--timeout", "200"], check=True, capture_output=True, timeout=210)
    begin = time.monotonic()
    page = browser.open(dash.url)
    page.until("document.body.dataset.version > 0")
    numbers_s = time.monotonic() - begin
    page.until("document.querySelectorAll('g.drone').length === 300", 90)
    graph_s = time.monotonic() - begin
    page.until("[...document.querySelectorAll('g.edge text')].filter(e => e.textContent.includes('/s')).length === 24")
    page.see("#rates", "Rates of the 24 busiest of 270 connections")
    page.run("window.looks = [performance.now()]; new MutationObserver(() => looks.push(performance.now()))"
             ".observe(document.body, { attributeFilter: ['data-version'] })")
    used, since = processor_s(dash.process), time.monotonic()
    page.until("looks.length > 10")
    percent = 100 * (processor_s(dash.process) - used) / (time.monotonic() - since)
    gap_s = page.run("Math.max(...looks.slice(2).map((t, i) => t - looks[i + 1]))") / 1000
    begin = time.monotonic()
    page.run("(f => { f.value = 'worker-207'; f.dispatchEvent(new Event('input')); })(document.querySelector('#find'))")
    page.click("button", "List")
    page.click("#list button", "worker-207")
    page.see("#panel h2", "worker-207")
    page.until("document.querySelectorAll('.parameter').length > 0")
    select_s = time.monotonic() - begin
    print(f"numbers after {numbers_s:.1f} s, graph after {graph_s:.1f} s, at most {gap_s:.1f} s between two looks, "
          f"hivectl dash {percent:.0f} % of a processor, a drone found and selected in {select_s:.1f} s")
    assert numbers_s < 10 and graph_s < 20 and gap_s < 4 and percent < 60 and select_s < 5


if __name__ == "__main__":
    run_scenario(globals())
