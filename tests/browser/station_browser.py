#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A day at the inspection station in a real browser, headless: an empty folder, a good foil, a bad one,
a scan that is half written, a file that is no scan; a barcode; a serial number that is half typed while results
come; two browsers at once; History, a report, a chart that is zoomed by dragging, a lot that is closed and downloaded;
a phone; a station that is killed; a cause that is found and accepted; dark pages, large letters, the keyboard alone. Ends with an error at the first thing that is not as said.

    tests/browser/station_browser.py PROGRAM [--renderer PROGRAM]
    tests/browser/station_browser.py PROGRAM --pictures FOLDER      draws the tabs instead

Needs Debian's chromium, chromium-driver and python3-selenium; without them the exit code is 77."""

import argparse
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import xml.etree.ElementTree

try:
    from selenium import webdriver
    from selenium.common.exceptions import WebDriverException
    from selenium.webdriver.chrome.service import Service
    from selenium.webdriver.common.action_chains import ActionChains
    from selenium.webdriver.common.by import By
    from selenium.webdriver.common.keys import Keys
except ImportError:
    print("skipped: python3-selenium is not on this machine")
    sys.exit(77)

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
TABS = (("now", "/"), ("history", "/history"), ("trends", "/trends?newest=all"), ("scanner", "/scanner"),
        ("lots", "/lots"), ("orders", "/orders"))
WIDTH = 1280
TALLEST = {"now": 1000, "history": 900}  # px of a picture; the rest below is more of the same
TALLEST_OTHERS = 1280
LIMITS = {"radius_mm": {"min": 3.3, "max": 3.34}}  # of a foil that is drawn with 3.32 mm
GOOD_MM, BAD_MM = 3.32, 3.4
WAIT_S = 20
RECEIVE_S = 3  # of the recipe: how long a scan that is not whole may pause
SILENT_S = 5  # a page that has lost its station says so within these
PHONE = {"width": 390, "height": 844, "deviceScaleFactor": 1, "mobile": True}
GREY = "grayscale"


def wait(what, seconds=WAIT_S):
    """Returns the value of `what()` as soon as it is true. A page may change or go between finding an element and reading
    it: some drivers call that stale, others say that a node does not belong to the document, or that navigation
    has aborted a script."""
    end = time.time() + seconds
    while True:
        trouble = None
        try:
            found = what()
        except WebDriverException as error:
            found, trouble = None, error
        if found:
            return found
        if time.time() > end:
            raise AssertionError("waited in vain") from trouble
        time.sleep(0.02)


def expect(true, words):
    if not true:
        raise AssertionError(words)


CONTRAST_MIN = 4.5  # WCAG 2.1, AA
# Texts of the page whose contrast to what lies behind them is below the limit. Pictures of scans have outlined letters.
LOW_CONTRAST = """
function parse(text) {
  var n = (text.match(/[\\d.]+/g) || [0, 0, 0, 0]).map(Number);
  return [n[0], n[1], n[2], n.length > 3 ? n[3] : 1];
}
function luminance(c) {
  return [0.2126, 0.7152, 0.0722].reduce(function (sum, weight, i) {
    var v = c[i] / 255;
    return sum + weight * (v <= 0.04045 ? v / 12.92 : Math.pow((v + 0.055) / 1.055, 2.4));
  }, 0);
}
function ground(element) {
  for (; element; element = element.parentElement) {
    var c = parse(getComputedStyle(element).backgroundColor);
    if (c[3] > 0.5) return c;
  }
  return matchMedia('(prefers-color-scheme: dark)').matches ? [18, 18, 18, 1] : [255, 255, 255, 1];
}
var low = [], walk = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT), node;
while ((node = walk.nextNode())) {
  var at = node.parentElement, box = at.getBoundingClientRect();
  if (!node.data.trim() || !box.width || at.closest('.picture, script, style, datalist, title, [disabled]')) continue;
  var style = getComputedStyle(at);
  if (style.visibility === 'hidden' || style.display === 'none') continue;
  var one = luminance(parse(at.closest('svg') ? style.fill : style.color)), other = luminance(ground(at));
  var ratio = (Math.max(one, other) + 0.05) / (Math.min(one, other) + 0.05);
  if (ratio < arguments[0]) low.push(ratio.toFixed(2) + ' ' + at.tagName + '.' + (at.className.baseVal || at.className) + ' ' + node.data.trim().slice(0, 30));
}
return low;
"""


class Station:
    """A station that runs, and its address."""

    def __init__(self, program, folder, recipe, errors, *options):
        self.command = [program, "station", folder, "--recipe", recipe, *options]
        self.errors = errors
        self.start("0")

    def start(self, port):
        self.process = subprocess.Popen(self.command + ["--port", port], stdout=subprocess.PIPE, stderr=self.errors,
                                        text=True)
        self.address = self.process.stdout.readline().strip()
        expect(self.address.startswith("http://"), f"no address: {self.address!r}")

    def start_again(self):
        """At the address that pages know."""
        self.start(self.address.rstrip("/").rsplit(":", 1)[1])

    def end(self):
        self.process.terminate()
        self.process.wait()

    def kill(self):
        self.process.kill()
        self.process.wait()


def open_browser(downloads):
    options = webdriver.ChromeOptions()
    for argument in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--hide-scrollbars",
                     f"--window-size={WIDTH},1000"):
        options.add_argument(argument)
    options.add_experimental_option("prefs", {"download.default_directory": downloads})
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    return webdriver.Chrome(service=Service(shutil.which("chromedriver")), options=options)


class Day:
    """An inspector's day, one step after the other."""

    def __init__(self, browser, station, folder, work, renderer):
        self.browser, self.station, self.folder, self.work = browser, station, folder, work
        self.renderer, self.seed = renderer, 0

    def go(self, path):
        self.browser.get(self.station.address.rstrip("/") + path)

    def one(self, selector):
        return wait(lambda: (self.browser.find_elements(By.CSS_SELECTOR, selector) or [None])[0])

    def text(self, selector="main"):
        """In one step, so that no page comes between."""
        return wait(lambda: self.browser.execute_script(
            "var e=document.querySelector(arguments[0]);return e&&e.innerText", selector))

    def press(self, find):
        """Clicks the first of what `find` comes to; a page that is replaced before that is looked at again."""
        def pressed():
            found = find()
            if found:
                found[0].click()
            return bool(found)

        wait(pressed)

    def follow(self, words):
        self.press(lambda: self.browser.find_elements(By.PARTIAL_LINK_TEXT, words))

    def draw(self, path, radius_mm):
        self.seed += 1
        spec = os.path.join(self.work, "spec.json")
        with open(spec, "w", encoding="utf-8") as file:
            json.dump({"schema": "foilgauge/render/1", "seed": self.seed, "scanner": {"dpi": 1200}, "foils": [
                {"rotate_deg": -90, "design": {"bump_count": 2, "bump_radius_mm": radius_mm}}]}, file)
        subprocess.run([self.renderer, "render", spec, "-o", path], check=True)

    def drop(self, name, radius_mm):
        """As a scanner's program does: it writes elsewhere and renames."""
        self.draw(os.path.join(self.work, "drawn.png"), radius_mm)
        shutil.copy(os.path.join(self.work, "drawn.png"), os.path.join(self.folder, "." + name))
        os.rename(os.path.join(self.folder, "." + name), os.path.join(self.folder, name))

    def card(self, name, call, *words):
        """The newest card becomes that of `name`, by itself: nothing is loaded here."""
        def shown():
            large, page = self.text(".call"), self.text("main > section")
            return name in large and call in large and all(word in page for word in words)

        try:
            wait(shown)
        except AssertionError:
            raise AssertionError(f"no card of {name} with {call!r}, {words}: {self.text()}") from None

    def cards(self):
        self.go("/")
        expect("READY" in self.text(".call"), "an empty folder is not ready")
        self.browser.execute_script("window.never_loaded = true")
        self.drop("7_good.png", GOOD_MM)
        self.card("7_good.png", "PASS", "Put the foil with the good ones")
        self.drop("7_bad.png", BAD_MM)
        self.card("7_bad.png", "FAIL", "Put the foil aside", "beyond", "max 3.34")
        expect(len(self.browser.find_elements(By.CSS_SELECTOR, ".decided li.fail")) >= 2, "the values are not red")
        expect(self.one("svg.picture, .picture").size["width"] > 600, "no picture of the bad foil")
        self.draw(os.path.join(self.work, "half.png"), GOOD_MM)
        with open(os.path.join(self.work, "half.png"), "rb") as file:
            whole = file.read()
        with open(os.path.join(self.folder, "7_half.png"), "wb") as file:
            file.write(whole[:len(whole) // 2])
        self.card("7_half.png", "RECEIVING", "The verdict comes by itself", "Before it: 7_bad.png FAIL")
        self.card("7_half.png", "SCAN AGAIN", "its end is missing", "Scan the foil again")
        with open(os.path.join(self.folder, "notes.txt"), "w", encoding="utf-8") as file:
            file.write("not a scan\n")
        self.card("notes.txt", "NO SCAN", "take this file out")
        with open(os.path.join(self.folder, "7_half.png"), "wb") as file:
            file.write(whole)
        self.card("7_half.png", "PASS")
        expect(self.browser.execute_script("return window.never_loaded"), "the page was loaded, not told")

    def barcode(self):
        """A reader types where the focus is, over what stands there, and ends with Enter."""
        self.go("/")
        expect(self.browser.switch_to.active_element.get_attribute("name") == "serial", "the serial has no focus")
        ActionChains(self.browser).send_keys("SN-4711", Keys.ENTER).perform()
        wait(lambda: "SN-4711" in self.text("h2"))
        expect("Foil SN-4711" in self.text("h2"), "the barcode was not taken: " + self.text("h2"))

    def is_grey(self):
        """The verdict has no colour, and the page says why."""
        return self.browser.execute_script(
            "var c=document.querySelector('.call'),s=document.getElementById('silent');"
            "return getComputedStyle(c).filter.includes(arguments[0])&&s.getClientRects().length>0", GREY)

    def half_typed(self):
        """A half-typed serial stays with its foil, and hides no result: "2 newer: FAIL, PASS"."""
        self.go("/")
        self.drop("7_typed.png", GOOD_MM)
        self.card("7_typed.png", "PASS")
        wait(lambda: self.browser.find_elements(By.CSS_SELECTOR, "svg.picture"))
        ActionChains(self.browser).send_keys("SN-47").perform()
        self.drop("7_newer1.png", GOOD_MM)
        self.card("7_newer1.png", "PASS", "1 newer: PASS")
        ActionChains(self.browser).send_keys("1").perform()
        self.drop("7_newer2.png", BAD_MM)
        self.card("7_newer2.png", "FAIL", "2 newer: FAIL, PASS")
        wait(lambda: self.browser.find_elements(By.CSS_SELECTOR, "svg.picture"))
        panel = self.one(".typing")
        expect("Foil typed" in panel.text and "PASS" in panel.text, "whose serial is typed is not said: " + panel.text)
        field = self.browser.switch_to.active_element
        expect(field.get_attribute("value") == "SN-471", "typed was SN-471, but there is " + field.get_attribute("value"))
        ActionChains(self.browser).send_keys("2", Keys.ENTER).perform()
        wait(lambda: not self.browser.find_elements(By.CSS_SELECTOR, ".typing"))
        self.card("7_newer2.png", "FAIL")
        expect("newer2" in self.text("h2"), "the newest foil has another's serial: " + self.text("h2"))
        self.go("/history?serial=SN-4712")
        expect("1 foil found" in self.text(), "the serial was not kept: " + self.text())
        # A serial that is given up leaves no trace.
        self.go("/")
        ActionChains(self.browser).send_keys("nobody").perform()
        self.drop("7_newer3.png", GOOD_MM)
        self.card("7_newer3.png", "PASS", "1 newer: PASS")
        self.press(lambda: self.browser.find_elements(By.CSS_SELECTOR, ".typing button[type=reset]"))
        wait(lambda: not self.browser.find_elements(By.CSS_SELECTOR, ".typing"))
        expect(self.browser.switch_to.active_element.get_attribute("value") == "newer3", "the newest serial has no focus")

    def fill(self, name, text):
        field = self.one(f"form[data-foil] input[name={name}]")
        field.clear()
        field.send_keys(text)

    def keep(self):
        self.press(lambda: self.browser.find_elements(By.CSS_SELECTOR, "form[data-foil] button"))

    def two_at_once(self, other):
        """Only changed fields count of an HTML form that was loaded before somebody else's change."""
        self.go("/")
        foil = self.one("h2 a").get_attribute("href").rsplit("/", 1)[1]
        for day in self, other:
            day.go("/" + foil)
        self.fill("operator", "Ada")
        self.fill("by", "Ada")
        self.keep()
        wait(lambda: "Ada" in self.text(".left table"))
        other.fill("die", "D9")
        other.fill("by", "Bea")
        other.keep()
        wait(lambda: "D9" in other.text(".left table"))
        expect(other.one("input[name=operator]").get_attribute("value") == "Ada", "a stale form erased the operator")
        self.fill("die", "D7")
        self.fill("by", "Ada")
        self.keep()
        wait(lambda: "Somebody else has changed the foil" in self.text())
        expect("D9" in self.text("table") and "Bea" in self.text("table"), "who changed what: " + self.text("table"))
        expect(self.one("input[name=die]").get_attribute("value") == "D7", "what was wanted is lost")
        self.keep()
        wait(lambda: "D7" in self.text(".left table"))
        # A serial that another foil has.
        other.go("/" + foil)
        other.fill("serial", "SN-4712")
        other.fill("by", "Bea")
        other.keep()
        wait(lambda: "another foil has the serial number SN-4712" in other.text())
        other.browser.execute_script("window.asked = true")
        other.browser.switch_to.active_element.send_keys(Keys.ENTER)  # a reader's next Enter takes nothing
        wait(lambda: not other.browser.execute_script("return window.asked")
             and "another foil has the serial number SN-4712" in other.text())
        other.go("/" + foil)
        expect("SN-4712" not in other.text("h2, .call"), "the serial was taken")
        # News of one browser are those of the other.
        self.go("/")
        self.fill("serial", "SN-1000")
        other.go("/")
        other.browser.execute_script("window.never_loaded = true")
        self.keep()
        wait(lambda: "SN-1000" in other.text("h2"))
        expect(other.browser.execute_script("return window.never_loaded"), "the other page was loaded, not told")

    def phone(self, other):
        """Nothing is wider than the screen; the verdict is in view, whatever has the focus."""
        other.browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", PHONE)
        self.drop("7_a_file_with_a_rather_long_name_of_one_word_as_scanners_give_them.png", BAD_MM)
        for path in [path for _, path in TABS] + ["/lots?close=1&lot=7", "/foil?id=2"]:
            other.go(path)
            wait(lambda: not other.browser.find_elements(By.CSS_SELECTOR, "html.unconfirmed"))
            if path == "/":
                other.card("as_scanners_give_them", "FAIL")
                wait(lambda: other.browser.find_elements(By.CSS_SELECTOR, "svg.picture"))
            wide, top, bottom = other.browser.execute_script(
                "var c=document.querySelector('.call'),b=c&&c.getBoundingClientRect();"
                "return [document.documentElement.scrollWidth,b?b.top:0,b?b.bottom:0]")
            expect(0 <= top and bottom <= PHONE["height"] / 2, f"{path}: the verdict is at {top} to {bottom} px")
            beyond = other.browser.execute_script(
                "return [].filter.call(document.querySelectorAll('main *'),function(e){"
                "return e.getBoundingClientRect().right>arguments[0]+1&&!e.closest('svg')&&!e.closest('.scroll');})"
                ".map(function(e){return e.outerHTML.slice(0,80);})", PHONE["width"])
            expect(wide <= PHONE["width"] and not beyond, f"{path} is {wide} px wide on a phone: {beyond}")

    def lost(self):
        """A station that is gone: no page keeps a verdict in its colours, and it comes back by itself."""
        self.go("/")
        wait(lambda: not self.is_grey())
        self.browser.execute_script("window.never_loaded = true")
        held = self.text(".call")
        killed = time.time()
        self.station.kill()
        wait(self.is_grey, SILENT_S)
        expect(time.time() - killed <= SILENT_S, f"said after {time.time() - killed:.1f} s")
        words = self.text("#silent")
        expect("No connection" in words and re.search(r"known at 20\d\d-\d\d-\d\d \d\d:\d\d:\d\d", words),
               "the time of what is shown: " + words)
        self.station.start_again()
        wait(lambda: not self.is_grey())
        expect(self.text(".call") == held, "another card after the restart")
        self.drop("7_back.png", GOOD_MM)
        self.card("7_back.png", "PASS")
        expect(self.browser.execute_script("return window.never_loaded"), "the page was loaded, not told")

    def silent(self):
        """Connections that stay open and carry nothing, as through a cable that was pulled; and a page whose
        script never hears of its station."""
        self.go("/")
        wait(lambda: not self.is_grey())
        self.station.process.send_signal(signal.SIGSTOP)
        try:
            stopped = time.time()
            wait(self.is_grey, SILENT_S)
            expect(time.time() - stopped <= SILENT_S, f"said after {time.time() - stopped:.1f} s")
        finally:
            self.station.process.send_signal(signal.SIGCONT)
        wait(lambda: not self.is_grey())
        self.browser.execute_cdp_cmd("Network.enable", {})
        for blocked in "*/alive", "*/script.js":
            self.browser.execute_cdp_cmd("Network.setBlockedURLs", {"urls": [blocked]})
            self.go("/")
            wait(self.is_grey, SILENT_S)
        self.browser.execute_cdp_cmd("Network.setBlockedURLs", {"urls": []})
        # A station that answers but cannot give its page: the verdict is not its newest word any more.
        self.go("/")
        wait(lambda: not self.is_grey())
        self.browser.execute_script(
            "window.whole=window.fetch;window.fetch=function(to,how){"
            "return to===location.href?Promise.reject(new Error('no page')):window.whole(to,how);}")
        self.drop("7_hidden.png", BAD_MM)
        wait(self.is_grey)
        expect("cannot show its newest" in self.text("#silent"), "what is wrong: " + self.text("#silent"))
        self.browser.execute_script("window.fetch=window.whole")
        self.card("7_hidden.png", "FAIL")
        # A page that is told nothing, as one that loads while a result comes, finds out by asking.
        self.browser.execute_cdp_cmd("Network.setBlockedURLs", {"urls": ["*/events"]})
        self.go("/")
        self.drop("7_untold.png", BAD_MM)
        self.card("7_untold.png", "FAIL")
        self.browser.execute_cdp_cmd("Network.setBlockedURLs", {"urls": []})
        # A page that comes back from the browser's memory, while the station is gone.
        self.go("/")
        wait(lambda: not self.is_grey())
        self.go("/history")
        self.station.kill()
        self.browser.back()
        wait(lambda: not self.browser.find_elements(By.CSS_SELECTOR, ".call") or self.is_grey(), SILENT_S)

    def history(self):
        self.follow("History")
        wait(lambda: "foils" in self.text(".note"))
        field = self.browser.switch_to.active_element
        expect(field.get_attribute("name") == "serial", "the search has no focus")
        field.send_keys("4711", Keys.ENTER)
        wait(lambda: "1 foil found" in self.text())
        rows = self.browser.find_elements(By.CSS_SELECTOR, "table.found tbody tr")
        expect(len(rows) == 1 and "SN-4711" in rows[0].text and "PASS" in rows[0].text, "the search found others")
        self.follow("SN-4711")
        self.follow("The whole")
        wait(lambda: "Residual along the foil" in self.text("body"))
        expect("SN-4711" in self.text("body"), "the report is not of SN-4711")
        radius = re.search(r"3\.3[12]\d+", self.text("body"))
        expect(radius, "the report has no radius")

    def trends(self, points):
        self.go("/trends?newest=all")
        figure = wait(lambda: [f for f in self.browser.find_elements(By.CSS_SELECTOR, "figure.zoom") if f.is_displayed()])[0]
        expect((figure.get_attribute("data-from"), figure.get_attribute("data-to")) == ("1", str(points)),
               f"the chart is not of {points} foils: {figure.get_attribute('data-to')}")
        wide = figure.size["width"]
        left, right = (float(figure.get_attribute("data-" + side)) for side in ("left", "right"))

        def at(share):
            return int((left + (right - left) * share - 0.5) * wide)

        # From the middle of the second foil to that of the last but one, through the chart's middle.
        ActionChains(self.browser).move_to_element_with_offset(figure, at(1.5 / points), 0).click_and_hold() \
            .move_by_offset(20, 0).move_to_element_with_offset(figure, at(1 - 1.5 / points), 0).release().perform()
        wait(lambda: "from=2" in self.browser.current_url)
        expect(f"to={points - 1}" in self.browser.current_url, "zoomed to " + self.browser.current_url)
        shown = wait(lambda: [f for f in self.browser.find_elements(By.CSS_SELECTOR, "figure.zoom") if f.is_displayed()])[0]
        expect(shown.get_attribute("data-from") == "2", "the zoomed chart is of others")
        ActionChains(self.browser).send_keys("0").perform()
        wait(lambda: "from=2" not in self.browser.current_url)

    def lots(self, downloads):
        self.follow("Lots")
        expect("No lot is open" not in self.text(), "no lot is open")
        self.follow("Close …")
        expect(self.browser.switch_to.active_element.get_attribute("name") == "by", "who closes has no focus")
        self.press(lambda: self.browser.find_elements(By.CSS_SELECTOR, "input[name=open]"))
        self.one("input[name=by]").send_keys("Ada", Keys.ENTER)
        wait(lambda: "closed" in self.text() and "by Ada" in self.text())
        expect("FAIL" in self.text("ul.cards li"), "a lot with a bad foil did not fail: " + self.text("ul.cards li"))
        self.press(lambda: self.browser.find_elements(By.CSS_SELECTOR, "button[value='results.qif']"))
        path = wait(lambda: [os.path.join(downloads, name) for name in os.listdir(downloads) if name.endswith(".qif")])[0]
        root = xml.etree.ElementTree.parse(path).getroot()
        expect(root.tag.endswith("}QIFDocument"), f"no QIF: {root.tag}")
        expect("SN-4711" in xml.etree.ElementTree.tostring(root, encoding="unicode"), "the QIF lacks the serial")

    def legible(self, paths):
        """Every text has its contrast in light and in dark pages; with letters of double size nothing is cut off."""
        for scheme in ("light", "dark"):
            self.browser.execute_cdp_cmd("Emulation.setEmulatedMedia",
                                         {"features": [{"name": "prefers-color-scheme", "value": scheme}]})
            for path in paths:
                self.go(path)
                wait(lambda: not self.browser.find_elements(By.CSS_SELECTOR, "html.unconfirmed"))
                low = self.browser.execute_script(LOW_CONTRAST, CONTRAST_MIN)
                expect(not low, f"{scheme}, {path}: contrast below {CONTRAST_MIN}: {low}")
        self.browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": []})
        for path in paths:
            self.go(path)
            size = self.browser.execute_script("var s=document.querySelector('main p, main label');"
                                               "return s?parseFloat(getComputedStyle(s).fontSize):0")
            self.browser.execute_script("document.documentElement.style.fontSize='200%'")
            large, wide = self.browser.execute_script(
                "var s=document.querySelector('main p, main label');return [s?parseFloat(getComputedStyle(s).fontSize):0,"
                "document.documentElement.scrollWidth]")
            expect(large > 1.9 * size or not size, f"{path}: letters do not follow the browser's: {size}, {large} px")
            expect(wide <= WIDTH, f"{path} with large letters is {wide} px wide")

    def reachable(self):
        """Tab alone reaches every tab of the page and the form's button, and each shows that it has the focus."""
        self.go("/trends")
        reached = []
        for _ in range(40):
            ActionChains(self.browser).send_keys(Keys.TAB).perform()
            reached.append(self.browser.execute_script(
                "var a=document.activeElement,s=getComputedStyle(a);"
                "return [a.tagName,a.textContent.trim(),s.outlineStyle!=='none'&&parseFloat(s.outlineWidth)>=2]"))
        names = {name for _, name, _ in reached}
        for name in ("Now", "History", "Trends", "Scanner", "Lots", "Orders"):
            expect(name in names, f"Tab does not reach {name}: {names}")
        expect(any(tag == "BUTTON" for tag, _, _ in reached), "Tab does not reach a button")
        expect(all(shown for tag, _, shown in reached if tag in ("A", "BUTTON", "INPUT", "SELECT")), f"a focus does not show: {reached}")

    def quiet(self):
        """Nothing that the page did was refused by the browser."""
        said = [entry["message"] for entry in self.browser.get_log("browser") if entry["level"] == "SEVERE"
                and "favicon" not in entry["message"]]
        expect(not said, f"the browser complains: {said}")


def run_day(program, renderer, work):
    folder, downloads = os.path.join(work, "scans"), os.path.join(work, "downloads")
    os.mkdir(folder)
    os.mkdir(downloads)
    recipe = os.path.join(work, "recipe.json")
    with open(recipe, "w", encoding="utf-8") as file:
        json.dump({"schema": "foilgauge/recipe/1", "station": {"file_name": "{lot}_{serial}", "receive_s": RECEIVE_S},
                   "design": {"schema": "foilgauge/design/1", "bump_count": 2, "tolerances": LIMITS,
                              "calibration": "not needed: the scans are rendered"}}, file)
    with open(os.path.join(work, "errors"), "w", encoding="utf-8") as errors:
        station, browsers = Station(program, folder, recipe, errors), []
        try:
            browsers = [open_browser(downloads), open_browser(downloads)]
            day, other = (Day(browser, station, folder, work, renderer) for browser in browsers)
            other.seed = 1000
            day.cards()
            day.barcode()
            for i in range(5):
                day.drop(f"7_{i}.png", GOOD_MM)
            day.card("7_4.png", "PASS")
            day.history()
            day.trends(8)
            day.lots(downloads)
            day.half_typed()
            day.quiet()  # before answers that are refusals
            day.two_at_once(other)
            day.phone(other)
            day.lost()
            day.silent()
        finally:
            for browser in browsers:
                browser.quit()
            station.end()
    print("browser: cards by themselves, barcode, search, report, zoom, lot, QIF, half-typed serial, two at once, phone, "
          "lost connection")


def run_causes(program, work):
    """A year with a cause: "Why?" is pressed, the cause accepted, the chart read."""
    sys.path.insert(0, os.path.join(ROOT, "tests", "bench"))
    import station_causes
    station_causes.FOILGAUGE = program
    bench, folder = station_causes.Bench(work, 1000), os.path.join(work, "year")
    bench.year(5, {"scanner": {"S2": 0.006}}, keep=folder)
    with open(os.path.join(work, "errors"), "w", encoding="utf-8") as errors:
        station, browser = Station(program, folder, bench.recipe, errors), None
        try:
            browser = open_browser(work)
            day = Day(browser, station, folder, work, program)
            day.go("/trends?newest=all")
            day.press(lambda: [b for b in browser.find_elements(By.CSS_SELECTOR, "button") if b.text == "Why?"])
            wait(lambda: "with scanner" in day.text("ol.found") and "With the causes taken out" in day.text(), 120)
            browser.find_element(By.CSS_SELECTOR, "ol.found input[name=note]").send_keys("glass cleaned")
            browser.find_element(By.CSS_SELECTOR, "ol.found input[name=by]").send_keys("Ada", Keys.ENTER)
            wait(lambda: "accepted by Ada" in day.text("ul.causes") and "glass cleaned" in day.text("ul.causes"))
            day.legible([path for _, path in TABS] + ["/why?q=bump:radius_mm", "/foil?id=2", "/lots?close=1&lot=L01"])
            day.reachable()
            day.go("/trends?newest=all")
            limits = browser.execute_script("return document.querySelector('.wide path.control').getAttribute('d')")
            expect(limits.count("V") > 10, "the limits do not follow the scanner: " + limits[:80])
            day.quiet()
        finally:
            if browser:
                browser.quit()
            station.end()
    print("browser: Why?, a cause accepted, limits about it")


def run_pictures(program, folder, work):
    """The tabs of a station with 300 foils and three that are really scanned, the newest of them bad."""
    filled = os.path.join(work, "scans")
    recipe = os.path.join(ROOT, "samples", "station", "recipe.json")
    fill = os.path.join(ROOT, "tests", "bench", "station_fill.py")
    subprocess.run([sys.executable, fill, filled, "--scans", "300", "--checks", "30"], check=True)
    with open(os.path.join(ROOT, "samples", "render", "gen2_foil.json"), encoding="utf-8") as file:
        spec = json.load(file)
    with open(os.path.join(work, "errors"), "w", encoding="utf-8") as errors:
        station, browser = Station(program, filled, recipe, errors), None
        try:
            browser = open_browser(work)
            day = Day(browser, station, filled, work, program)
            day.go("/")
            for seed, springback in ((1, {"mean": 0.02, "sd": 0.007}), (2, {"mean": 0.02, "sd": 0.007}),
                                     (3, {"mean": 0.04, "sd": 0.02})):
                spec["seed"], spec["foils"][0]["radius_springback"] = seed, springback
                scan = os.path.join(filled, f".L006_A_{300 + seed:06d}.png")
                with open(os.path.join(work, "spec.json"), "w", encoding="utf-8") as file:
                    json.dump(spec, file)
                subprocess.run([program, "render", file.name, "-o", scan], check=True)
                os.rename(scan, scan.replace(".L006", "L006"))
                wait(lambda name=f"{300 + seed:06d}": name in day.text("h2"))
            day.go("/lots?close=1&lot=L006")
            for tick in browser.find_elements(By.CSS_SELECTOR, "input[name=open]"):
                tick.click()
            day.one("input[name=by]").send_keys("Ada", Keys.ENTER)
            wait(lambda: "by Ada" in day.text())
            for name, path in TABS:
                browser.set_window_size(WIDTH, 1000)
                day.go(path)
                height = browser.execute_script("return document.documentElement.scrollHeight")
                browser.set_window_size(WIDTH, min(height, TALLEST.get(name, TALLEST_OTHERS)) + 143)  # what a window has around its page
                browser.save_screenshot(os.path.join(folder, f"station_{name}.png"))
        finally:
            if browser:
                browser.quit()
            station.end()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--renderer", help="the program that draws scans; default PROGRAM")
    parser.add_argument("--pictures", metavar="FOLDER")
    arguments = parser.parse_args()
    if not shutil.which("chromium") or not shutil.which("chromedriver"):
        print("skipped: chromium and chromium-driver are not on this machine")
        sys.exit(77)
    with tempfile.TemporaryDirectory() as work:
        if arguments.pictures:
            run_pictures(arguments.program, arguments.pictures, work)
        else:
            run_day(arguments.program, arguments.renderer or arguments.program, work)
            os.mkdir(os.path.join(work, "causes"))
            run_causes(arguments.program, os.path.join(work, "causes"))


if __name__ == "__main__":
    main()
