#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The manual: a page for every command, every option in it, no warning of the formatter; its
# examples run; the shell's completion; help wherever it is asked for.
set -u
fg=$(realpath "$1")
build=$(dirname "$fg")
man=$build/man
failed=0
work=$(mktemp -d)
trap '[ "$BASHPID" != $$ ] || rm -rf "$work"' EXIT

say() {
  echo "FAILED: $1"
  failed=1
}

commands=$("$fg" help | sed -n 's/^  \([a-z]*\) .*/\1/p')
[ "$(echo "$commands" | wc -l)" -ge 9 ] || say "the commands are not listed: $commands"

# Pages: plain text of roff is enough, a formatter may be missing.
plain() {
  sed -e 's/\\f[BIR]//g' -e 's/\\-/-/g' -e 's/\\(aq/'"'"'/g' "$1"
}

for command in $commands; do
  page=$man/foilgauge-$command.1
  [ -s "$page" ] || { say "no page for $command"; continue; }
  "$fg" help "$command" >"$work/help" || say "help $command"
  grep -q '^Usage: foilgauge '"$command" "$work/help" || say "help $command has no usage"
  plain "$page" >"$work/page"
  # Options begin lines; in running text they may be of other commands.
  options=$(grep -oE '^ {2,6}(-[a-z], +)?--[a-z-]+' "$work/help" | grep -oE -- '--[a-z-]+' | sort -u)
  [ -n "$options" ] || say "no option of $command is found"
  for option in $options; do
    grep -qE "^(-[a-z], )?$option(=|\$)" "$work/page" || say "$option is not in the page of $command"
  done
  grep -q '^.SH EXIT STATUS' "$work/page" || say "$command: no exit status"
  grep -q '^.SH EXAMPLES' "$work/page" || say "$command: no example"
  grep -q '^64$' "$work/page" || say "$command: no exit code 64"
  # argp moves an option where the words before it end at the margin, and words to the left below a name that is too long.
  grep -nE '^ +$|^ {30,}--|^ {6}--[^ ]{27,}$' "$work/help" >"$work/moved" && say "help $command: $(cat "$work/moved")"
  grep -q '@[a-z_]*@' "$work/page" "$work/help" && say "$command: something was not put in"
  "$fg" help | grep -qF "$(sed -n "/^foilgauge-$command - /s///p" "$work/page")" ||
    say "$command: the page says something else than help"
done

# Members of a written recipe are in its page; samples hold nothing else.
plain "$man/foilgauge-recipe.5" >"$work/page"
"$fg" lot --print-recipe | cat - samples/station/recipe.json | grep -oE '"[a-z_]+":' | tr -d '":' |
  sort -u >"$work/keys"
plain "$man/foilgauge-design.5" >>"$work/page"
while read -r key; do
  grep -qE "^\\\\?f?B?(assembly\.|film\.|station\.(check\.)?)?$key\$" "$work/page" ||
    say "the recipe's member $key is in no page"
done <"$work/keys"
# Objects in objects: what the reader says that there is, is in the page.
for object in '{"?": 1}' '{"scale": {"?": 1}}' \
  '{"scale": {"u_rel": 1}, "temperature": {"?": 1}, "expansion": {}}' \
  '{"scale": {"u_rel": 1e-4}, "temperature": {"value_C": 20, "u_K": 1}, "expansion": {"?": 1}}'; do
  echo '{"schema": "foilgauge/design/1", "calibration": '"$object}" >"$work/wrong.json"
  names=$("$fg" design "$work/wrong.json" 2>&1 | sed -n 's/.*there are //p' | tr -d ,)
  [ -n "$names" ] || say "the members of a calibration are not told: $object"
  for name in $names; do
    grep -qw -- "$name" "$work/page" || say "the calibration's $name is in no page"
  done
done
grep -q '@[a-z_]*@' "$man"/*.[157] && say "something was not put in"

# A text reads right where it lies: a title of its own, and what the code puts in stands there or is told.
for text in src/manual/text/*.md; do
  head -n 1 "$text" | grep -qE '^# foilgauge[-a-z]*\([157]\) - [a-z]' || say "$text has no title"
  sed 's/<!--@[a-z_]*@-->//g' "$text" | grep -q '@[a-z_]*@' && say "$text shows a name in place of what is put in"
  grep -q 'of the table of commands' "$text" && say "$text has no summary of its own"
done

# Bars of a text stay; and the build reports errors of a text.
plain "$man/foilgauge-stiffness.1" | grep -qF 'a + b |F|' || say "the bars of a + b |F| are lost"
mkdir "$work/text" "$work/bars"
# refuse WORDS FILE EDIT: with this edit (of sed) of a text the manual is not made.
refuse() {
  cp src/manual/text/*.md "$work/text/"
  sed -i "$3" "$work/text/$2"
  cmp -s "src/manual/text/$2" "$work/text/$2" && say "the edit $3 changes nothing"
  "$build/foilgauge_manual" "$work/bars" "$work/text"/*.md 2>"$work/said" && say "made with $3"
  grep -q -- "$1" "$work/said" || say "$3 says $(head -c 300 "$work/said")"
}
refuse 'more cells than its head' foilgauge-stiffness.1.md 's/\\|F\\|/|F|/'
refuse 'something else than `foilgauge help`' foilgauge-die.1.md '1s/ - .*/ - of the table of commands/'
refuse "@loop_minutes@ reads '99', the code says" foilgauge-loop.1.md 's/@loop_minutes@-->[0-9]*/@loop_minutes@-->99/'
refuse '@loop_hours@ is not known' foilgauge-loop.1.md 's/@loop_minutes@/@loop_hours@/'
refuse 'a mark <!--@ without its end' foilgauge-recipe.5.md '/<!--@-->/d'

# man passes on what groff says; without man, groff itself.
for page in "$man"/*.[157]; do
  if command -v man >/dev/null; then
    words=$(LC_ALL=C.UTF-8 MANWIDTH=80 man --warnings -l "$page" 2>&1 >"$work/shown")
    [ "$(wc -l <"$work/shown")" -gt 10 ] || say "man shows nothing of $page"
  elif command -v groff >/dev/null; then
    words=$(groff -man -ww -z "$page" 2>&1)
  fi
  [ -z "${words-}" ] || say "$page: $words"
done

# Help is help, whatever stands before it.
"$fg" loop --table --help >"$work/out" 2>&1 || say "loop --table --help: exit $?"
grep -q -- '--response' "$work/out" || say "loop --table --help does not explain the tables' options"
"$fg" render --help | grep -q '^Usage: foilgauge render ' || say "render --help calls itself otherwise"
"$fg" doe plan --help | grep -q '^Usage: foilgauge doe plan ' || say "doe plan --help"
"$fg" help doe plan | grep -q '^Usage: foilgauge doe plan ' || say "help doe plan"
[ "$("$fg" help doe plan)" = "$("$fg" doe plan --help)" ] || say "help doe plan is not its --help"
"$fg" help nothing >"$work/out" 2>&1
[ $? = 64 ] || say "help of no command"
"$fg" measure --help >/dev/full 2>/dev/null
[ $? = 74 ] || say "help on a full disk"

# An earlier name of a command does what the command does: its run, its help, its page, its completion.
[ "$("$fg" form --help)" = "$("$fg" forming --help)" ] || say "form --help is not that of forming"
[ "$("$fg" help form)" = "$("$fg" help forming)" ] || say "help form is not that of forming"
[ "$("$fg" form -o -)" = "$("$fg" forming -o -)" ] || say "form does something else than forming"
"$fg" form --shape round 2>&1 | grep -q '`foilgauge forming --help' || say "form names an earlier name to its user"
"$fg" help | grep -q '^  form ' && say "help lists an earlier name"
cmp -s "$man/foilgauge-form.1" "$man/foilgauge-forming.1" || say "no page of the name form"

# README: a page, with what the program says of the samples.
[ "$(wc -l <README.md)" -le 150 ] || say "README.md is longer than a page"
named=$(grep -oE '^    (\$ )?build/foilgauge [a-z]+' README.md | sed 's/.* //' | sort -u)
for command in $named; do
  grep -qx "$command" <<<"$commands" || say "README.md uses a command that is none: $command"
done
grep -oE '\]\([^)]*\)' README.md | tr -d '](' | tr -d ')' | while read -r path; do
  [ -e "${path%%#*}" ] || grep -qi "^## ${path#\#}\$" <(tr ' ' - <README.md | sed 's/^##-/## /') || echo "$path"
done >"$work/gone"
[ -s "$work/gone" ] && say "README.md points to what is not there: $(cat "$work/gone")"

[ -n "${FOILGAUGE_TEST_BRIEF-}" ] && exit $failed

ln -s "$PWD"/samples "$work/samples"
mkdir -p "$work/build"
ln -s "$fg" "$work/build/foilgauge"
if command -v script >/dev/null; then
  while IFS= read -r line; do
    case $line in
    '    $ '*)
      (cd "$work" && script -qec "${line#    $ }" "$work/typed" </dev/null >/dev/null) ||
        say "README.md: ${line#    $ }: exit $?"
      tr -d '\r' <"$work/typed" >"$work/said" ;;
    '    '?*)
      [ -s "$work/said" ] || continue
      grep -qF -- "${line#    }" "$work/said" || say "README.md says what the program does not: $line" ;;
    *) : >"$work/said" ;;
    esac
  done < <(sed 's/ *$//' README.md)
fi

# Examples: in a folder that has the files they name. Every one ends with 0.
PATH=$build:$PATH
spec() { # direction, seed, dpi: a foil of three bumps
  printf '{"schema": "foilgauge/render/1", "seed": %s, "foils": [{"design": {"bump_count": 3},
    "radius_springback": {"mean": 0.02, "sd": 0.005}, "rotate_deg": %s}],
    "scanner": {"dpi": %s, "noise": 0.5}}' "$2" "$1" "$3"
}
mkdir -p "$work/ex/scans" "$work/ex/inbox"
cp samples/die/*.txt samples/doe/*.csv samples/stiffness/*.csv "$work/ex"
cd "$work/ex" || exit 1
spec -90 1 2400 >spec.json && foilgauge render spec.json -o scan.png
spec -90 2 2400 >other.json && foilgauge render other.json -o scan_2.png
spec 0 1 2400 >turned.json && foilgauge render turned.json -o scan_90.png
echo scan,foil,die >lot8.csv
for i in 1 2 3 4; do
  spec -90 "$i" 1200 >foil.json
  foilgauge render foil.json -o "scans/foil_$i.png"
  echo "scans/foil_$i.png,$i,$((i % 2))" >>lot8.csv
done
cp scans/foil_1.png inbox
cat >my_foil.json <<'D'
{"schema": "foilgauge/design/1", "name": "gen2", "bump_count": 3, "bump_radius_mm": 3.32, "bump_angle_deg": 63.15,
 "overall_radius_mm": 20.73, "thickness_mm": 0.1, "calibration": "not needed: rendered", "tolerances": {"radius_mm": {"min": 3, "max": 4}}}
D
echo '{"schema": "foilgauge/design/1", "form": "discs", "diameters_mm": [2, 3, 4, 5]}' >plate.json
cat >plate_spec.json <<'D'
{"schema": "foilgauge/render/1", "scanner": {"dpi": 1200}, "discs": [
  {"centre_mm": [3, 3], "radius_mm": 1}, {"centre_mm": [12, 4], "radius_mm": 1.5},
  {"centre_mm": [4, 12], "radius_mm": 2}, {"centre_mm": [12, 12], "radius_mm": 2.5}]}
D
foilgauge render plate_spec.json -o plate.png
echo '{"schema": "foilgauge/recipe/1", "design": "my_foil.json", "station": {"file_name": "{serial}"}}' >station.json
cat >runs.csv <<'D'
run,temperature_C,duration_h,scan
1,500,3,scans/foil_1.png
2,600,3,scans/foil_2.png
3,500,5,scans/foil_3.png
4,600,5,scans/foil_4.png
5,550,4,scans/foil_1.png
D
foilgauge lot lot8.csv -o lot6 --design my_foil.json 2>/dev/null || say "the folder for the examples: lot6"
examples=0
while IFS= read -r line; do
  case $line in
  '#'*) page=${line#\# } ;;
  *)
    examples=$((examples + 1))
    bash -c "$line" >"$work/out" 2>"$work/err" </dev/null ||
      say "example of $page: $line: exit $?: $(head -c 300 "$work/err")" ;;
  esac
done <"$man/examples"
[ "$examples" -ge 30 ] || say "only $examples examples were found"
for file in foil.json foil.html foil.csv lot7/index.html lot8/lot.json lot9/lot.json die_a.json loop.json \
  springback.html plan.csv rendered.png lots.html bumps.html better.json; do
  [ -s "$file" ] || say "no example has made $file"
done
cd "$OLDPWD" || exit 1

# Completion.
complete_line() { # words...
  bash -c '. "$0"; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _foilgauge; printf "%s\n" "${COMPREPLY[@]}"' \
    "$build/completion/foilgauge" "$@" 2>&1
}
mkdir "$work/files"
(cd "$work/files" && touch 'my scan.png' b.json c.csv d.tif e.html && mkdir sub)
[ "$(complete_line foilgauge me | tr '\n' ' ')" = "measure merge " ] || say "completion of commands"
(cd "$work/files"
 [ "$(complete_line foilgauge measure --model '' | sort | tr '\n' ' ')" = "b.json sub " ] || exit 1
 [ "$(complete_line foilgauge measure '' | sort | tr '\n' ',')" = "d.tif,my scan.png,sub," ] || exit 2
 [ "$(complete_line foilgauge measure --html = | sort | tr '\n' ' ')" = "e.html sub " ] || exit 3
 [ "$(complete_line foilgauge lot -o '')" = sub ] || exit 4) || say "completion of files: $?"
complete_line foilgauge measure --ch | grep -qx -- '--channel=' || say "completion of options"
[ -z "$(complete_line foilgauge doe -- | sort | uniq -d)" ] || say "completion offers an option twice"
[ "$(complete_line foilgauge form --te)" = "$(complete_line foilgauge forming --te)" ] || say "completion of an earlier name"
complete_line foilgauge form --te | grep -qx -- '--temperature=' || say "completion of form's options"
complete_line foilgauge lot --pages b | grep -qx bad || say "completion of --pages"
complete_line foilgauge measure --channel g | grep -qx green || say "completion of words"

exit $failed
