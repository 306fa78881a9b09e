#!/bin/bash
# The manual: a page for every command, every option in it, no warning of the formatter; its
# examples run; the shell's completion; help wherever it is asked for.
set -u
fg=$(realpath "$1")
build=$(dirname "$fg")
man=$build/man
failed=0
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

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
  grep -q '^64$' "$work/page" || say "$command: no exit code 64"
  grep -q '@[a-z_]*@' "$work/page" "$work/help" && say "$command: something was not put in"
  "$fg" help | grep -qF "$(sed -n "/^foilgauge-$command - /s///p" "$work/page")" ||
    say "$command: the page says something else than help"
done

# What a recipe is written with is in its page; samples hold nothing else.
plain "$man/foilgauge-recipe.5" >"$work/page"
"$fg" lot --print-recipe | cat - samples/station/recipe.json | grep -oE '"[a-z_]+":' | tr -d '":' |
  sort -u >"$work/keys"
plain "$man/foilgauge-design.5" >>"$work/page"
while read -r key; do
  grep -qE "^\\\\?f?B?(assembly\.|station\.(check\.)?)?$key\$" "$work/page" ||
    say "the recipe's member $key is in no page"
done <"$work/keys"
grep -q '@[a-z_]*@' "$man"/*.[15] && say "something was not put in"

# man passes on what groff says; without man, groff itself.
for page in "$man"/*.[15]; do
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
"$fg" help nothing >"$work/out" 2>&1
[ $? = 64 ] || say "help of no command"
"$fg" measure --help >/dev/full 2>/dev/null
[ $? = 74 ] || say "help on a full disk"

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
complete_line foilgauge measure --channel g | grep -qx green || say "completion of words"

exit $failed
