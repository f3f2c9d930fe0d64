#!/usr/bin/env python3
"""What a person does with hivectl dash, in a real browser, with real drones.

dash_page.py SCENARIO: runs in the HIVE_HOME of the environment, with hivectl in the path. dash_page.py picture FILE
makes the picture of the README."""
import http.server
import json
import os
import pathlib
import signal
import socket
import subprocess
import sys
import threading
import time

sys.path.insert(0, str(pathlib.Path(__file__).parent.parent / "support"))
from browser import Browser  # noqa: E402


def hivectl(*words):
    done = subprocess.run(["hivectl", *words], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, f"hivectl {words}: {done.stdout}{done.stderr}"
    return done.stdout


def state(drone):
    return {each["name"]: each["state"] for each in json.loads(hivectl("ps", "--json"))}.get(drone)


def connections():
    return json.loads(hivectl("connections", "--json"))


def eventually(what, seconds=60):
    end = time.monotonic() + seconds
    while not (value := what()):
        assert time.monotonic() < end, f"not within {seconds} s"
        time.sleep(0.1)
    return value


class Dash:
    def __init__(self):
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            self.port = probe.getsockname()[1]
        self.start()

    def start(self):
        self.process = subprocess.Popen(["hivectl", "dash", "--http", str(self.port)], stdout=subprocess.PIPE, text=True)
        self.url = self.process.stdout.readline().strip()
        assert "?token=" in self.url, self.url

    def kill(self):
        self.process.kill()
        self.process.wait()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.send_signal(signal.SIGTERM)
        assert self.process.wait(20) == 143


def images(page, selector, number=3):
    page.until(f"document.querySelector({json.dumps(selector)})?.dataset.images > {number}")


def select(page, drone):
    page.click("g.drone", drone)
    page.see("#panel h2", drone)
    page.until("document.querySelectorAll('.parameter').length > 0")


def copied(browser, page, selector):
    """What the first Copy button of an element puts into the clipboard."""
    browser.call("Browser.grantPermissions", permissions=["clipboardReadWrite", "clipboardSanitizedWrite"])
    page.click(selector + " .command button", "Copy")
    page.see(selector + " .command small", "copied")
    return page.run("navigator.clipboard.readText()")


def parameters(browser, dash):
    """A parameter is set at once, and the drone's answer is shown: applied, rounded or refused."""
    hivectl("start", "camera", "fps=10")
    page = browser.open(dash.url)
    select(page, "camera")
    images(page, "#panel canvas")
    fps = lambda: float(hivectl("get", "camera", "fps"))  # noqa: E731
    page.type("#parameter-fps", "20")
    eventually(lambda: fps() == 20)
    page.type("#parameter-fps", "999999")
    page.see(".parameter[data-parameter=fps] .answer.bad", "fps")
    page.until("document.querySelector('#parameter-fps').value === '20'")
    page.type("#parameter-source", "scene:noise")
    eventually(lambda: hivectl("get", "camera", "source").strip() == "scene:noise")
    page.run("(s => { s.value = 30; s.dispatchEvent(new Event('input')); })("
             "document.querySelector('.parameter[data-parameter=fps] input[type=range]'))")
    eventually(lambda: fps() == 30)
    hivectl("set", "camera", "fps=7")  # by somebody else
    page.run("document.activeElement.blur()")
    page.until("document.querySelector('#parameter-fps').value === '7'")


def buttons(browser, dash):
    """Halt, resume and replace; stop only when asked once more; the keyboard does as the mouse."""
    hivectl("start", "camera")
    hivectl("start", "sleeper", "--as", "worker")
    hivectl("connect", "camera", "worker")
    page = browser.open(dash.url)
    select(page, "worker")
    page.click("#panel button", "Halt")
    eventually(lambda: state("worker") == "halted")
    page.until("document.getElementById('drone:worker').classList.contains('warn')")
    page.see("#worst", "worker has halted")
    page.see("#worst code", "hivectl resume worker")
    page.click("#panel button", "Resume")
    eventually(lambda: state("worker") != "halted")
    before = json.loads(hivectl("ps", "worker", "--json"))[0]["pid"]
    page.click("#panel button", "Replace")
    page.click("#panel button.bad", "Replace")
    eventually(lambda: json.loads(hivectl("ps", "worker", "--json"))[0]["pid"] != before)
    page.click("#panel button", "Stop")
    page.see("#panel [role=alert]", "Stop worker?")
    page.key("Escape")
    page.until("!document.querySelector('#panel [role=alert]')")
    page.click("#panel button", "Stop")
    page.click("#panel button", "Cancel")
    assert state("worker"), "it was not to be stopped"
    page.click("#panel button", "Stop")
    page.click("#panel button.bad", "Stop")
    eventually(lambda: state("worker") is None)
    page.until("!document.getElementById('drone:worker')")
    page.key("Escape")
    page.until("document.getElementById('panel').hidden")
    page.run("document.getElementById('drone:camera').focus()")
    page.key("Enter")
    page.see("#panel h2", "camera")


def edges(browser, dash):
    """The account of a connection from both ends, and another window, transfer and encoding."""
    hivectl("start", "camera", "fps=20")
    hivectl("start", "sleeper", "--as", "worker")
    hivectl("connect", "camera", "worker", "--window", "2")
    page = browser.open(dash.url)
    row = lambda: next(each for each in connections() if each["to"] == "worker.image")  # noqa: E731
    select(page, "camera")
    page.click("#panel li button", "camera.image → worker.image")
    page.see("#panel .counts", "acknowledged")
    page.see("#panel .counts caption", "nothing lost")
    held_up = "/Nothing holds it up|processors of this machine are busy/"  # by what else runs here, if by anything
    page.until(f"{held_up}.test(document.querySelector('#panel').textContent)")
    page.until("document.querySelector('#edge-window').value === '2'")
    page.type("#edge-window", "4")
    page.see("#panel .answer.good", "changed")
    eventually(lambda: row()["window"] == 4)
    page.run("document.querySelector('#edge-encoding').value = 'jpeg:60'")
    page.click("#panel button", "Change")
    eventually(lambda: row()["encoding"] == "jpeg:60")
    assert row()["window"] == 4
    page.run("(s => { s.value = 'stream'; s.dispatchEvent(new Event('change')); })(document.querySelector('#edge-transfer'))")
    page.click("#panel button", "Change")
    eventually(lambda: row()["transfer"] == "stream")
    hivectl("halt", "worker")
    page.see("#panel p.bad, #panel p.warn", "worker has halted")
    hivectl("start", "sleeper", "--as", "member")
    hivectl("connect", "camera", "member", "--group", "workers")
    page.see("g.edge text", "workers")


def exceptions(browser, dash):
    """What a drone's code throws, its log, and a loss in red."""
    hivectl("start", "camera")
    hivectl("start", "sleeper", "--as", "thrower", "throw_at=3")
    hivectl("connect", "camera", "thrower", "--stream")
    page = browser.open(dash.url)
    select(page, "thrower")
    page.see(".exceptions li", "failed: ")
    page.see(".exceptions code", "hivectl rerun thrower 1")
    page.click(".exceptions summary", "Input")
    page.see(".exceptions details[open] p", "image: image/")
    page.see(".exceptions details[open] p", "from camera.image, event ")
    page.see(".exceptions details[open] pre", '"width":640')
    assert copied(browser, page, ".exceptions") == "hivectl rerun thrower 1"
    page.until("document.querySelector('.exceptions img[alt]')?.naturalWidth === 640")
    assert page.run("document.querySelectorAll('.exceptions li').length") == 1, "a kept exception is listed once"
    page.see("#panel pre", "error thrower")
    page.see("#verdict.bad", "lost")
    page.until("!!document.querySelector('g.edge.bad')")
    page.see("g.edge.bad text", "1 lost")
    hivectl("set", "thrower", "throw_at=4")
    page.until("document.querySelectorAll('.exceptions li').length === 2")
    page.see(".exceptions details[open] p", "event ")  # what was opened stays open


def crashes(browser, dash):
    """A drone that died stays, red as its connection, with log and failure, until it runs again."""
    hivectl("start", "camera")
    hivectl("start", "crasher", "--as", "boom")
    hivectl("connect", "camera", "boom")
    page = browser.open(dash.url)
    page.until("document.getElementById('drone:boom')?.classList.contains('bad')")
    page.see("#graph", "crashed")
    page.see("g.edge.bad text", " lost")
    page.click("g.drone", "boom")
    page.see("#panel .facts", "SIGSEGV in crasher::write_to_null")
    page.see("#panel pre", "crashed: SIGSEGV")
    page.see(".exceptions li", "died: SIGSEGV")
    page.see(".exceptions code", "hivectl rerun boom 1")
    page.until("document.querySelector('.exceptions img')?.naturalWidth === 640")
    page.click("#panel li button", "camera.image → boom.in")
    page.see("#panel .counts caption", " lost")
    page.key("Escape")
    hivectl("start", "crasher", "--as", "boom", "how=none")
    page.until("!document.getElementById('drone:boom').classList.contains('bad')")
    page.see("#graph", "crasher, ")
    os.kill(json.loads(hivectl("ps", "boom", "--json"))[0]["pid"], signal.SIGKILL)
    page.until("document.getElementById('drone:boom').classList.contains('bad')")
    page.click("g.drone", "boom")
    page.see("#panel .facts", "crashed")
    page.click("#panel button", "Stop")
    page.click("#panel button.bad", "Stop")
    eventually(lambda: "boom" not in [each["name"] for each in json.loads(hivectl("graph", "--json"))["drones"]])


def restarts(browser, dash):
    """The page goes on when a drone or hivectl dash has been killed and started again."""
    hivectl("start", "camera")
    page = browser.open(dash.url)
    select(page, "camera")
    images(page, "#panel canvas")
    os.kill(json.loads(hivectl("ps", "camera", "--json"))[0]["pid"], signal.SIGKILL)
    eventually(lambda: state("camera") in (None, "crashed"))
    hivectl("start", "camera")
    drawn = "Number(document.querySelector('#panel canvas')?.dataset.images ?? 0)"  # 0: the panel is being drawn
    count = page.run(drawn)
    page.until(f"{drawn} > {count + 3}", 30)
    dash.kill()
    page.see("#verdict", "not connected")
    page.see("#notice", "hivectl dash does not answer")
    dash.start()
    count = page.run(drawn)
    page.until("document.getElementById('verdict').classList.contains('good')")
    page.until(f"{drawn} > {count + 3}", 30)
    assert page.run("document.getElementById('notice').hidden")


def shared(browser, dash):
    """Two browsers cost the drone what one costs; a page that is gone or not seen costs nothing."""
    hivectl("start", "camera")
    pages = [browser.open(dash.url, stranger=True) for _ in range(2)]
    for page in pages:
        select(page, "camera")
        images(page, "#panel canvas")
    viewers = lambda: [each for each in connections() if each["state"] == "connected"]  # noqa: E731
    assert len(viewers()) == 1, viewers()
    looks = pages[0].run("Number(document.body.dataset.version)")
    pages[0].until(f"document.body.dataset.version > {looks + 3}")
    assert pages[0].run("document.querySelectorAll('g.drone').length") == 1, "the page shows itself"
    for page in pages:
        page.close()
    eventually(lambda: not viewers())
    page = browser.open(dash.url, stranger=True)
    select(page, "camera")
    eventually(viewers)
    page.open_beside("about:blank")
    page.until("document.hidden")
    eventually(lambda: not viewers())
    page.call("Page.bringToFront")
    eventually(viewers)


def many(browser, dash):
    """24 outputs at once."""
    swarm = {"swarm": "many", "drones": {"camera": {"kind": "camera", "count": 24, "set": {"width": 160, "fps": 5}}}}
    file = pathlib.Path(os.environ["HIVE_HOME"]) / "many.json"
    file.write_text(json.dumps(swarm))
    hivectl("up", str(file))
    page = browser.open(dash.url)
    page.until("document.body.dataset.version > 0")  # before, the buttons do nothing
    page.click("button", "Images")
    page.until("[...document.querySelectorAll('#images canvas')].filter(c => c.dataset.images > 5).length === 24", 60)
    page.click("button", "List")
    page.until("document.querySelectorAll('#list tbody tr').length === 24")
    page.run("(f => { f.value = 'camera-17'; f.dispatchEvent(new Event('input')); })(document.querySelector('#find'))")
    page.until("document.querySelectorAll('#list tbody tr').length === 1")
    page.click("#list button", "camera-17")
    page.see("#panel h2", "camera-17")


HAD_RATES = r"""[...document.querySelectorAll("g.edge")].filter(e => /^[1-9][0-9.]*.s/.test(e.querySelector("text")?.textContent)
    && /^[0-9.]+ (µs|ms|s)$/.test(e.querySelectorAll("text")[1]?.textContent)).reduce((had, e) => had.add(e.id), window.had ??= new Set()).size"""
OVERLAPS = """(boxes => boxes.filter((a, i) => boxes.some((b, j) => i < j && a.left < b.right - 1 && b.left < a.right - 1
    && a.top < b.bottom - 3 && b.top < a.bottom - 3)).length)([...document.querySelectorAll('g.edge text')].map(t => t.getBoundingClientRect()))"""


def rates(browser, dash):
    """64 drones: each of 96 connections has its rate and the age of its newest event, and no two of them overlap."""
    names = {"source": {"kind": "ticker", "count": 8, "set": {"fps": 5}}, "worker": {"kind": "sleeper", "count": 48},
             "sink": {"kind": "sleeper", "count": 8}}
    wires = [{"from": f"source-{i}", "to": f"worker-{6 * (i - 1) + j}"} for i in range(1, 9) for j in range(1, 7)]
    wires += [{"from": f"worker-{6 * (i - 1) + j}.result", "to": f"sink-{i}"} for i in range(1, 9) for j in range(1, 7)]
    file = pathlib.Path(os.environ["HIVE_HOME"]) / "rates.json"
    file.write_text(json.dumps({"swarm": "rates", "drones": names, "connections": wires}))
    hivectl("up", str(file))
    page = browser.open(dash.url)
    page.until(f"{HAD_RATES} === 96")  # not at once: on a full machine a connection may have no event in a second
    page.until(f"{OVERLAPS} === 0")  # the rates change each second
    assert page.text("#rates") == ""


def advice(browser, dash):
    """Where the time of a drone's events goes, and a command to copy that does help."""
    hivectl("start", "ticker", "--as", "source", "fps=50")
    hivectl("start", "sleeper", "--as", "worker", "work_ms=80")
    hivectl("connect", "source", "worker")
    page = browser.open(dash.url)
    select(page, "source")
    page.see("#panel li button", "source.tick → worker.image")
    assert not page.run("document.querySelector('.advice').getClientRects().length"), "it receives nothing"
    select(page, "worker")
    page.click(".advice button", "Advise")
    page.see(".advice caption", "source → worker")
    page.see(".advice td", "work")
    page.see(".advice p", "Bottleneck: work at worker")
    page.see(".advice .proposal .facts", "predicted: ")
    command = copied(browser, page, ".advice")
    assert command.startswith("hivectl start sleeper --as worker-2 "), command
    subprocess.run(command, shell=True, check=True, capture_output=True, timeout=60)
    page.until("!!document.getElementById('drone:worker-2')")
    hivectl("halt", "source")
    page.until("document.getElementById('drone:worker').textContent.includes(' 0.0/s')")  # until the last events are processed
    page.run("document.querySelector('.advice select').value = 'latency'")
    page.click(".advice button", "Advise")
    page.see(".advice p", "No events came.")
    hivectl("resume", "source")
    hivectl("disconnect", "source", "worker")
    page.until("!document.querySelector('.advice').getClientRects().length")


def demand(browser, dash):
    """The page makes no source on demand produce, unless its image is asked for."""
    folder = pathlib.Path(os.environ["HIVE_HOME"]) / "images"
    hivectl("start", "camera", "--as", "live")
    folder.mkdir()
    for i in range(3):
        hivectl("snap", "live", str(folder / f"{i}.jpg"))
    hivectl("stop", "live")
    hivectl("start", "camera", f"source={folder}", "pace=demand")
    page = browser.open(dash.url)
    page.until("document.body.dataset.version > 0")  # before, the buttons do nothing
    page.click("button", "Images")
    page.see("#images", "No drone that fits has images.")
    page.click("button", "Graph")
    select(page, "camera")
    page.see("#panel button", "this takes events from the source")
    assert not connections(), connections()
    page.click("#panel button", "Show images")
    images(page, "#panel canvas", 0)


def strangers(browser, dash):
    """Without the token nothing is shown, and another page of this machine changes nothing: not even with the cookie, which
    browsers send to every port of a host."""
    hivectl("start", "camera")
    page = browser.open(dash.url)
    select(page, "camera")
    address = dash.url.split("?")[0]
    stranger = browser.open(address, stranger=True)
    stranger.see("body", "Open the address that hivectl dash prints.")

    class Evil(http.server.BaseHTTPRequestHandler):
        def do_GET(self):
            self.send_response(200)
            self.send_header("Content-Type", "text/html")
            self.end_headers()
            self.wfile.write(b"evil")

        def log_message(self, *_):
            pass

    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Evil)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    evil = browser.open(f"http://127.0.0.1:{server.server_address[1]}/")
    evil.see("body", "evil")
    order = json.dumps({"do": "halt", "drone": "camera"})
    for options in ({"mode": "no-cors"}, {"headers": {"Content-Type": "application/json"}}):
        options |= {"method": "POST", "credentials": "include", "body": order}
        evil.run(f"fetch('{address}orders', {json.dumps(options)}).catch(() => null).then(() => true)")
    evil.run(f"(f => {{ f.method = 'post'; f.enctype = 'text/plain'; f.action = '{address}orders'; document.body.append(f); "
             "f.submit(); })(document.createElement('form'))")
    evil.see("body", "Cross-site access denied.")
    assert state("camera") != "halted"
    assert page.run(f"fetch('/orders', {{method: 'POST', headers: {{'Content-Type': 'application/json'}}, body: {json.dumps(order)}}})"
                    ".then(a => a.status)") == 200
    eventually(lambda: state("camera") == "halted")
    server.shutdown()


def picture(browser, dash, file):
    """The picture of the README: a camera, two workers that share its frames, and what they find."""
    hivectl("start", "camera")
    for name in ("face-1", "face-2"):
        hivectl("start", "face", "--as", name)
    hivectl("start", "annotate")
    hivectl("connect", "camera", "face-1", "face-2", "--share")
    hivectl("connect", "camera", "annotate")
    for name in ("face-1", "face-2"):
        hivectl("connect", f"{name}.faces", "annotate.marks")
    page = browser.open(dash.url, 1180, 640)
    select(page, "annotate")
    images(page, "#panel canvas", 40)
    time.sleep(20)  # a line of the last minutes needs some
    page.screenshot(file)


def run_scenario(scenarios):
    try:
        with Browser() as a_browser, Dash() as a_dash:
            scenarios[sys.argv[1]](a_browser, a_dash, *sys.argv[2:])
    finally:
        subprocess.run(["hivectl", "stop", "--all"], capture_output=True, timeout=60)


if __name__ == "__main__":
    run_scenario(globals())
