#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Names and texts from files: none makes a terminal, a spreadsheet or a page do anything.
. "$(dirname "$0")/../support/loop.sh"
mkdir scans
cat >spec.json <<'SPEC'
{"schema": "foilgauge/render/1", "seed": 3, "foils": [{}], "scanner": {"dpi": 1200}}
SPEC
"$renderer" render spec.json -o plain.png || fail "render"
red=$'\e[31m\x9b2J\x07red\xc2\x9b5m\x7f\r.png'
cp plain.png "scans/$red"
(cat plain.png && echo 2) >scans/=cmd.png # another scan
echo no scan >"$red.txt.png"

# tame FILE WHAT: no control character but newline and tab, nor C1 in UTF-8, nor a stray byte of it.
tame() {
  python3 - "$1" <<'PY' || fail "$2: $(head -c 400 "$1" | cat -v)"
import re, sys
raw = open(sys.argv[1], "rb").read().replace(b"\r\n", b"\n")  # a terminal's newline
text = raw.decode("utf-8")
sys.exit(bool(re.search("[\x00-\x08\x0b-\x1f\x7f-\x9f]", text)))
PY
}

# terminal FILE COMMAND...: what the command writes to a terminal.
terminal() {
  local file=$1
  shift
  python3 - "$file" "$@" <<'PY'
import os, pty, sys
with open(sys.argv[1], "wb") as log:
    def read(fd):
        data = os.read(fd, 65536)
        log.write(data)
        return b"."
    sys.stdout.flush()
    keep = os.dup(1)
    os.dup2(os.open("/dev/null", os.O_WRONLY), 1)
    pty.spawn(sys.argv[2:], read, lambda fd: b"")
    os.dup2(keep, 1)
PY
}

# Messages, wherever they go.
for command in measure loop 'loop --table' doe design render merge 'lot -o out'; do
  for name in "$red.lost" "$red.txt.png"; do
    # shellcheck disable=SC2086
    "$program" $command "$name" >said.out 2>said </dev/null
    [ -s said ] || fail "$command of what cannot be read: no words"
    tame said "$command of what cannot be read"
  done
  # shellcheck disable=SC2086
  "$program" $command "--$red" >said.out 2>said </dev/null
  tame said "$command with an option of that name"
done
grep -q 'x1B\[31m' said || fail "a control character is not shown: $(cat -v said)"
"$program" measure "scans/$red" lost.png -o m.json --csv m.csv --html m.html 2>said
tame said "measure"
python3 -c 'import json; json.load(open("m.json"))' || fail "measure: no JSON"
tame m.html "measure --html"

# Tables on a terminal.
mkdir runs
printf 'T,y\n1,2\n2,3\n3,5\n4,4.5\n5,7\n6,7.1\n' >"runs/$red.csv"
terminal shown "$program" measure "scans/$red"
grep -q x1B shown || fail "measure on a terminal does not name the scan: $(head -c 300 shown | cat -v)"
tame shown "measure on a terminal"
terminal shown "$program" loop "scans/$red"
tame shown "loop on a terminal"
terminal shown "$program" loop --table "runs/$red.csv" --response y --model '1 + T'
tame shown "loop --table on a terminal"
terminal shown "$program" doe "runs/$red.csv" --response y --model T
tame shown "doe on a terminal"
terminal shown "$program" measure "scans/$red" -o -
tame shown "JSON on a terminal"

# CSV: a text that a spreadsheet would take for a formula is marked; numbers stay numbers.
(cat plain.png && echo 3) >scans/plain.png
for more in 4 5; do # a group is of two foils, and foils differ
  sed 's/"seed": [0-9]*/"seed": '$more'/' spec.json >more.json
  "$renderer" render more.json -o scans/more$more.png || fail "render $more"
done
printf 'scan,die,=head,coil\nplain.png,=1+1,@x,-2.5\n=cmd.png,+a,"-b,c",+3\nmore4.png,=1+1,@x,-2.5\nmore5.png,+a,"-b,c",+3\n' >scans/list.csv
"$program" lot scans/list.csv -o lot --group die 2>said || fail "lot: $(cat said)"
head -1 lot/foils.csv | grep -q "^scan,die,'=head,coil," || fail "foils.csv: $(head -1 lot/foils.csv | cut -c1-80)"
for file in foils.csv bumps.csv manifest.csv; do
  grep -q "plain.png,'=1+1,'@x,-2.5" lot/$file || fail "$file: $(sed -n 2p lot/$file | cut -c1-80)"
  grep -q "cmd.png,'+a,\"'-b,c\",+3" lot/$file || fail "$file: $(sed -n 3p lot/$file | cut -c1-80)"
done
[ "$(value lot/lot.json 'sorted((c["a"], c["b"]) for c in r["comparisons"])[0]')" = "('=1+1', '+a')" ] ||
  fail "the groups are called otherwise: $(value lot/lot.json 'r["comparisons"]' | head -c 200)"
cp -r lot before
"$program" lot lot/manifest.csv -o lot --resume --group die 2>said || fail "lot --resume: $(cat said)"
diff -r lot before >said || fail "a lot resumed by its own manifest is another: $(head -3 said)"
(cd scans && "$program" measure =cmd.png --csv - >../m.csv) || fail "measure --csv"
sed -n 2p m.csv | grep -q "^'=cmd.png,1,1," || fail "measure --csv: $(sed -n 2p m.csv | cut -c1-80)"
"$program" doe plan --factor T=1:2 --column '=x,1' -o plan.csv 2>/dev/null || fail "doe plan"
head -1 plan.csv | grep -q ",\"'=x,1\"$" || fail "doe plan: $(head -1 plan.csv)"

# Pages: a policy that lets nothing in and nothing out, and nothing that it would stop.
"$program" loop plain.png --html l.html -o l.json || fail "loop"
"$program" loop --table "runs/$red.csv" --response y --model '1 + T' --html t.html || fail "loop --table"
"$program" doe "runs/$red.csv" --response y --model T --html d.html -o d.json || fail "doe"
"$program" lot --index i.html lot || fail "lot --index"
for page in m.html l.html t.html d.html i.html lot/index.html; do
  grep -q "^<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; " $page ||
    fail "$page has no content security policy"
  grep -qiE '<script|<link|<iframe|<object|javascript:|url\(|@import| on[a-z]+=' $page &&
    fail "$page holds what its policy forbids"
  grep -oE '(src|href)="[^"]*"' $page | grep -vE 'href="(data:image/png;base64,|#|lot/index.html|[a-zA-Z0-9_%./-]*(#part[0-9]+)?")' &&
    fail "$page refers to something outside"
done
exit $failed
