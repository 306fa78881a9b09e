#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Input that `foilgauge die` refuses: each with the file, the place and a remedy.
. tests/support/cli.sh
cp "$root"/samples/die/c*.txt .
tr -d '\r' <concave_1.txt | grep '^[-0-9]' >good.txt
say="--half concave --tip-um 2 --unit mm"

# refuse WORDS FILE OPTION...: exit 65, and the file's name with the words.
refuse() {
  local words=$1 file=$2
  shift 2
  expect 65 "$file: $words" "$program" die "$@" "$file"
}

expect 0 "" "$program" die $say good.txt -o good.json
: >empty.txt
refuse "the file is empty" empty.txt $say
printf '\n \r\n' >blank.txt
refuse "the file is empty" blank.txt $say
echo "only words" >words.txt
refuse "no line with two numbers" words.txt $say
awk '{print $2}' good.txt >z_alone.txt
refuse "one number in a line" z_alone.txt $say
head -n 1 good.txt >one.txt
refuse "line 1: one point is no profile" one.txt $say
head -c 3000 "$program" >binary.txt
refuse "not a text" binary.txt $say
tr '\t' '\001' <good.txt >control.txt
refuse "not a text" control.txt $say
iconv -f latin1 -t utf16 good.txt >utf16.txt
refuse "this is UTF-16" utf16.txt $say

sed '100s/.*/1.98\tNaN/' good.txt >nan.txt
refuse "line 100: z is 'NaN', which is no number" nan.txt $say
for value in 1e18 -1e18 1e200 400; do # lengths beyond any count of stations, and merely no die
  awk -v z=$value 'NR == 100 {$2 = z} {print $1 "\t" $2}' good.txt >stray.txt
  refuse "point 100 .x .* mm.: z is .* mm, where the trace's median is .* no die of this design" stray.txt $say
done
sed '100s/.*/1.98/' good.txt >short.txt
refuse "line 100: 1 columns where the lines before have 2" short.txt $say
sed '100s/$/\t0.5/' good.txt >long.txt
refuse "line 100: 3 columns" long.txt $say
head -c 20000 good.txt | sed '$s/\t.*//' >cut.txt
refuse "line [0-9]*: 1 columns where the lines before have 2; was the file cut off" cut.txt $say
head -n 900 concave_1.txt >truncated.txt
refuse "the header says 1[0-9]* points, the file has 895: it was cut off" truncated.txt
cat good.txt good.txt >twice.txt
refuse "point 1[0-9]* .*x goes back" twice.txt $say
sort -R --random-source=good.txt good.txt >shuffled.txt
refuse "point [0-9]* .*x goes back" shuffled.txt $say
sed 's/\./,/; 5s/,/./' good.txt | tr '\t' ';' >mixed.txt
refuse "line 1: numbers have commas and points" mixed.txt $say
awk '{printf "%d,%d\n", 1000 * $1, 1000 * $2}' good.txt >whole.txt
refuse "line 1: a comma may be the decimal mark" whole.txt --half concave --tip-um 2 --unit um
awk '{print NR "\t" $1 "\t" $2}' good.txt >three.txt
refuse "line 1: 3 columns, and no heading says which is x" three.txt $say
refuse "line 1: no column 4" three.txt $say --columns 2,4

# Levelling subtracts a line, which shears the die: radii of -2.4 to +2.5 % came with U of 0.4 %. A tilt is a rotation.
for slope in 0.0021 -0.0175; do
  awk -v q=$slope '{printf "%s\t%.6f\n", $1, $2 - q * $1}' good.txt >levelled.txt
  refuse "lands and bumps are sheared as if a line of [01].* degrees was subtracted" levelled.txt $say
done
awk '{a = 0.02; printf "%.6f\t%.6f\n", $1 * cos(a) - $2 * sin(a), $1 * sin(a) + $2 * cos(a)}' good.txt >tilted.txt
expect 0 "" "$program" die $say tilted.txt -o tilted.json
near "the radius of a tilted trace" "$(value tilted.json 'r["die"]["mean"]["radius_mm"]')" \
  "$(value good.json 'r["die"]["mean"]["radius_mm"]')" 0.0004

# Units are never guessed.
refuse "the header does not say the unit of x; say --unit" good.txt --half concave --tip-um 2
refuse "in um the trace is .* mm long.*in mm it would be" good.txt --half concave --tip-um 2 --unit um
refuse "the header says mm of x, the command um" concave_1.txt --unit um
(echo "X [inch]	Z [inch]" && cat good.txt) >inch.txt
refuse "the header has a unit of x that is not read" inch.txt --half concave --tip-um 2
refuse ".*" good.txt --half concave --tip-um 2 --unit mm,um
awk '{print $1 "\t" 0.5 * $2}' good.txt >half_z.txt
refuse "the overall circle has a radius of .*the unit of an axis" half_z.txt $say

# Half and tip.
refuse "nothing says which half" good.txt --tip-um 2 --unit mm
refuse "the header says concave, the command convex" concave_1.txt --half convex
refuse "said to be the convex half, but the trace shows grooves on a dome" good.txt --half convex --tip-um 2 --unit mm
cp concave_1.txt convex_named.txt
refuse "the header says concave, the file's name convex" convex_named.txt
refuse "the header does not say the radius of the tip" good.txt --half concave --unit mm
refuse "the header says a tip of 2 um, the command 5 um" concave_1.txt --tip-um 5
refuse "a tip of 4 mm does not fit a bump" good.txt --half concave --unit mm --tip-um 4000
refuse ".*the unit of an axis, the tip or --design is wrong" good.txt --half concave --unit mm --tip-um 1500

# Too little of a die.
awk '$1 > 14.4 && $1 < 21.5' good.txt >two_bumps.txt
refuse ".*(trace further|three bumps or more)" two_bumps.txt $say
awk 'NR % 20 == 0' good.txt >sparse.txt
refuse "[0-9]* points over .* are too few" sparse.txt $say
awk '{print $1 "\t" 0.001 * NR}' good.txt >line.txt
refuse "no bumps along the strip" line.txt $say
refuse "the bumps that are seen would have numbers up to 13" concave_1.txt --first-bump 5
printf '{"schema":"foilgauge/design/1","form":"discs","diameters_mm":[4]}' >discs.json
expect 65 "has no bumps" "$program" die concave_1.txt --design discs.json
echo '{"schema": "foilgauge/design/1", "form": "arc", "overall_radius_mm": 20.73, "subtended_angle_deg": 110,
 "thickness_mm": 0.1}' >arc.json
expect 65 "form .arc. has no bumps" "$program" die concave_1.txt --design arc.json

exit $failed
