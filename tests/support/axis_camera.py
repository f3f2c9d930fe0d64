#!/usr/bin/python3
"""usage: axis_camera.py [name=value ...]

Emulates an Axis camera at http://127.0.0.1:PORT, for tests and trials, correctly or with chosen faults. It prints where it
listens, serves VAPIX over HTTP/1.0 with one request per connection, as old cameras do, and needs numpy and OpenCV.

  port=8080 control=8081   0, the default: any free port
  address=127.0.0.1        IPv4 address of the camera; its control port is always on 127.0.0.1
  credentials=FILE         user:password of its owner (default root:pass)

The control port shows these words and the counters, and changes words: curl 'http://127.0.0.1:8081/?fps=10'

  fps=25                   frame rate, unless the request or Image.I0.Stream.FPS sets one
  step=1                   sensor values are rounded down to multiples of it
  auth=none                basic, digest or basic_digest; qop=off and nonce_uses=N vary the digest
  old_firmware=off         accepts updates only at /axis-cgi/admin/
  boundary=plain           dashed, quoted, tight: other forms of its name
  length=right             missing, short, text, huge: Content-Length of the parts
  line_end=crlf            lf
  garbage=off              bytes between the parts, unknown fields in their heads
  down=off                 no listener, all connections are closed
  mute=off                 accepts connections and sends nothing
  stall=off                streams pause
  close_after=-1           a stream ends after N images
  cut_after=-1             a stream ends in the middle of the image after N
  truncated=off            half images in complete parts
  endless_head=off         64 MiB of a head, before each part; endless_part=off: of an image
  huge_head=off            100 KiB of fields before every answer
  unauthorised=off         every login is refused
  html=off status=200      a web page instead of images, with a status
  foreign=off              a web server that is not a camera: 404 for everything
  redirect=                target of all redirections
  bytes_per_s=0            slow; 0: unlimited

Counters: connections, wrong_logins (requests with a refused login), updates, pictures.
"""
import base64
import contextlib
import hashlib
import http.server
import ipaddress
import itertools
import os
import socket
import socketserver
import sys
import threading
import time
import urllib.parse
import urllib.request

import cv2
import numpy

WORDS = {  # name: its initial value, or what it may be, the initial value first
    "fps": 25, "step": 1, "auth": ("none", "basic", "digest", "basic_digest"), "qop": True, "nonce_uses": 0,
    "old_firmware": False, "boundary": ("plain", "dashed", "quoted", "tight"),
    "length": ("right", "missing", "short", "text", "huge"), "line_end": ("crlf", "lf"), "garbage": False, "down": False,
    "mute": False, "stall": False, "close_after": -1, "cut_after": -1, "truncated": False, "endless_head": False,
    "endless_part": False, "huge_head": False, "unauthorised": False, "html": False, "status": 200, "foreign": False,
    "redirect": "", "bytes_per_s": 0,
}
SERIAL = "00408CEEEEEE"
RESOLUTIONS = ("1280x720", "640x480", "320x240", "160x120")
PARAMETERS = {  # name: its initial value, and what it may be set to
    "Brand.Brand": ("AXIS", ()),
    "Brand.ProdFullName": ("AXIS Emulated Network Camera", ()),
    "Brand.ProdNbr": ("Emulated", ()),
    "Image.I0.Appearance.Compression": ("30", range(101)),
    "Image.I0.Appearance.Resolution": ("640x480", RESOLUTIONS),
    "Image.I0.Appearance.Rotation": ("0", ("0", "180")),
    "Image.I0.Name": ("Fu\xdfg\xe4nger", ()),  # Latin-1, as cameras send it
    "Image.I0.Stream.FPS": ("0", range(61)),
    "ImageSource.I0.Sensor.Exposure": ("auto", ("auto", "hold", "flickerfree50", "flickerfree60")),
    "ImageSource.I0.Sensor.Brightness": ("50", range(101)),
    "ImageSource.I0.Sensor.ColorLevel": ("50", range(101)),
    "Properties.API.HTTP.Version": ("3", ()),
    "Properties.Firmware.Version": ("0.1", ()),
    "Properties.Image.Format": ("jpeg,mjpeg", ()),
    "Properties.Image.Resolution": (",".join(RESOLUTIONS), ()),
    "Properties.System.SerialNumber": (SERIAL, ()),
}


class Behaviour(dict):
    """The words by name, set from text."""

    def __init__(self):
        super().__init__({name: kind[0] if isinstance(kind, tuple) else kind for name, kind in WORDS.items()})

    def set(self, name, text):
        if name not in WORDS:
            raise ValueError(f"unknown word {name}; there are: {' '.join(WORDS)}")
        kind = WORDS[name]
        choices = ("off", "on") if isinstance(kind, bool) else kind if isinstance(kind, tuple) else ()
        if choices and text not in choices:
            raise ValueError(f"{name} is one of {' '.join(choices)}")
        if name == "fps" and text in ("0", "-1"):
            raise ValueError("fps is at least 1")
        try:
            self[name] = text == "on" if isinstance(kind, bool) else int(text) if isinstance(kind, int) else text
        except ValueError:
            raise ValueError(f"{name} is a number") from None

    def __str__(self):
        return "".join(f"{name}={('off', 'on')[value] if isinstance(value, bool) else value}\n" for name, value in self.items())


class Parameters:
    """What param.cgi lists and updates."""

    def __init__(self):
        self.values = {name: value for name, (value, _) in PARAMETERS.items()}

    def list(self, groups):
        body = ""
        for group in (groups or "root").split(","):
            wanted = "" if group == "root" else group.removeprefix("root.") + "."
            found = [f"root.{name}={value}\r\n" for name, value in self.values.items() if (name + ".").startswith(wanted)]
            body += "".join(found) or f"# Error: Error -1 getting param in group '{group}'\r\n"
        return body

    def update(self, values, step):
        """Like a camera it sets the valid values, even if it refuses another."""
        errors = ""
        for name, value in values:
            name = name.removeprefix("root.")
            valid = PARAMETERS.get(name, ("", ()))[1]
            if value not in map(str, valid):
                errors += f"# Error: Error setting 'root.{name}' to '{value}'!\r\n"
                continue
            rounded = name.startswith("ImageSource.") and isinstance(valid, range)
            self.values[name] = str(int(value) // step * step) if rounded else value
        return errors or "OK\r\n"


def md5(*parts):
    return hashlib.md5(":".join(parts).encode()).hexdigest()


def digest_response(owner, realm, method, fields):
    """RFC 2617, with and without qop."""
    user, password = owner
    extra = [fields.get(name, "") for name in ("nc", "cnonce", "qop")] if fields.get("qop") else []
    return md5(md5(user, realm, password), fields.get("nonce", ""), *extra, md5(method, fields.get("uri", "")))


class Login:
    """The camera's side of basic and digest authentication."""

    def __init__(self, owner, realm="AXIS_" + SERIAL):
        self.owner, self.realm, self.nonce, self.uses = owner, realm, "", 0

    def check(self, behaviour, method, uri, authorization):
        """Returns welcome, unknown, wrong or stale."""
        scheme, _, text = authorization.partition(" ")
        if behaviour["auth"] == "none":
            return "welcome"
        if scheme.lower() not in behaviour["auth"].split("_"):
            return "unknown"
        if scheme.lower() == "basic":
            return "welcome" if text == base64.b64encode(":".join(self.owner).encode()).decode() else "wrong"
        fields = urllib.request.parse_keqv_list(urllib.request.parse_http_list(text))
        expected = {"username": self.owner[0], "realm": self.realm, "uri": uri,
                    "response": digest_response(self.owner, self.realm, method, fields)}
        if any(fields.get(name) != value for name, value in expected.items()):
            return "wrong"
        if fields["nonce"] != self.nonce or 0 < behaviour["nonce_uses"] <= self.uses:
            return "stale"
        self.uses += 1
        return "welcome"

    def challenges(self, behaviour, verdict):
        """The WWW-Authenticate fields of a 401."""
        result = []
        if "digest" in behaviour["auth"]:
            if not self.nonce or verdict == "stale":
                self.nonce, self.uses = os.urandom(16).hex(), 0
            result.append(f'Digest realm="{self.realm}", nonce="{self.nonce}", stale={str(verdict == "stale").upper()}'
                          + ', qop="auth"' * behaviour["qop"])
        if "basic" in behaviour["auth"]:
            result.append(f'Basic realm="{self.realm}"')
        return result


class Painter:
    """Draws a face that moves in front of a wall, with sensor noise."""

    FACE = (((0, -4), (15, 21), (25, 33, 43)), ((0, 0), (13, 18), (150, 175, 215)),  # centre, radii, colour of ellipses
            ((-5, -3), (4, 2), (60, 70, 85)), ((5, -3), (4, 2), (60, 70, 85)), ((0, 9), (5, 1), (60, 60, 120)))

    def __init__(self):
        self.walls = {}  # by size, and their noise

    def wall(self, width, height):
        if (width, height) not in self.walls:
            random = numpy.random.default_rng(1)
            bricks = random.integers(80, 120, (height // 20, width // 20, 3)).astype(numpy.uint8)
            noise = random.normal(0, 3, (height, width, 3)).astype(numpy.int16)
            self.walls[width, height] = numpy.kron(bricks, numpy.ones((20, 20, 1), numpy.uint8)), noise
        return self.walls[width, height]

    def jpeg(self, values, resolution, compression, index):
        width, height = map(int, resolution.split("x"))
        wall, noise = self.wall(width, height)
        image = wall.copy()
        middle = numpy.array([width * (0.5 + 0.3 * numpy.sin(index / 40)), height * (0.5 + 0.1 * numpy.sin(index / 25))])
        for centre, radii, colour in self.FACE:
            at, axes = (middle + numpy.array(centre) * height / 80).astype(int), numpy.array(radii) * height // 80
            cv2.ellipse(image, at.tolist(), axes.tolist(), 0, 0, 360, colour, -1)
        light = int(values["ImageSource.I0.Sensor.Brightness"]) - 50
        image = numpy.clip(image + numpy.roll(noise, index * 8191) + light, 0, 255).astype(numpy.uint8)
        if values["ImageSource.I0.Sensor.ColorLevel"] == "0":
            image = cv2.cvtColor(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY), cv2.COLOR_GRAY2BGR)
        return cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, 95 - compression * 9 // 10])[1].tobytes()


def stream_type(behaviour):
    name = {"dashed": "--myboundary", "quoted": '"myboundary"'}.get(behaviour["boundary"], "myboundary")
    return f"multipart/x-mixed-replace;{'' if behaviour['boundary'] == 'tight' else ' '}boundary={name}"


def shown(behaviour, jpeg):
    return jpeg[:len(jpeg) // 2] if behaviour["truncated"] else jpeg


def stream_part(behaviour, jpeg):
    end = b"\n" if behaviour["line_end"] == "lf" else b"\r\n"
    body = shown(behaviour, jpeg)
    lengths = {"right": len(body), "short": len(body) // 2, "text": "many", "huge": 99999999999}
    lines = [b"--myboundary", b"X-Unknown: \xe4\x01\xff"][:2 if behaviour["garbage"] else 1] + [b"Content-Type: image/jpeg"]
    if behaviour["length"] in lengths:
        lines.append(f"Content-Length: {lengths[behaviour['length']]}".encode())
    after = [b"\xff\xd8 this is not an image \xff\xd9 -- --my"] if behaviour["garbage"] else []
    return end.join([*lines, b"", body, *after, b""])


def answer_text(status, kind, body, *fields):
    body = body.encode("latin-1") if isinstance(body, str) else body
    head = [f"HTTP/1.0 {status}", "Cache-Control: no-cache", "Connection: close", *fields, f"Content-Type: {kind}",
            f"Content-Length: {len(body)}", "", ""]
    return "\r\n".join(head).encode("latin-1") + body


def page(status, *fields):
    return answer_text(status, "text/html", f"<html><body>{status}</body></html>\r\n", *fields)


def plain(body):
    return answer_text("200 OK", "text/plain; charset=iso-8859-1", body)


class Server(socketserver.ThreadingTCPServer):
    allow_reuse_address = True
    daemon_threads = True
    request_queue_size = 100

    def __init__(self, address, port, word, handler, camera):
        self.camera = camera
        try:
            super().__init__((address, port), handler)
        except OSError as problem:
            raise OSError(f"cannot listen at {address}, {word}={port}: {problem.strerror}") from None
        self.sockets = set()
        threading.Thread(target=self.serve_forever, kwargs={"poll_interval": 0.02}, daemon=True).start()

    def stop(self):
        """Also ends all connections."""
        self.shutdown()
        self.server_close()
        for connection in self.sockets.copy():
            with contextlib.suppress(OSError):
                connection.shutdown(socket.SHUT_RDWR)

    def process_request(self, request, client_address):
        self.sockets.add(request)
        super().process_request(request, client_address)

    def shutdown_request(self, request):
        self.sockets.discard(request)
        super().shutdown_request(request)

    def handle_error(self, request, client_address):
        if not isinstance(sys.exc_info()[1], OSError):  # a client that leaves is normal
            super().handle_error(request, client_address)


class Request(http.server.BaseHTTPRequestHandler):
    """A request with its query, which continues in the body of a POST."""

    def do_GET(self):
        target = urllib.parse.urlsplit(self.path)
        body = self.rfile.read(int(self.headers.get("Content-Length") or 0)).decode("latin-1")
        self.route = target.path
        self.query = [pair for text in (target.query, body) for pair in urllib.parse.parse_qsl(text, True, encoding="latin-1")]
        self.answer(self.server.camera)

    do_POST = do_GET

    def word(self, name):
        return dict(reversed(self.query)).get(name, "")

    def log_message(self, *_):
        pass


class ControlRequest(Request):
    def answer(self, camera):
        self.wfile.write(plain(camera.control(self.query)))


class CameraRequest(Request):
    STREAMS = "/axis-cgi/mjpg/video.cgi", "/mjpg/video.mjpg"
    IMAGES = *STREAMS, "/axis-cgi/jpg/image.cgi", "/jpg/image.jpg"

    def setup(self):
        super().setup()
        self.server.camera.accept()

    def answer(self, camera):
        self.resolution = self.word("resolution") or camera.parameters.values["Image.I0.Appearance.Resolution"]
        refusal = camera.refusal(self.command, self.path, self.headers.get("Authorization", ""))
        text = refusal or self.simple_answer(camera, camera.behaviour)
        self.send(text) if text else self.stream(camera, camera.behaviour)

    def simple_answer(self, camera, behaviour):
        """Nothing for a stream."""
        if self.route in ("/axis-cgi/param.cgi", "/axis-cgi/admin/param.cgi"):
            return camera.parameter_answer(self.route, self.word("action"), self.word("group"), self.query)
        if self.route in self.IMAGES:
            if self.resolution not in RESOLUTIONS:
                return page("400 Bad Request")
            if behaviour["status"] != 200 or behaviour["html"]:
                return page(f"{behaviour['status']} Status")
            if self.route not in self.STREAMS:
                return answer_text("200 OK", "image/jpeg", shown(behaviour, self.image(camera)))
            return None
        return page("404 Not Found")

    def image(self, camera):
        compression = self.word("compression") or camera.parameters.values["Image.I0.Appearance.Compression"]
        return camera.image(self.resolution, min(max(int(compression), 0), 100))

    def stream(self, camera, behaviour):
        kind = stream_type(behaviour)
        self.send(f"HTTP/1.0 200 OK\r\nCache-Control: no-cache\r\nConnection: close\r\nContent-Type: {kind}\r\n\r\n".encode())
        rates = self.word("fps"), camera.parameters.values["Image.I0.Stream.FPS"], behaviour["fps"]
        period = 1 / next(int(rate) for rate in rates if rate and int(rate) > 0)
        due = time.monotonic()
        for count in itertools.count():
            if 0 <= behaviour["close_after"] <= count:
                return
            time.sleep(max(0, due - time.monotonic()))
            with camera.changed:
                camera.changed.wait_for(lambda: not behaviour["stall"])
            part = stream_part(behaviour, self.image(camera))
            if 0 <= behaviour["cut_after"] <= count:
                return self.send(part[:len(part) // 2])
            if behaviour["endless_head"] or behaviour["endless_part"]:
                start = b"Content-Type: image/jpeg\r\n\r\n\xff\xd8" if behaviour["endless_part"] else b""
                self.send(b"--myboundary\r\n" + start + b"x" * (64 << 20))
            self.send(part)
            due = max(due + period, time.monotonic() - period)

    def send(self, text):
        """All at once, or in slices of 50 ms."""
        while text:
            rate = self.server.camera.behaviour["bytes_per_s"]
            size = max(1, rate // 20) if rate > 0 else len(text)
            self.wfile.write(text[:size])
            text = text[size:]
            if rate > 0:
                time.sleep(0.05)


class Camera:
    """The state that all requests share, and its two servers."""

    def __init__(self, address, port, control_port, owner, behaviour):
        self.behaviour, self.parameters, self.login, self.painter = behaviour, Parameters(), Login(owner), Painter()
        self.counts = dict.fromkeys(("connections", "wrong_logins", "updates", "pictures"), 0)
        self.changed = threading.Condition()  # of the behaviour; its lock protects everything here
        self.started, self.address = time.monotonic(), address
        self.server = Server(address, port, "port", CameraRequest, self)
        self.port = self.server.server_address[1]
        self.control_port = Server("127.0.0.1", control_port, "control", ControlRequest, self).server_address[1]
        self.apply_down()

    def apply_down(self):
        if self.behaviour["down"] and self.server:
            self.server.stop()
            self.server = None
        elif not self.behaviour["down"] and not self.server:
            self.server = Server(self.address, self.port, "port", CameraRequest, self)

    def control(self, words):
        with self.changed:
            try:
                for name, value in words:
                    self.behaviour.set(name, value)
                self.apply_down()
            except (OSError, ValueError) as problem:
                return f"# Error: {problem}\n"
            self.changed.notify_all()
            return str(self.behaviour) + "".join(f"{name}={count}\n" for name, count in self.counts.items())

    def accept(self):
        with self.changed:
            self.counts["connections"] += 1
            self.changed.wait_for(lambda: not self.behaviour["mute"])

    def refusal(self, method, uri, authorization):
        """An answer that does not depend on the route, or nothing."""
        behaviour = self.behaviour
        with self.changed:
            verdict = self.login.check(behaviour, method, uri, authorization)
            if behaviour["redirect"]:
                return page("302 Found", "Location: " + behaviour["redirect"])
            if behaviour["foreign"]:
                return page("404 Not Found")
            if behaviour["huge_head"]:
                return page("200 OK", *["X-Filler: " + "x" * 88] * 1024)
            if verdict == "welcome" and not behaviour["unauthorised"]:
                return None
            # A scheme that is no longer accepted, or a stale nonce, is not a wrong password.
            self.counts["wrong_logins"] += bool(authorization) and verdict not in ("stale", "unknown")
            return page("401 Unauthorized", *("WWW-Authenticate: " + one for one in self.login.challenges(behaviour, verdict)))

    def parameter_answer(self, route, action, group, query):
        with self.changed:
            if action == "list":
                return plain(self.parameters.list(group))
            if action != "update":
                return plain("# Error: unknown action\r\n")
            if self.behaviour["old_firmware"] and route == "/axis-cgi/param.cgi":
                return page("404 Not Found")
            self.counts["updates"] += 1
            values = [(name, value) for name, value in query if name != "action"]
            return plain(self.parameters.update(values, self.behaviour["step"]))

    def image(self, resolution, compression):
        with self.changed:
            self.counts["pictures"] += 1
            index = int((time.monotonic() - self.started) * 25)
            return self.painter.jpeg(self.parameters.values, resolution, compression, index)


def settings_of(words):
    """Returns the arguments of Camera."""
    given, behaviour = {"port": "0", "control": "0", "address": "127.0.0.1", "credentials": ""}, Behaviour()
    for word in words:
        name, equals, value = word.partition("=")
        if not equals:
            raise ValueError(f"{word}: write it as name=value")
        if name in given:
            given[name] = value
        else:
            behaviour.set(name, value)
    ports = [int(given[name]) if given[name].isdigit() else -1 for name in ("port", "control")]
    if not all(0 <= port <= 65535 for port in ports):
        raise ValueError("a port is a number from 0 to 65535")
    try:
        ipaddress.IPv4Address(given["address"])
    except ValueError:
        raise ValueError(f"address={given['address']} is not an IPv4 address, such as 192.0.2.10") from None
    owner = open(given["credentials"]).readline().strip() if given["credentials"] else "root:pass"
    return given["address"], *ports, owner.split(":", 1), behaviour


def main(words):
    if "--help" in words:
        return print(__doc__)
    cv2.setNumThreads(1)
    try:
        camera = Camera(*settings_of(words))
    except ValueError as problem:
        print(f"axis_camera.py: {problem}; see axis_camera.py --help", file=sys.stderr)
        sys.exit(2)
    except OSError as problem:
        sys.exit(f"axis_camera.py: {problem}")
    print(f"camera at http://{camera.address}:{camera.port}\ncontrol at http://127.0.0.1:{camera.control_port}", flush=True)
    threading.Event().wait()


if __name__ == "__main__":
    main(sys.argv[1:])
