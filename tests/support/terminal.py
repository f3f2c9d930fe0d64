# Runs a command on a terminal of its own: terminal.py COLUMNS TEXT COMMAND...
# Prints what the terminal gets; presses Ctrl-C once TEXT was printed, if that is not empty. Exits with the command's code.
import fcntl
import os
import pty
import select
import struct
import sys
import termios
import time

columns, text, command = int(sys.argv[1]), sys.argv[2].encode(), sys.argv[3:]
begun, begin = os.pipe()
child, terminal = pty.fork()
if child == 0:
    os.read(begun, 1)  # until the terminal has its size
    os.execvp(command[0], command)
fcntl.ioctl(terminal, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
os.write(begin, b"x")
shown, end = b"", time.monotonic() + 30
while time.monotonic() < end:
    if not select.select([terminal], [], [], 0.1)[0]:
        continue
    try:
        got = os.read(terminal, 65536)
    except OSError:  # the command has closed it
        break
    shown += got
    if text and text in shown:
        os.write(terminal, b"\x03")
        text = b""
sys.stdout.buffer.write(shown.replace(b"\r\n", b"\n"))
sys.stdout.flush()
sys.exit(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
