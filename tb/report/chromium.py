"""Drives a headless Chromium over its pipe of the DevTools protocol, with Python's own library only."""
import base64
import json
import os
import select
import signal
import subprocess
import tempfile
import time


class Page:
    """A page in a Chromium of its own; `errors` collects what its console complains of."""

    def __init__(self, program="chromium", width=1280, height=900):
        self.profile = tempfile.TemporaryDirectory(prefix="fovea-chromium-")
        to_browser, ours_out = os.pipe()
        ours_in, from_browser = os.pipe()
        self.out, self.inp = ours_out, ours_in

        def ends():
            # Chromium reads commands from descriptor 3 and writes answers to 4.
            os.dup2(to_browser, 3) if to_browser != 3 else os.set_inheritable(3, True)
            os.dup2(from_browser, 4) if from_browser != 4 else os.set_inheritable(4, True)

        # Copies above 4, so that the dup2 calls above cannot overwrite each other's source.
        import fcntl
        to_browser = fcntl.fcntl(to_browser, fcntl.F_DUPFD, 10)
        from_browser = fcntl.fcntl(from_browser, fcntl.F_DUPFD, 10)
        self.process = subprocess.Popen(
            [program, "--headless=new", "--no-sandbox", "--disable-gpu", "--remote-debugging-pipe", "--no-first-run",
             "--disable-dev-shm-usage", "--disable-background-networking", "--hide-scrollbars", "--force-color-profile=srgb",
             f"--user-data-dir={self.profile.name}", f"--window-size={width},{height}", "about:blank"],
            preexec_fn=ends, close_fds=False, start_new_session=True, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL)
        os.close(to_browser)
        os.close(from_browser)
        self.buffer, self.last, self.events, self.errors, self.requests = b"", 0, [], [], []
        self.session = None
        targets = self.command("Target.getTargets")["targetInfos"]
        target = next(t["targetId"] for t in targets if t["type"] == "page")
        self.session = self.command("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.command(f"{domain}.enable")

    def _read(self, seconds):
        end = time.monotonic() + seconds
        while b"\0" not in self.buffer:
            left = end - time.monotonic()
            if left <= 0 or not select.select([self.inp], [], [], left)[0]:
                raise TimeoutError("Chromium does not answer")
            got = os.read(self.inp, 1 << 20)
            if not got:
                raise ConnectionError("Chromium has ended")
            self.buffer += got
        line, self.buffer = self.buffer.split(b"\0", 1)
        return json.loads(line)

    def _note(self, message):
        method, params = message.get("method"), message.get("params", {})
        self.events.append(method)
        if method == "Runtime.exceptionThrown":
            details = params["exceptionDetails"]
            self.errors.append(details.get("exception", {}).get("description", details["text"]))
        elif method == "Log.entryAdded" and params["entry"]["level"] in ("error", "warning"):
            self.errors.append(params["entry"]["text"])
        elif method == "Runtime.consoleAPICalled" and params["type"] in ("error", "warning", "assert"):
            self.errors.append(" ".join(str(a.get("value", a.get("description"))) for a in params["args"]))
        elif method == "Network.requestWillBeSent":
            self.requests.append(params["request"]["url"])

    def command(self, method, seconds=60, **params):
        self.last += 1
        message = {"id": self.last, "method": method, "params": params}
        if self.session:
            message["sessionId"] = self.session
        data = json.dumps(message).encode() + b"\0"
        while data:
            data = data[os.write(self.out, data):]
        while True:
            answer = self._read(seconds)
            if answer.get("id") == self.last:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']['message']}")
                return answer["result"]
            self._note(answer)

    def open(self, file):
        self.command("Page.navigate", url="file://" + os.path.abspath(file))
        for _ in range(200):
            if self.run("document.readyState === 'complete' && document.documentElement.dataset.ready === 'true'"):
                return
            time.sleep(0.05)
        raise TimeoutError(f"{file} is not ready; {self.errors}")

    def run(self, script):
        """The value of an expression, awaited if it is a promise."""
        result = self.command("Runtime.evaluate", expression=script, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in result:
            raise RuntimeError(result["exceptionDetails"].get("exception", {}).get("description", "script failed"))
        return result["result"].get("value")

    def key(self, key, code=None, text=None):
        for kind in ("keyDown", "keyUp"):
            extra = {"text": text} if text and kind == "keyDown" else {}
            codes = {"Tab": 9, "Enter": 13, " ": 32, "ArrowLeft": 37, "ArrowRight": 39, "Escape": 27, "End": 35, "Home": 36}
            self.command("Input.dispatchKeyEvent", type=kind, key=key, code=code or key,
                         windowsVirtualKeyCode=codes.get(key, 0), **extra)

    def look(self, width, dark=False, medium=""):
        self.command("Emulation.setDeviceMetricsOverride", width=width, height=900, deviceScaleFactor=1, mobile=False)
        self.command("Emulation.setEmulatedMedia", media=medium,
                     features=[{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}])

    def screenshot(self, file):
        shot = self.command("Page.captureScreenshot", format="png", captureBeyondViewport=True,
                            clip={**self.run("({x: 0, y: 0, width: innerWidth, height: document.documentElement.scrollHeight})"), "scale": 1})
        with open(file, "wb") as out:
            out.write(base64.b64decode(shot["data"]))

    def pdf(self, file):
        with open(file, "wb") as out:
            out.write(base64.b64decode(self.command("Page.printToPDF", preferCSSPageSize=True, printBackground=False)["data"]))

    def close(self):
        os.killpg(self.process.pid, signal.SIGKILL)
        self.process.wait()
        os.close(self.out)
        os.close(self.inp)
        time.sleep(0.2)
        self.profile.cleanup()
