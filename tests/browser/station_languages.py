#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The station's tabs in a real browser, in every language, light and dark, wide and on a phone: no page mixes languages, no
word is cut off or broken, nothing is wider than the screen, and axe-core finds no violation; Trends keeps favourites and searches
quantities; a new verdict is told to screen readers.

    tests/browser/station_languages.py PROGRAM [--pictures FOLDER]

axe-core is the npm package of that name: fetched by `npm pack`, or the file that FOILGAUGE_AXE names; where there is neither, that
part is skipped. Otherwise needs what station_browser.py needs."""

import argparse
import glob
import os
import re
import shutil
import subprocess
import sys
import tarfile
import tempfile

import station_browser
from station_browser import By, Day, Keys, Station, expect, open_browser, wait

LANGUAGES = ("en", "de")
WIDTHS = (1280, 390)
PATHS = ("/", "/history", "/trends?newest=all", "/trends?by=lots", "/scanner", "/lots", "/lots?close=1&lot=L001", "/orders",
         "/orders?unknown=9", "/foil?id=2", "/why?q=bump:radius_mm", "/outbox", "/nothing")
# Words that no German text has, and none of English.
FOREIGN = {"de": r"\b(the|of|is|are|and|with|which|foils?|without|not|found|open)\b",
           "en": r"\b(der|die Folie|das|und|nicht|ohne|Folien|gemessen|ist)\b"}
# Words that are broken in their middle, texts that are clipped or lie beyond the page; [] where all is well. Tables that
# scroll are wider than a phone by design.
CUT_OFF = """
var wide = arguments[0], bad = [], range = document.createRange(), node, word;
function note(element, why) { bad.push(why + ': ' + element.outerHTML.slice(0, 110)); }
if (document.documentElement.scrollWidth > wide) bad.push('the page is ' + document.documentElement.scrollWidth + ' px wide');
document.querySelectorAll('body *').forEach(function (element) {
  var style = getComputedStyle(element), box = element.getBoundingClientRect(), drawing = element.ownerSVGElement;
  var own = [].some.call(element.childNodes, function (child) { return child.nodeType === 3 && child.data.trim(); });
  if (!box.width || style.visibility === 'hidden' || element.id === 'heard' || element.classList.contains('unseen')) return;
  if (!own && element.tagName !== 'SELECT') return;
  if (element.tagName !== 'OPTION' && /hidden|clip/.test(style.overflowX) && element.scrollWidth > element.clientWidth + 1) note(element, 'clipped');
  if (element.closest('.scroll') || element.tagName === 'title') return;
  if (!drawing && (box.right > wide + 1 || box.left < -1)) note(element, 'beyond the page');
  if (drawing && (box.right > drawing.getBoundingClientRect().right + 1)) note(element, 'beyond its drawing');
});
var walk = document.createTreeWalker(document.querySelector('main') || document.body, NodeFilter.SHOW_TEXT);
while ((node = walk.nextNode())) {
  var at = node.parentElement, words = /[A-Za-z\\u00c0-\\u017f]{2,}/g;
  if (!at.getBoundingClientRect().width || at.closest('svg, [translate=no], .scroll, option')) continue;
  while ((word = words.exec(node.data))) {
    var tops = {};
    range.setStart(node, word.index);
    range.setEnd(node, word.index + word[0].length);
    [].forEach.call(range.getClientRects(), function (box) { if (box.width > 0) tops[Math.round(box.top)] = 1; });
    if (Object.keys(tops).length > 1) note(at, word[0] + ' is broken');
  }
}
return bad;
"""
AXE = """
var done = arguments[0];
axe.run(document, {resultTypes: ['violations']}).then(function (found) {
  done(found.violations.map(function (one) { return one.id + ' (' + one.impact + '): ' + one.nodes[0].html.slice(0, 200); }));
});
"""
# Texts of the page but those that people gave.
TEXTS = """
var copy = document.body.cloneNode(true);
copy.querySelectorAll('[translate=no], script, style').forEach(function (element) { element.remove(); });
var texts = [copy.textContent];
copy.querySelectorAll('[title], [placeholder], [aria-label], [label]').forEach(function (element) {
  ['title', 'placeholder', 'aria-label', 'label'].forEach(function (name) { if (element.getAttribute(name)) texts.push(element.getAttribute(name)); });
});
return texts.join('\\n');
"""


def find_axe(work):
    """The text of axe-core, or None where the npm registry is not reached."""
    path = os.environ.get("FOILGAUGE_AXE")
    if not path and shutil.which("npm"):
        try:
            subprocess.run(["npm", "pack", "axe-core@4"], cwd=work, check=True, capture_output=True, timeout=60)
        except (subprocess.SubprocessError, OSError):
            return None
        with tarfile.open(glob.glob(os.path.join(work, "axe-core-*.tgz"))[0]) as package:
            return package.extractfile("package/axe.min.js").read().decode()
    if not path:
        return None
    with open(path, encoding="utf-8") as file:
        return file.read()


def show_as(browser, language, scheme, width):
    browser.execute_cdp_cmd("Network.enable", {})
    browser.execute_cdp_cmd("Network.setExtraHTTPHeaders", {"headers": {"Accept-Language": language}})
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [{"name": "prefers-color-scheme", "value": scheme}]})
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                            {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": width < 600})


def visit(day, path):
    day.go(path)
    if path != "/nothing":
        wait(lambda: not day.browser.find_elements(By.CSS_SELECTOR, "html.unconfirmed"))


def check_page(day, path, language, width, axe):
    where = f"{language}, {width} px, {path}"
    expect(day.browser.execute_script("return document.documentElement.lang") == language, where + ": another language")
    texts = day.browser.execute_script(TEXTS)
    foreign = re.search(FOREIGN[language], texts)
    expect(not foreign, f"{where}: {foreign and texts[max(0, foreign.start() - 60):foreign.end() + 60]!r}")
    cut = day.browser.execute_script(CUT_OFF, width)
    expect(not cut, f"{where}: {cut}")
    if axe:
        day.browser.execute_script(axe)
        found = day.browser.execute_async_script(AXE)
        expect(not found, f"{where}: axe: {found}")


def every_page(day, axe, pictures):
    for language in LANGUAGES:
        for scheme in ("light", "dark"):
            for width in WIDTHS:
                show_as(day.browser, language, scheme, width)
                for path in PATHS:
                    visit(day, path)
                    check_page(day, path, language, width, axe)
                    if pictures:
                        name = re.sub(r"\W+", "_", path.strip("/")) or "now"
                        day.browser.save_screenshot(os.path.join(pictures, f"{name}_{language}_{scheme}_{width}.png"))
    show_as(day.browser, "en", "light", WIDTHS[0])


def favourites(day):
    """A star keeps a quantity at the top of the list, in this browser; a search leaves what has its words."""
    visit(day, "/trends?q=foil:overall.radius_mm")
    first = "return document.querySelector('select[name=q] optgroup:first-child').textContent"
    expect(day.browser.execute_script(first) == "", "a favourite before there is one")
    day.one("[data-star]").click()
    visit(day, "/trends?q=bump:radius_mm")
    expect("overall radius" in day.browser.execute_script(first), "the favourite does not stand first")
    expect(day.one("[data-star]").get_attribute("aria-pressed") == "false", "another quantity has the star")
    day.one("[data-search]").send_keys("strip thick")
    shown = day.browser.execute_script("return [].filter.call(document.querySelectorAll('select[name=q] option'),"
                                       "function(o){return !o.hidden;}).map(function(o){return o.textContent;})")
    expect(shown and all("strip thick" in one for one in shown), f"found by a search: {shown}")
    day.one("[data-search]").send_keys(Keys.ENTER)
    wait(lambda: "q=foil%3Athickness_mm" in day.browser.current_url)
    visit(day, "/trends?q=foil:overall.radius_mm")
    day.one("[data-star]").click()
    expect(day.browser.execute_script(first) == "", "a favourite that was given up stays")
    expect(re.search(r"\d\d:\d\d:\d\d [+-]\d\d:\d\d", day.text()), "times without their zone")


def spoken(day, filled):
    """The line that lives as long as the page says the new verdict, in the page's language."""
    show_as(day.browser, "de", "light", WIDTHS[0])
    visit(day, "/")
    with open(os.path.join(filled, "notes.txt"), "w", encoding="utf-8") as file:
        file.write("no scan\n")
    said = wait(lambda: "KEIN SCAN" in (day.browser.execute_script("return document.getElementById('heard').textContent") or "")
                and day.browser.execute_script("return document.getElementById('heard').textContent"))
    expect("notes.txt" in said and "entfernen" in said, "what a screen reader hears: " + said)
    expect(day.one("#heard").get_attribute("role") == "status", "no live region")
    os.remove(os.path.join(filled, "notes.txt"))
    show_as(day.browser, "en", "light", WIDTHS[0])


def run(program, work, pictures):
    filled = os.path.join(work, "scans")
    recipe = os.path.join(station_browser.ROOT, "samples", "station", "recipe.json")
    fill = os.path.join(station_browser.ROOT, "tests", "bench", "station_fill.py")
    subprocess.run([sys.executable, fill, filled, "--scans", "200", "--checks", "12"], check=True)
    axe = find_axe(work)
    with open(os.path.join(work, "errors"), "w", encoding="utf-8") as errors:
        station, browser = Station(program, filled, recipe, errors), None
        try:
            browser = open_browser(work)
            day = Day(browser, station, filled, work, program)
            every_page(day, axe, pictures)
            favourites(day)
            spoken(day, filled)
            said = [entry["message"] for entry in browser.get_log("browser") if entry["level"] == "SEVERE"
                    and "/nothing" not in entry["message"]]
            expect(not said, f"the browser complains: {said}")
        finally:
            if browser:
                browser.quit()
            station.end()
    print(f"browser: {len(PATHS)} pages in {', '.join(LANGUAGES)}, light and dark, {WIDTHS} px; axe-core: "
          f"{'no violation' if axe else 'skipped: the npm registry is not reached'}; favourites; spoken verdicts")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--pictures", metavar="FOLDER")
    arguments = parser.parse_args()
    if not shutil.which("chromium") or not shutil.which("chromedriver"):
        print("skipped: chromium and chromium-driver are not on this machine")
        sys.exit(77)
    with tempfile.TemporaryDirectory() as work:
        run(arguments.program, work, arguments.pictures)


if __name__ == "__main__":
    main()
