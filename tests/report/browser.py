"""A headless Chromium that a test uses as a reader would, by WebDriver, with Python's standard library."""

import json
import re
import shutil
import subprocess
import time
import urllib.error
import urllib.request

ELEMENT_KEY = "element-6066-11e4-a52e-4f735466cecf"  # of the WebDriver standard


class Browser:
    """One headless browser, without a network."""

    def __init__(self, folder):
        self.driver = subprocess.Popen(
            [shutil.which("chromedriver"), "--port=0"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        for line in self.driver.stdout:
            started = re.search(r"started successfully on port (\d+)", line)
            if started:
                self.base = f"http://127.0.0.1:{started.group(1)}"
                break
        arguments = ["--headless=new", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
                     "--disable-dev-shm-usage", "--disable-background-networking", "--disable-component-update",
                     "--disable-sync", "--host-resolver-rules=MAP * ~NOTFOUND", "--window-size=1366,768",
                     f"--user-data-dir={folder}/profile"]
        capabilities = {"goog:chromeOptions": {"binary": shutil.which("chromium"), "args": arguments},
                        "goog:loggingPrefs": {"browser": "ALL", "performance": "ALL"}}
        self.session = ""
        try:
            session = self.call("POST", "/session", {"capabilities": {"alwaysMatch": capabilities}})
        except Exception:
            self.driver.terminate()
            raise
        self.session = "/session/" + session["sessionId"]
        self.call("POST", "/timeouts", {"script": 180000})  # a loaded machine draws slowly
        self.command("Browser.setDownloadBehavior", {"behavior": "allow", "downloadPath": str(folder)})

    def call(self, verb, path, body=None):
        request = urllib.request.Request(self.base + self.session + path, method=verb,
                                         data=None if body is None else json.dumps(body).encode(),
                                         headers={"Content-Type": "application/json"})
        try:
            with urllib.request.urlopen(request, timeout=200) as answer:
                return json.load(answer)["value"]
        except urllib.error.HTTPError as fault:
            raise RuntimeError(f"{verb} {path}: {fault.read().decode(errors='replace')[:500]}") from fault

    def command(self, name, parameters):
        """A command of the DevTools protocol."""
        return self.call("POST", "/goog/cdp/execute", {"cmd": name, "params": parameters})

    def script(self, code, *arguments):
        return self.call("POST", "/execute/sync", {"script": code, "args": list(arguments)})

    def click(self, selector):
        found = self.call("POST", "/element", {"using": "css selector", "value": selector})
        self.script("arguments[0].scrollIntoView({block: 'center', behavior: 'instant'})", found)
        self.call("POST", f"/element/{found[ELEMENT_KEY]}/click", {})

    def log(self, kind):
        return self.call("POST", "/se/log", {"type": kind})

    def wait(self, code, seconds=20):
        """The value of a script as soon as it is true."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            value = self.script(code)
            if value:
                return value
            time.sleep(0.05)
        raise AssertionError(f"never became true: {code}")

    def close(self):
        try:
            self.call("DELETE", "")
        finally:
            self.driver.terminate()
            self.driver.wait()
            self.driver.stdout.close()
