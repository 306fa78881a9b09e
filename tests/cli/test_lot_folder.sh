#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Contents of a lot's folder, and of its scans' folder: records that were changed, names of any bytes.
. tests/support/cli.sh
listened="stdout stderr"

mkdir scans
for i in 1 2 3; do
  printf '{"schema":"foilgauge/render/1","seed":%d,"foils":[{"design":{"bump_count":3},"overall_radius_mm":20.9,
"radius_springback":{"mean":0.05,"sd":0.05},"rotate_deg":-90}],"scanner":{"dpi":1200,"blur_px":1.0,"noise":1}}' "$i" >spec.json
  "$renderer" render spec.json -o "scans/foil$i.png" || fail "render $i"
done
cat >recipe.json <<'R'
{"schema": "foilgauge/recipe/1", "resamples": 500, "design": {"schema": "foilgauge/design/1", "bump_count": 3}}
R
lot() {
  timeout 60 "$program" lot "$@" --name "the lot" --recipe recipe.json
}
expect 0 '3 foils of 3 scans' lot scans -o one

# damage NAME SED: a copy of the lot with its results edited.
damage() {
  rm -rf "$1" merged
  cp -r one "$1"
  sed -i "$2" "$1/results.jsonl"
  cmp -s "one/results.jsonl" "$1/results.jsonl" && fail "$1: nothing was changed"
}

# A digit, a member's name, a number of any size: measured again with a note, and merged by nobody.
for change in '2s/"values": \[-*/&5/' '2s/"values"/"valuez"/' '2s/"number": 2/"number": 100000000/' \
  '2s/"sha256": "./"sha256": "x/' '2s/$/ /' '2s/^.*$/[]/' '2s/"checksum"/"checksun"/'; do
  damage bad "$change"
  expect 65 'results.jsonl: line 2 is damaged.*--resume' "$program" merge bad -o merged
  [ -e merged/lot.json ] && fail "$change: merged"
  expect 0 '3 scans, 1 to measure, 2 kept' lot scans -o bad --resume --dry-run
  expect 0 'line 2: .* measured again' lot scans -o bad --resume
  same one bad
done
damage bad '1s/0/1/'
expect 65 'line 1 is damaged' "$program" merge bad -o merged
expect 0 '3 scans, 0 to measure, 3 kept' lot scans -o bad --resume --dry-run
expect 0 'line 1' lot scans -o bad --resume
same one bad

# A journal of a version without checksums is measured again; somebody's own file stays.
damage bad 's/results\/2/results\/1/; s/, "checksum": "[0-9a-f]*"}/}/'
expect 65 'earlier version' "$program" merge bad -o merged
expect 0 'earlier version.*all scans are measured again' lot scans -o bad --resume
same one bad
# So is one of a build that measured as many values, of which one was another.
rm -rf bad
cp -r one bad
head=$(sed 's/, "checksum".*//; s/"height_mm"/"depth_mm"/; q' one/results.jsonl)
sum=$(printf '%s' "$head" | sha256sum)
{ printf '%s, "checksum": "%s"}\n' "$head" "${sum:0:16}"; tail -n +2 one/results.jsonl; } >bad/results.jsonl
expect 65 'records hold other values' "$program" loop --lot bad
expect 0 'other values.*all scans are measured again' lot scans -o bad --resume
same one bad
mkdir mine
echo 'my own notes' >mine/results.jsonl
expect 65 'another folder' lot scans -o mine --resume
[ "$(cat mine/results.jsonl)" = 'my own notes' ] || fail "a file of the user's was overwritten"

# Names that are not UTF-8: told apart, kept, resumed, merged, readable in every report.
mkdir latin
cp scans/foil1.png latin/$'K\xe4fig.png'
cp scans/foil2.png latin/$'K\xf6fig.png'
cp scans/foil3.png latin/'K\xE4fig.png'
expect 0 '3 foils of 3 scans' lot latin -o names
expect 0 '3 scans, 0 to measure, 3 kept' lot latin -o names --resume --dry-run
expect 0 '3 foils of 3 scans' lot latin -o names --resume
for i in 1 2; do expect 0 '' lot latin -o "names$i" --shard "$i/2"; done
expect 0 '3 foils of 3 scans' "$program" merge names1 names2 -o names3
same names names3
for name in results.jsonl lot.json index.html foils.csv bumps.csv results.dfq results.qif; do
  iconv -f UTF-8 -t UTF-8 "names/$name" >text || fail "$name is not UTF-8"
  grep -qF 'K\\xF6fig.png' text || grep -qF 'K\xF6fig.png' text || fail "$name does not show the name"
done

# A scan that was cut off is measured when it is whole.
mkdir growing
cp scans/foil1.png growing/
head -c 3000 scans/foil2.png >growing/foil2.png
expect 2 'foil2.png' lot growing -o grown
expect 0 '2 scans, 0 to measure, 2 kept' lot growing -o grown --resume --dry-run
cp scans/foil2.png growing/foil2.png
expect 0 '2 scans, 1 to measure, 1 kept' lot growing -o grown --resume --dry-run
expect 0 '2 foils of 2 scans' lot growing -o grown --resume

# Pipes and devices are no scans of a lot: said, and never waited for.
mkdir odd
cp scans/foil1.png odd/
mkfifo odd/fifo.png
ln -s /dev/zero odd/zero.png
ln -s ../scans/foil2.png odd/link.png
expect 2 '2 foils of 4 scans' lot odd -o odd.lot
for name in fifo zero; do
  grep -q "odd/$name.png: is a pipe or a device, not a file" stderr || fail "$name.png: $(cat stderr)"
done
expect 2 '2 kept|2 foils of 4 scans' lot odd -o odd.lot --resume
rm growing/foil2.png
mkfifo growing/foil2.png
expect 2 'foil2.png: is a pipe' lot growing -o grown --resume
expect 65 'is not a scan' timeout 60 "$program" measure /dev/zero
mkfifo pipe
cat scans/foil1.png >pipe &
expect 0 '' timeout 60 "$program" measure pipe -o piped.json
wait

# A scan counts once however its path is spelled; its columns must then agree.
mkdir links
ln -s ../scans/foil1.png links/again.png
expect 0 'there twice and counted once: 5 scans.*scans/foil1.png' \
  lot scans ./scans/foil1.png "$PWD/scans" links --dry-run -o spelled
grep -q '^3 scans, 3 to measure' stdout || fail "spellings: $(cat stdout)"
printf 'scan,die\nscans/foil1.png,A\nscans/../scans/foil1.png,A\n' >same.csv
expect 0 'there twice and counted once: 1 scan;' lot same.csv --dry-run -o spelled
printf 'scan,die\nscans/foil1.png,A\nscans/../scans/foil1.png,B\n' >other.csv
expect 65 'twice, with another die .items 1 and 2' lot other.csv --dry-run -o spelled

# All that can be read is found.
mkdir formats
for ending in png tif TIFF pnm pgm ppm pbm txt jpg; do : >"formats/a.$ending"; done
expect 0 '^8 scans, 8 to measure' lot formats --dry-run -o found
mkdir -p empty formats/y.png
expect 0 'note: passed over: 1 folder with the name of a scan, .* is formats/y.png' lot formats --dry-run -o found
expect 65 'no scan: the folders hold no file .*\.pbm' lot empty --dry-run -o found

# A column that is not there, or too many groups: before anything is measured.
printf 'scan,die\nscans/foil1.png,A\nscans/foil2.png,B\n' >lot.csv
expect 65 "no column 'diee'; it has: scan, die" lot lot.csv --group diee -o early
[ -e early ] && fail "a wrong column made a folder"
sed 's/"resamples"/"pad_column": "pads", "resamples"/' recipe.json >pads.json
expect 65 "pad_column: .* no column 'pads'" timeout 60 "$program" lot lot.csv --recipe pads.json -o early
{
  echo scan,die
  for i in $(seq 13); do echo "$i.png,$i"; done
} >many.csv
expect 65 'more than 12 groups' lot many.csv --group die -o early
expect 0 '2 foils of 2 scans' lot lot.csv --group die -o early

# Operator, date and origin: quality systems get them; words that are no date are reported.
printf 'scan,die,coil,operator,date\nscans/foil1.png,A,C7,"Kim ""K"" <b>",2026-02-03 14:05\nscans/foil2.png,B,,,2026-02-04\n' >traced.csv
expect 0 '' lot traced.csv -o deep/er/traced
grep -q 'no date' stderr && fail "dates are called none"
for line in 'K0004/1 03.02.2026/14:05:00' 'K0006/1 C7' 'K0009/1 die A, operator Kim "K" <b>, scan foil1.png' 'K0004/1 04.02.2026/00:00:00' 'K0009/1 die B'; do
  grep -qF "$line" deep/er/traced/results.dfq || fail "results.dfq has no $line"
done
# K0004 is local time: of UTC (Z) that of the machine's zone, over midnight and in summer; other times stand as they are.
printf 'scan,date\nscans/foil1.png,2026-02-03T23:30:15Z\nscans/foil2.png,2026-07-04T08:00:59Z\n' >zoned.csv
TZ=Europe/Berlin expect 0 '' lot zoned.csv -o zoned
for line in 'K0004/1 04.02.2026/00:30:15' 'K0004/1 04.07.2026/10:00:59'; do
  grep -qF "$line" zoned/results.dfq || fail "results.dfq has no $line: $(grep K0004/1 zoned/results.dfq)"
done
# QIF keeps the Z, and the seconds; a date without a zone gets none.
for start in 2026-02-03T23:30:15Z 2026-07-04T08:00:59Z; do
  grep -qF "<InspectionStart>$start<" zoned/results.qif || fail "results.qif has no $start"
done
# Without a column the day of the scan's file counts, as the clock on the wall shows it.
printf 'scan\nlate.png\n' >no_column.csv
cp scans/foil1.png late.png
touch -d 2026-02-03T23:30:00Z late.png
TZ=Europe/Berlin expect 0 '' lot no_column.csv -o no_column
grep -qF 'K0004/1 04.02.2026/00:00:00' no_column/results.dfq || fail "the day of a file is not local"
grep -qF '<InspectionStart>2026-02-04T00:00:00<' no_column/results.qif || fail "results.qif: the day of a file is not local"
TZ=Europe/Berlin expect 0 '' lot traced.csv -o traced_berlin
grep -qF 'K0004/1 03.02.2026/14:05:00' traced_berlin/results.dfq || fail "a time without a zone was moved"
for part in '<InspectionStart>2026-02-03T14:05:00</InspectionStart>' '<InspectionStart>2026-02-04T00:00:00<' \
  '<Attributes n="7"><AttributeStr name="die" value="A"/>' 'name="operator" value="Kim &quot;K&quot; &lt;b&gt;"/>' \
  '<Attributes n="5"><AttributeStr name="die" value="B"/>' '<AttributeStr name="scan" value="scans/foil2.png"/>'; do
  grep -qF "$part" deep/er/traced/results.qif || fail "results.qif has no $part"
done
if command -v xmllint >/dev/null; then
  xmllint --noout --schema "$root/tests/support/qif3_results.xsd" deep/er/traced/results.qif 2>xmllint.log ||
    fail "results.qif: $(head -n 3 xmllint.log)"
fi

# A bearing that the manifest names is a product: itself, judged, and its foils in order of the pads; others are alone.
printf 'scan,foil,bearing,pad,die\nscans/foil1.png,f1,B<7>,2,A\nscans/foil2.png,f2,B<7>,1,B\nscans/foil3.png,f3,,,A\n' >built.csv
sed 's/"resamples"/"pads": 2, "bumps_per_pad": 3, "resamples"/; s/"bump_count": 3/&, "calibration": "not needed: rendered", "tolerances": {"circularity_mm": {"max": 0.5}}/' recipe.json >built.json
expect 0 '1 bearing' timeout 60 "$program" lot built.csv --recipe built.json -o built
if command -v xmllint >/dev/null; then
  xmllint --noout --schema "$root/tests/support/qif3_results.xsd" built/results.qif 2>xmllint.log ||
    fail "results.qif of bearings: $(head -n 3 xmllint.log)"
fi
checks - built <<'P' || fail "bearings for quality systems"
import hashlib, json, re, sys
import xml.etree.ElementTree as tree
folder, q = sys.argv[1], "{http://qifstandards.org/xsd/qif3}"
root = tree.parse(f"{folder}/results.qif").getroot()
for element in root.iter():
    assert element.get("n") in (None, str(len(element))), element.tag
assert max(int(e.get("id")) for e in root.iter() if e.get("id")) <= int(root.get("idMax"))
sets = [[c.findtext(q + "SerialNumber") for c in s] for s in root.iter(q + "ActualComponentSet")]
assert sets == [["B<7>", "f2", "f1"], ["f3"]], sets
foil = {a.get("name"): a.get("value") for a in next(root.iter(q + "ActualComponentSet"))[1].iter(q + "AttributeStr")}
with open("scans/foil2.png", "rb") as file:
    assert foil == {"foil": "f2", "bearing": "B<7>", "pad": "1", "die": "B", "scan": "scans/foil2.png",
                    "scan_sha256": hashlib.sha256(file.read()).hexdigest(),
                    "traceability": "none; no calibration is needed: rendered"}, foil
names = {i.get("id"): i.findtext(q + "Name") for i in root.iter(q + "CharacteristicItems") for i in i}
of = {c.get("id"): c.findtext(q + "SerialNumber") for c in root.iter(q + "ActualComponent")}
got = {}
for results in root.iter(q + "MeasurementResults"):
    part = of[results.find(q + "ActualComponentIds")[0].text]
    for one in results.iter(q + "CharacteristicMeasurements"):
        for value in one:
            got[part, names[value.findtext(q + "CharacteristicItemId")]] = (
                float(value.findtext(q + "Value")), value.findtext(f"{q}Status/{q}CharacteristicStatusEnum"))
bearing = json.load(open(f"{folder}/lot.json"))["bearings"][0]
name = "bearing: peak to valley about the circle through the crowns"
assert got["B<7>", name] == (bearing["circularity_mm"], "PASS"), got["B<7>", name]
assert {n.startswith("bearing: ") for p, n in got if p == "B<7>"} == {True}
assert {n.startswith("bearing: ") for p, n in got if p != "B<7>"} == {False}
lines = open(f"{folder}/results.dfq", newline="").read().split("\r\n")
number = next(re.match(r"K2002/(\d+)", l)[1] for l in lines if l.endswith(name))
assert [l for l in lines if l.startswith(f"K0014/{number} ")] == [f"K0014/{number} B<7>"]
assert f"K0009/{number} pad 1 f2, pad 2 f1" in lines
assert abs(float(next(l for l in lines if l.startswith(f"K0001/{number} ")).split()[1]) - bearing["circularity_mm"]) < 1e-12
assert [l.split(" ", 1)[1] for l in lines if l.startswith("K0014/1 ")] == ["f1", "f2", "f3"]
P
sed 's/2026-02-04/yesterday/' traced.csv >undated.csv
expect 0 "note: the manifest's column date: 1 cell without a date, the first is 'yesterday'" lot undated.csv -o undated
[ "$(value undated/lot.json 'r["date"]["from"], r["date"]["cells_not_dates"]')" = "('scans', 1)" ] || fail "the date"
valid lot.schema.json undated/lot.json
touch file
expect 74 'file/a: the folder cannot be made|file: the folder cannot be made' lot traced.csv -o file/a

exit $failed
