#!/usr/bin/env python3
"""A server that misbehaves, for tests: /MODE/NAME answers with ranges of FOLDER/NAME, in a way of MODE.

    http_server.py FOLDER       prints its port, then the mode and the end of each range: before it is sent, and when it
                                was sent; until it is killed
"""

import http.server
import pathlib
import sys
import time

FOLDER = pathlib.Path(sys.argv[1])
seen = {}  # How often each path was asked for.


class Handler(http.server.BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"

    def log_message(self, *_):
        pass

    def do_GET(self):
        count = seen[self.path] = seen.get(self.path, 0) + 1
        _, mode, name = self.path.partition("?")[0].split("/")
        if mode == "missing" or not (FOLDER / name).is_file():
            return self.send_error(404)
        data = (FOLDER / name).read_bytes()
        if mode == "busy" and count <= 2 or mode == "busy-always":
            return self.send_error(503)
        if mode in ("redirect", "circle", "file"):
            place = {"redirect": f"/ok/{name}", "circle": self.path, "file": "file:///etc/hostname"}
            self.send_response(302)
            self.send_header("Location", place[mode])
            self.send_header("Content-Length", "0")
            return self.end_headers()
        if mode == "changed" and count > 1:
            data += b"more"
        self.send_data(mode, count, data)

    def send_data(self, mode, count, data):
        wanted = self.headers["Range"].removeprefix("bytes=").split("-")
        first, last = int(wanted[0]), min(int(wanted[1]), len(data) - 1)
        shut = mode == "gate" and last >= 2 << 18 or mode == "shut"
        if shut:
            print(f"{mode} is shut", flush=True)
        while shut and not (FOLDER / "open").exists():
            time.sleep(0.01)
        if mode == "other-range":
            first += 1
        part = data if mode == "whole" else data[first : last + 1]
        if mode == "more":
            part += b"more"
        if mode == "damaged-second" and count == 2:
            part = bytes([part[0] ^ 1]) + part[1:]
        if mode == "damaged":
            part = part[:-9] + b"x" + part[-8:]
        print(f"{mode} sends to {last}", flush=True)
        self.send_response(200 if mode == "whole" else 206)
        self.send_header("Content-Range", f"bytes {first}-{last}/{len(data)}")
        self.send_header("Content-Length", str(len(part)))
        self.end_headers()
        if mode == "breaks" and count == 1 or mode == "breaks-always":
            self.wfile.write(part[: len(part) // 2])
            self.close_connection = True
            return
        if mode == "drip":
            for byte in part[:500]:
                self.wfile.write(bytes([byte]))
                time.sleep(0.01)
            self.close_connection = True
            return
        for begin in range(0, len(part), 4096):
            self.wfile.write(part[begin : begin + 4096])
            if mode == "slow":
                time.sleep(0.02)
        print(f"{mode} to {last}", flush=True)


server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler)
print(server.server_port, flush=True)
server.serve_forever()
