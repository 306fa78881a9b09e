#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The page of the loop on scans (--html): it says what the report says, is whole and its own, makes
# names of files harmless, and appears only when it could be written.
. tests/support/loop.sh
skip_when_slow

# render NAME SEED ROTATION DPI EFFECTS
render() { render_foil "$1" "$2" "$3" "$5" "$4"; }

render clean 1 -70 2400 ''
render ripple 2 -60 2400 '{"id":"scan.carriage_ripple","amplitude_um":7,"period_mm":2.7,"phase_deg":30}'
if [ -z "${FOILGAUGE_TEST_BRIEF-}" ]; then
render a 3 -75 2400 '{"id":"scan.scale_y","value":0.001}'
render b 4 15 2400 '{"id":"scan.scale_y","value":0.001}'
render faint 6 -75 4800 '{"id":"scan.scale_y","value":0.00005}'
render other 7 -120 2400 '{"id":"scan.scale_y","value":0.001}'
fi

page() { # page FILE ARGUMENTS...
  local file=$1
  shift
  "$program" loop "$@" --html "$file" >stdout.txt || fail "loop $* --html"
  [ ! -s stdout.txt ] || fail "--html $file writes to standard output"
  python3 - "$file" <<'PYTHON' || fail "$file is not a whole page of its own"
import re, sys
from html.parser import HTMLParser
text = open(sys.argv[1], encoding="utf-8").read()
void = {"meta", "br", "rect", "path", "circle", "image"}
stack, bad, tables = [], [], 0
class Reader(HTMLParser):
    def handle_starttag(self, tag, attributes):
        if tag == "script" or any(k in ("src", "href") or k.startswith("on") for k, v in attributes):
            bad.append("from outside: " + tag)
        if tag not in void: stack.append(tag)
    def handle_endtag(self, tag):
        if tag in void: return
        if not stack or stack.pop() != tag: bad.append(f"</{tag}> at {self.getpos()}")
reader = Reader()
reader.feed(text)
reader.close()
if stack or bad: sys.exit(f"{stack} {bad[:3]}")
if re.search(r"[^a-z](nan|inf)[^a-z]", re.sub(r"<style>.*?</style>", "", text, flags=re.S), re.I):
    sys.exit("a number that is none")
if len(text) > 2_000_000: sys.exit(f"{len(text)} bytes")
PYTHON
}

holds() { # holds FILE WORDS...
  local file=$1 words
  shift
  for words in "$@"; do
    grep -q -F -- "$words" "$file" || fail "$file does not say '$words'"
  done
}

odd="a<b>&\"c'.png"
cp ripple.png "$odd"
page odd.html "$odd"
holds odd.html '>explained<' scan.carriage_ripple 'a&lt;b&gt;&amp;&quot;c&#39;.png' "$(sha256sum <"$odd" | cut -c1-12)"
grep -q -F '<b>&"c' odd.html && fail "a file's name goes into the page as it is"
holds odd.html 'What to do next:' 'foilgauge measure --model scanner.json' 'drawn 500 times as large, in every drawing'
[ "$(grep -c 'of residual, drawn' odd.html)" = 1 ] || fail "the scale of the residuals is said more than once"
page clean.html clean.png
page again.html clean.png
cmp -s clean.html again.html || fail "two runs give two pages"
holds clean.html '>clean<' 'Nothing is claimed' 'As measured' 'Nothing to correct: use the dimensions'
# Needles of noise are no longer than a line is wide: the longest, in units of the drawing.
python3 - <<'PYTHON' || fail "the noise of a clean scan is drawn as if it were something"
import re
page = open("clean.html", encoding="utf-8").read()
needles = re.findall(r'class="(?:out|in)wards" d="([^"]*)"', page)
lengths = [((float(a) - float(c)) ** 2 + (float(b) - float(d)) ** 2) ** 0.5
           for path in needles for a, b, c, d in re.findall(r"M(\S+) (\S+?)L(\S+) ([^M]+)", path)]
raise SystemExit(not lengths or max(lengths) > 10)
PYTHON

grep -q 'After' clean.html && fail "the page of a clean scan has an After"

if [ -z "${FOILGAUGE_TEST_BRIEF-}" ]; then
page pair.html --same-foil a.png b.png
holds pair.html '>explained<' scan.scale_y part.ovality 'of one bump differs between the scans'
[ "$(grep -c 'class="plot vectors"' pair.html)" = 4 ] || fail "a pair is not drawn before and after"
render decay 9 -70 2400 ''
sed -i 's/"radius_mm":\[[^]]*\]/"radius_mm":[3.60,3.50,3.45,3.43,3.42,3.415,3.41,3.41,3.41]/' decay.json
"$renderer" render decay.json -o decay.png || fail "render a decay"
page decay.html decay.png
holds decay.html '>explained<' part.lip_decay 'Over the bumps: a decay from the lip' 'uniform springback'
page aside.html a.png --hold-out other.png
holds aside.html 'only confirms' 'On scans kept aside' 'class="held-out k1"'
page tie.html faint.png -o tie.out
holds tie.html 'tied: not named' 'What the data cannot tell apart' 'an oval foil' '--same-foil' '<th>range</th>'
# An oval foil is among the tied explanations, so that the dimensions stay, and u and ranges hold what each would move.
holds tie.html 'cannot tell apart'
checks - <<'PYTHON' || fail "a tie moves what its explanations do not agree about, or does not say so"
import json
r = json.load(open("tie.out"))
before, after = (r[side]["foils"][0] for side in ("before", "after"))
choice = {c["quantity"]: c for c in after["corrections"]}
assert not any(c["moved"] for c in choice.values()), choice
assert "corrections" not in before
assert after["overall"]["u_radius_mm"] > abs(choice["overall_radius_mm"]["move_mm"])
for was, now in zip(before["bumps"], after["bumps"]):
    assert now["u_radius_mm"] > was["u_radius_mm"]
    assert (now["height_mm"] != was["height_mm"]) == choice["height_mm"]["moved"]
    assert (now["radius_mm"] != was["radius_mm"]) == choice["radius_mm"]["moved"]
    derived = after["overall"]["radius_mm"] - (now["centre_to_centre_mm"] - now["radius_mm"])
    assert abs(now["height_mm"] - derived) < 1e-8
    assert now["radius_range_mm"][0] <= now["radius_mm"] <= now["radius_range_mm"][1]
PYTHON
if command -v script >/dev/null; then
  script -qec "'$program' loop faint.png" tie.txt </dev/null >/dev/null
  holds tie.txt 'tied'
fi
fi

"$program" loop clean.png --html /nowhere/x.html 2>err.txt
[ $? -eq 74 ] || fail "a page that cannot be written is not an error of output"
if [ -e /dev/full ]; then
  "$program" loop clean.png --html /dev/full 2>err.txt
  [ $? -eq 74 ] || fail "a full disk is not an error of output"
  grep -q 'No space left' err.txt || fail "a full disk is not named: $(cat err.txt)"
fi
(
  ulimit -f 40
  trap '' XFSZ
  exec "$program" loop clean.png --html full.html
) 2>err.txt
[ $? -eq 74 ] || fail "a disk that is full half-way is not an error of output"
[ ! -e full.html ] || fail "a page that is not whole has its final name"

exit $failed
