"""The page of docs/playground in headless Chromium: playground.py PAGE NUMBERS SCREENSHOT

Its numbers are those of the native program NUMBERS; keys change what is shown; it is fast and small enough.
"""

import base64
import fcntl
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path


class Browser:
    """Chromium's DevTools protocol, through two pipes that are the browser's descriptors 3 and 4."""

    def __init__(self, folder):
        to_browser, from_browser = os.pipe(), os.pipe()

        def descriptors():
            # Copies first: one of the pipes may be descriptor 3 or 4 itself.
            ends = [fcntl.fcntl(end, fcntl.F_DUPFD, 10) for end in (to_browser[0], from_browser[1])]
            os.dup2(ends[0], 3)
            os.dup2(ends[1], 4)

        program = shutil.which("chromium") or "chromium"
        options = ["--headless", "--no-sandbox", "--disable-gpu", "--remote-debugging-pipe", "--window-size=900,1700"]
        self.process = subprocess.Popen([program, *options, f"--user-data-dir={folder}", "about:blank"],
            preexec_fn=descriptors, close_fds=False, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)  # fmt: skip
        os.close(to_browser[0])
        os.close(from_browser[1])
        self.out, self.input, self.count, self.session = os.fdopen(to_browser[1], "wb"), from_browser[0], 0, None
        self.buffer = b""
        target = next(t for t in self.call("Target.getTargets")["targetInfos"] if t["type"] == "page")
        attached = self.call("Target.attachToTarget", targetId=target["targetId"], flatten=True)
        self.session = attached["sessionId"]
        self.call("Page.enable")

    def call(self, method, **parameters):
        self.count += 1
        message = {"id": self.count, "method": method, "params": parameters}
        if self.session:
            message["sessionId"] = self.session
        self.out.write(json.dumps(message).encode() + b"\0")
        self.out.flush()
        while True:
            while b"\0" not in self.buffer:
                read = os.read(self.input, 1 << 20)
                assert read, "Chromium has ended"
                self.buffer += read
            one, self.buffer = self.buffer.split(b"\0", 1)
            answer = json.loads(one)
            if answer.get("id") == self.count:
                assert "error" not in answer, (method, answer["error"])
                return answer["result"]

    def value(self, expression):
        answer = self.call("Runtime.evaluate", expression=expression, returnByValue=True)
        assert "exceptionDetails" not in answer, answer
        return answer["result"].get("value")

    def wait(self, expression, seconds=40):
        end = time.monotonic() + seconds
        while not self.value(expression):
            assert time.monotonic() < end, f"after {seconds} s still not: {expression}"
            time.sleep(0.05)

    def key(self, key, code):
        for kind in ("keyDown", "keyUp"):
            self.call("Input.dispatchKeyEvent", type=kind, key=key, code=key, windowsVirtualKeyCode=code)


def main():
    page, numbers, screenshot = sys.argv[1:]
    assert os.path.getsize(page) <= 600_000, f"the page has {os.path.getsize(page)} bytes, more than 600,000"
    with tempfile.TemporaryDirectory() as folder:
        browser = Browser(folder)
        start = time.monotonic()
        browser.call("Page.navigate", url=Path(page).resolve().as_uri() + "#samples=4&sampler=2&blur=2.1")
        browser.wait("typeof wasm === 'object' && document.getElementById('oursText').textContent !== ''")
        print(f"pictures {time.monotonic() - start:.2f} s after loading began")
        for samples, sampler, fits, blur in ((4, 2, 0, 2.1), (1, 2, 1, 0), (1, 2, 0, 0), (16, 1, 0, 1), (64, 0, 0, 0)):
            browser.value(f"location.hash = '#samples={samples}&sampler={sampler}&fits={fits}&moving=0&blur={blur}'")
            wanted = f"{{samples: {samples}, sampler: {sampler}, fits: {fits}, moving: 0, blur: {blur}}}"
            browser.wait(f"measured !== undefined && JSON.stringify(settings()) === JSON.stringify({wanted})")
            found = browser.value("JSON.parse(measured)")
            line = subprocess.check_output([numbers, *map(str, (samples, sampler, fits, 0, blur))], text=True).split()
            assert found["errors"] == [float(line[0]), float(line[1])], (found, line)
            assert found["fitted"] == int(line[2]), (found, line)
            if sampler == 2:
                assert found["errors"][0] < found["errors"][1], found
        browser.value("location.hash = '#samples=4&sampler=2&fits=0&moving=0&blur=2.1'")
        browser.wait("curve.length === COUNTS.length")
        with open(screenshot, "wb") as file:
            file.write(base64.b64decode(browser.call("Page.captureScreenshot")["data"]))
        # What is chosen anew takes the old curve away.
        # Letters' edges are of any red, but see-through.
        colours = "find('curve').getContext('2d').getImageData(0, 0, 640, 240).data"
        is_drawn = f"{colours}.some((red, i, all) => i % 4 === 0 && red > 200 && all[i + 3] > 200)"
        assert browser.value(is_drawn) and not browser.value(f"changed(), {is_drawn}"), "an old curve is shown"
        browser.value("form.samples.focus()")
        browser.key("ArrowRight", 39)
        browser.wait("settings().samples === 8 && location.hash.includes('samples=8')")
        browser.value("location.hash = '#samples=1&sampler=2&fits=0&moving=1&blur=0'")
        browser.wait("frame > 60")
        rate = browser.value("1000 * (times.length - 1) / (times[times.length - 1] - times[0])")
        print(f"moving, 256 x 256 pixels, 1 sample: {rate:.0f} frames/s")
        # Of a machine that may be busy with other things.
        assert rate > 5, rate
        browser.call("Emulation.setDeviceMetricsOverride", width=360, height=740, deviceScaleFactor=1, mobile=True)
        assert browser.value("document.documentElement.scrollWidth") <= 360, "wider than a phone"
        browser.session = None
        browser.call("Browser.close")
        browser.process.wait(20)


main()
