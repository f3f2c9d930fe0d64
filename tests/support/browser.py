"""Drives a headless Chromium by its DevTools protocol over a pipe: real clicks and keys, no package but Chromium."""
import base64
import itertools
import json
import os
import shutil
import signal
import subprocess
import tempfile
import threading
import time


class Browser:
    """One Chromium with a profile of its own; ended and removed at the end of a `with`."""

    def __init__(self, program="/usr/bin/chromium"):
        self.profile = tempfile.mkdtemp(prefix="hive-browser-")
        to_read, self.write_end = os.pipe()
        self.read_end, to_write = os.pipe()
        words = [program, "--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--hide-scrollbars",
                 "--no-first-run", "--remote-debugging-pipe", "--user-data-dir=" + self.profile, "about:blank"]

        def place_pipe():  # Chromium reads descriptor 3 and writes descriptor 4
            reader, writer = os.dup(to_read), os.dup(to_write)
            os.dup2(reader, 3), os.dup2(writer, 4)

        self.process = subprocess.Popen(words, preexec_fn=place_pipe, close_fds=False, start_new_session=True,
                                        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(to_read), os.close(to_write)
        self.numbers, self.answers, self.arrived = itertools.count(1), {}, threading.Condition()
        threading.Thread(target=self._read, daemon=True).start()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        os.killpg(self.process.pid, signal.SIGKILL)
        self.process.wait()
        os.close(self.write_end)
        shutil.rmtree(self.profile, ignore_errors=True)

    def _read(self):
        rest = b""
        while piece := os.read(self.read_end, 1 << 16):
            *messages, rest = (rest + piece).split(b"\0")
            with self.arrived:
                for message in map(json.loads, messages):
                    self.answers[message.get("id")] = message
                self.arrived.notify_all()

    def call(self, method, session=None, **parameters):
        number = next(self.numbers)
        message = {"id": number, "method": method, "params": parameters}
        if session:
            message["sessionId"] = session
        os.write(self.write_end, json.dumps(message).encode() + b"\0")
        with self.arrived:
            if not self.arrived.wait_for(lambda: number in self.answers, 60):
                raise TimeoutError(method)
            answer = self.answers.pop(number)
        if "error" in answer:
            raise RuntimeError(f"{method}: {answer['error']}")
        return answer["result"]

    def open(self, url, width=1280, height=800, dark=False, stranger=False):
        """A page; a stranger's has no cookies of the others."""
        context = {"browserContextId": self.call("Target.createBrowserContext")["browserContextId"]} if stranger else {}
        target = self.call("Target.createTarget", url="about:blank", **context)["targetId"]
        session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        page = Page(self, target, session, context)
        page.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)
        page.scheme("dark" if dark else "light")
        page.call("Page.navigate", url=url)
        return page


class Page:
    def __init__(self, browser, target, session, context):
        self.browser, self.target, self.session, self.context = browser, target, session, context

    def open_beside(self, url):
        """Another tab, in front of this one."""
        target = self.browser.call("Target.createTarget", url=url, **self.context)["targetId"]
        session = self.browser.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        self.browser.call("Page.bringToFront", session)

    def call(self, method, **parameters):
        return self.browser.call(method, self.session, **parameters)

    def close(self):
        self.browser.call("Target.closeTarget", targetId=self.target)

    def scheme(self, scheme):
        self.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": scheme}])

    def run(self, script):
        """The value of an expression; promises are awaited."""
        result = self.call("Runtime.evaluate", expression=script, awaitPromise=True, returnByValue=True)
        if "exceptionDetails" in result:
            raise RuntimeError(result["exceptionDetails"].get("exception", {}).get("description", script))
        return result["result"].get("value")

    def until(self, script, seconds=60):
        """Waits until the expression is true, and returns its value."""
        end = time.monotonic() + seconds
        while True:
            try:
                if value := self.run(script):
                    return value
            except RuntimeError:  # the page is loading
                pass
            if time.monotonic() > end:
                raise AssertionError(f"not within {seconds} s: {script}\nthe page says:\n" + self.text("body"))
            time.sleep(0.05)

    def text(self, selector):
        return self.run(f"document.querySelector({json.dumps(selector)})?.innerText ?? ''")

    def see(self, selector, text, seconds=60):
        """Waits until what the selector finds contains the text."""
        self.until(f"[...document.querySelectorAll({json.dumps(selector)})].some(e => "
                   f"e.textContent.includes({json.dumps(text)}))", seconds)

    def click(self, selector, text=""):
        """Clicks into the middle of the first element that is seen and contains the text, as a mouse does."""
        find = (f"[...document.querySelectorAll({json.dumps(selector)})].find(e => e.textContent.includes("
                f"{json.dumps(text)}) && e.getClientRects().length && !e.disabled)")
        self.until(f"!!{find}")
        x, y = self.run(f"(() => {{ const e = {find}; e.scrollIntoView({{block: 'nearest'}}); "
                        "const b = e.getBoundingClientRect(); return [b.x + b.width / 2, b.y + b.height / 2]; })()")
        for kind in ("mousePressed", "mouseReleased"):
            self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", clickCount=1)

    def key(self, name, code=None):
        for kind in ("keyDown", "keyUp"):
            text = {"text": "\r"} if name == "Enter" and kind == "keyDown" else {}
            self.call("Input.dispatchKeyEvent", type=kind, key=name, code=code or name,
                      windowsVirtualKeyCode={"Enter": 13, "Escape": 27, "Tab": 9, "ArrowRight": 39, "ArrowLeft": 37}.get(
                          name, 0), **text)

    def type(self, selector, text):
        """Replaces the text of an input and presses Enter."""
        self.click(selector)
        self.run(f"document.querySelector({json.dumps(selector)}).select()")
        self.call("Input.insertText", text=text)
        self.key("Enter")

    def screenshot(self, file):
        kind = {"format": "png"} if file.endswith(".png") else {"format": "jpeg", "quality": 85}
        image = self.call("Page.captureScreenshot", **kind)["data"]
        with open(file, "wb") as out:
            out.write(base64.b64decode(image))
