#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A lot's pages of single scans: names, links, which are drawn, and that none is out of date.
. tests/support/cli.sh
listened="stdout stderr"

mkdir -p a b
render() {
  printf '{"schema":"foilgauge/render/1","seed":%d,"foils":[{"design":{"bump_count":3},"overall_radius_mm":20.9,
"radius_springback":{"mean":%s,"sd":0.01},"rotate_deg":-90}],"scanner":{"dpi":1200,"blur_px":1.0,"noise":1}}' "$1" "$2" >spec.json
  "$renderer" render spec.json -o "$3" || fail "render $3"
}
hostile=$'b/<a href=x>..\n;"\' ä.png'
render 1 0.05 a/foil.png
render 2 0.15 b/foil.png
render 3 0.05 "$hostile"
cat >recipe.json <<'R'
{"schema": "foilgauge/recipe/1", "resamples": 500, "design": {"schema": "foilgauge/design/1", "bump_count": 3,
 "calibration": "not needed: the scan is rendered", "tolerances": {"radius_error_pct": {"max": 10}}}}
R
lot() {
  timeout 60 "$program" lot --name "the lot" --recipe recipe.json "$@"
}

# links LOT: every link of its page into `pages` leads to a file and a section; prints how many files they are of.
links() {
  checks - "$1" <<'P' || fail "$1: links"
import os, re, sys
lot = sys.argv[1]
page = open(f"{lot}/index.html", encoding="utf-8").read()
found = set(re.findall(r'href="(pages/[^"#]*)#(part[0-9]+)"', page))
for name, part in found:
    text = open(f"{lot}/{name}", encoding="utf-8").read()
    assert f'id="{part}"' in text and 'href="../index.html"' in text and "<image " in text, name
    assert re.fullmatch(r"pages/[A-Za-z0-9_.-]+-[0-9a-f]{16}\.html", name) and not name.startswith("pages/."), name
names = {name for name, _ in found}
assert names == {"pages/" + name for name in os.listdir(f"{lot}/pages")}, names
print(len(names))
P
}

# Two scans of one name, and one whose name would like to be more: a page each, which the tables and charts link to.
expect 1 '3 foils of 3 scans' lot a b -o one
[ "$(links one)" = 3 ] || fail "not three pages"
[ "$(grep -c '<td class="words path"><b><a href="pages/' one/index.html)" = 3 ] || fail "the worst three have no links"
[ "$(grep -c '^<tr><td class="words path"><span id="foil-[0-9]*"><a href="pages/' one/index.html)" = 3 ] || fail "the list has no links"
[ "$(cut -d, -f3 one/foils.csv | grep -c '^pages/foil-')" = 2 ] || fail "foils.csv names no pages"
grep -l 'verdict fail' one/pages/*.html >failing
[ "$(wc -l <failing)" = 1 ] || fail "the pages' verdicts"

# Pages only of foils that do not pass; no pages; and missing pages are drawn later, with the record as it was.
expect 1 '' lot a b -o bad --pages bad
[ "$(links bad)" = 1 ] || fail "--pages bad"
expect 1 '' lot a b -o none --pages none
[ -e none/pages ] && fail "--pages none"
grep -q 'href="pages/' none/index.html && fail "links to pages that are not there"
grep -q 'href="#foil-2"' none/index.html || fail "no links to the list"
expect 0 '3 scans, 0 to measure, 3 kept, 3 of them for their pages' lot a b -o none --resume --dry-run
expect 1 '' lot a b -o none --resume
same one none
expect 0 '3 kept$' lot a b -o none --resume --pages none --dry-run

# Other tolerances are another page; the record stands, and the old page goes. Files that are no pages stay.
echo mine >none/pages/notes.html
sed 's/10}/40}/' recipe.json >wide.json
expect 0 '' timeout 60 "$program" lot --name "the lot" --recipe wide.json a b -o none --resume --jobs 1
rm none/pages/notes.html || fail "a file that is no page was removed"
[ "$(links none)" = 3 ] || fail "old pages beside new ones"
grep -ql 'verdict fail' none/pages/*.html && fail "a page with the tolerances of before"
cmp -s <(tail -n +2 one/results.jsonl) <(tail -n +2 none/results.jsonl) || fail "records were measured again"

# A scan that is gone keeps its page; without the page it has none, and no link.
mv a/foil.png kept.png
printf 'scan\na/foil.png\nb/foil.png\n' >list.csv
cp -r one gone
expect 1 '' lot a/foil.png b -o gone --resume
[ "$(links gone)" = 3 ] || fail "the page of a scan that is gone"
rm gone/pages/foil-*.html
expect 1 '' lot a/foil.png b -o gone --resume
[ "$(links gone)" = 2 ] || fail "a page of no scan"
mv kept.png a/foil.png

# Shards: their pages are the lot's, and the same. A page that cannot be written ends the run.
lot a b -o 1 --shard 1/2 2>/dev/null
lot a b -o 2 --shard 2/2 2>/dev/null
expect 1 '' "$program" merge 1 2 -o merged
same one merged
mkdir full
echo >full/pages
expect 74 'full/pages: the folder cannot be made' lot a b -o full
expect 64 "'some' is none of all, bad, none" lot a b -o no --pages some

# Several foils on one scan: a link to each one's section.
cat >bed.json <<'S'
{"schema": "foilgauge/render/1", "seed": 4, "width_px": 3200, "height_px": 1700, "scanner": {"dpi": 1200}, "foils": [
 {"design": {"bump_count": 3}, "rotate_deg": -90, "centre_mm": [17, 30]},
 {"design": {"bump_count": 3}, "rotate_deg": -90, "centre_mm": [48, 30]}]}
S
"$renderer" render bed.json -o bed.png || fail "render bed"
"$program" lot --name "the lot" --recipe recipe.json bed.png -o bed 2>/dev/null
[ "$(links bed)" = 1 ] || fail "two foils of a scan"
grep -q 'pages/bed-[0-9a-f]*.html#part2' bed/index.html || fail "no link to the second foil"
exit $failed
