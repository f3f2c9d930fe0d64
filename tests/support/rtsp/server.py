#!/usr/bin/python3
# An RTSP server for tests (GStreamer's): server.py PORT FPS [--login USER:PASSWORD] [--udp] [--clock].
# Its stream is at /live, H.264, 320x240; it prints "ready" when it listens.
import argparse
import threading
import time

import gi

gi.require_version("Gst", "1.0")
gi.require_version("GstRtsp", "1.0")
gi.require_version("GstRtspServer", "1.0")
from gi.repository import GLib, Gst, GstRtsp, GstRtspServer  # noqa: E402

arguments = argparse.ArgumentParser()
arguments.add_argument("port")
arguments.add_argument("fps", type=int)
arguments.add_argument("--login")
arguments.add_argument("--udp", action="store_true", help="refuse TCP")
arguments.add_argument("--clock", action="store_true",
                       help="pictures show when they were made: 32 fields, black or white, from the left; the milliseconds since "
                       "1970 in binary, highest bit first")
options = arguments.parse_args()


def picture_of(milliseconds):
    """Grey values, then two planes without colour (I420)."""
    fields = (b"\xeb" * 10 if milliseconds >> bit & 1 else b"\x10" * 10 for bit in range(31, -1, -1))
    return b"".join(fields) * 240 + b"\x80" * (320 * 120)


def push_pictures(source):
    """Until the stream is closed."""
    due = time.monotonic()
    while source.emit("push-buffer", Gst.Buffer.new_wrapped(picture_of(int(time.time() * 1000)))) == Gst.FlowReturn.OK:
        due += 1 / options.fps
        time.sleep(max(0, due - time.monotonic()))


def play(_, media):
    source = media.get_element().get_child_by_name("source")
    threading.Thread(target=push_pictures, args=[source], daemon=True).start()


Gst.init(None)
server = GstRtspServer.RTSPServer()
server.set_address("127.0.0.1")
server.set_service(options.port)
factory = GstRtspServer.RTSPMediaFactory()
form = f"video/x-raw,width=320,height=240,framerate={options.fps}/1"
if options.clock:
    pictures = f"appsrc name=source is-live=true do-timestamp=true format=time caps={form},format=I420"
    factory.connect("media-configure", play)
else:
    pictures = f"videotestsrc is-live=true ! {form}"
factory.set_launch(
    f"( {pictures} ! x264enc tune=zerolatency speed-preset=ultrafast key-int-max={options.fps} threads=1 "
    "! rtph264pay name=pay0 pt=96 config-interval=1 )")
factory.set_shared(True)
factory.set_protocols(GstRtsp.RTSPLowerTrans.UDP if options.udp else GstRtsp.RTSPLowerTrans.TCP)
if options.login:
    user, password = options.login.split(":", 1)
    auth = GstRtspServer.RTSPAuth()
    auth.set_supported_methods(GstRtsp.RTSPAuthMethod.DIGEST)
    token = GstRtspServer.RTSPToken()
    token.set_string(GstRtspServer.RTSP_TOKEN_MEDIA_FACTORY_ROLE, "user")
    auth.add_digest(user, password, token)
    server.set_auth(auth)
    permissions = GstRtspServer.RTSPPermissions()
    permissions.add_permission_for_role("user", GstRtspServer.RTSP_PERM_MEDIA_FACTORY_ACCESS, True)
    permissions.add_permission_for_role("user", GstRtspServer.RTSP_PERM_MEDIA_FACTORY_CONSTRUCT, True)
    factory.set_permissions(permissions)
server.get_mount_points().add_factory("/live", factory)
if server.attach(None) == 0:
    raise SystemExit(f"port {options.port} is taken")
print("ready", flush=True)
GLib.MainLoop().run()
