#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Orders and dispositions. Orders: opened by number from an ERP's file, by hand, and refused where nobody knows them; scans that come belong to the
# open one; progress; the Scan button names its file by it.
# Usage: test_station_orders.sh PROGRAM
name=test_station_orders
. "$(dirname "$0")/../support/station.sh"
mkdir "$work/scans" "$work/erp"
for seed in 1 2 3 4 5 6 7 8 9 10 11; do
  radius=3.32
  case $seed in 2 | 6 | 7 | 8 | 9) radius=3.4 ;; 10) radius=3.39 ;; esac
  printf '{"schema": "foilgauge/render/1", "seed": %s, "scanner": {"dpi": 1200}, "foils": [{"rotate_deg": -90,
    "design": {"bump_count": 2, "bump_radius_mm": %s}}]}' "$seed" "$radius" >"$work/spec.json"
  "$renderer" render "$work/spec.json" -o "$work/$seed.png"
done
printf 'Order;Batch;Tool;Material;Quantity\n4711;L7;B;K7;40\n4712;L8;A;K8;2\n' >"$work/erp/today.csv"
# Numbers of things are no numbers; a later file's row counts.
printf 'Order;Batch;Tool;Material;Quantity\n000815;old;B;K7;40\n1e3;L13;B;K7;4\n' >"$work/erp/a.csv"
touch -d '1 hour ago' "$work/erp/a.csv"
printf 'Order;Batch;Tool;Material;Quantity\n000815;00012;01;007;5\n4500012345678901234;1,5;B;K7;4\n' >"$work/erp/b.csv"
long=$(printf 'campaign-%.0s' $(seq 20))
printf 'Order;Batch;Tool\n61;%s1;B\n62;%s2;B\n' "$long" "$long" >"$work/erp/long.csv"
printf 'not a table' >"$work/erp/readme.txt"
cat >"$work/recipe.json" <<R
{"schema": "foilgauge/recipe/1",
 "station": {"file_name": "{serial}", "scan_command": "cp $work/5.png {file}", "reasons": "S1 scratch, B2 burr",
             "parts": [{"part": "Wide", "recipe": "wide.json"}]},
 "design": {"schema": "foilgauge/design/1", "bump_count": 2, "calibration": "not needed: the scan is rendered",
            "tolerances": {"radius_mm": {"min": 3.3, "max": 3.34}}}}
R
sed 's/"min": 3.3, "max": 3.34/"min": 3.38, "max": 3.42/; /"station"/,/"parts"/d' "$work/recipe.json" >"$work/wide.json"
"$program" station "$work/scans" --recipe "$work/recipe.json" --orders "$work/erp" --port 0 >"$work/address" 2>"$work/err" &
station=$!
checks - "$work" >&2 <<'PY' || fail "orders: $(cat "$work/err")"
import csv, os, re, shutil, sqlite3, sys, urllib.error, urllib.parse, urllib.request
work = sys.argv[1]
base = wait_until(lambda: open(work + "/address").read().strip())
def get(path):
    return plain(urllib.request.urlopen(base + path.lstrip("/")).read().decode())
token = re.search('name="form" value="([0-9a-f]+)"', get("/orders")).group(1)
def post(path, **fields):
    data = urllib.parse.urlencode({"form": token, **fields}).encode()
    try:
        with urllib.request.urlopen(base + path.lstrip("/"), data) as answer:
            return answer.geturl(), plain(answer.read().decode())
    except urllib.error.HTTPError as error:
        return str(error.code), plain(error.read().decode())
database = sqlite3.connect(work + "/scans/foilgauge.sqlite")
def foils():
    return database.execute("SELECT serial, lot, die, coil, order_id FROM foils ORDER BY id").fetchall()
def drop(seed, name):
    count = len(foils())
    shutil.copy(f"{work}/{seed}.png", f"{work}/scans/.new")
    os.rename(f"{work}/scans/.new", f"{work}/scans/{name}.png")
    wait_until(lambda: len(foils()) > count)

drop(1, "before")
assert foils() == [("before", "", "", "", 0)], foils()
where, page = post("/order", number="<9>")
assert "unknown=" in where and "Nobody knows the order <b>&lt;9&gt;</b>" in page, where
assert post("/order", number=" ")[0] == "422"
where, page = post("/order", number="4711")
assert 'href="/orders">Order 4711</a>: <b>0 of 40</b>, 0 failed' in page, page
drop(2, "F1")
drop(3, "F2")
assert foils()[1:] == [("F1", "L7", "B", "K7", 1), ("F2", "L7", "B", "K7", 1)], foils()
assert "<b>2 of 40</b>, 1 failed" in get("/"), get("/")
drop(4, "F1")  # measured again: it passes now
assert "<b>2 of 40</b>, 0 failed" in get("/"), get("/")
post("/scan")
wait_until(lambda: len(foils()) == 5)
assert foils()[4][:2] == ("4711-004", "L7"), foils()
assert [name for name in os.listdir(work + "/scans") if re.fullmatch(r"station-\d{8}-\d{6}-\d{3}-4711\.png", name)]
# By hand, beside the first; its fields win; then none is open.
post("/order", number="X 1", lot="L9", die="C", pieces="3")
assert "Order X 1</a>: <b>0 of 3</b>" in get("/")
assert post("/order-close", order="2", by="")[0] == "422"
post("/order-close", order="2", by="Ada")
assert "Order 4711</a>: <b>3 of 40</b>" in get("/"), get("/")
post("/order-close", order="1", by="Ada")
assert "Order" not in re.sub("<nav.*?</nav>", "", get("/"), flags=re.S)
page = get("/orders")
assert "3 of 40" in page and "Ada" in page, page

# Dispositions: F1 passed when it was measured again; the foil of another radius is open until somebody says its fate.
drop(6, "F9")
foil = database.execute("SELECT id FROM foils WHERE serial = 'F9'").fetchone()[0]
assert "<b>1</b> without disposition" in get("/") and f'href="/foil?id={foil}#fate"' in get("/"), get("/")
assert "F9" in get("/history?verdict=open") and "F2" not in get("/history?verdict=open")
database.execute("UPDATE foils SET lot = 'L9' WHERE id = ?", (foil,)), database.commit()
assert 'value="S1 scratch"' in get(f"/foil?id={foil}") and "No disposition yet" in get(f"/foil?id={foil}")
assert "No disposition yet" not in get("/foil?id=1")
assert "with 1 foil without disposition" in get("/lots?close=1&lot=L9")
assert post("/close", lot="L9", by="Ada")[0] == "422"
assert post("/dispose", foil=str(foil), kind="scrap", by=" ")[0] == "422"
assert post("/dispose", foil=str(foil), kind="eat", by="Ada")[0] == "422"
assert post("/dispose", foil="1", kind="scrap", by="Ada")[0] == "404"
post("/dispose", foil=str(foil), kind="again", by="Ada")
assert "<b>1</b> without disposition" in get("/")
where, page = post("/dispose", foil=str(foil), kind="scrap", reason="S1 scratch", note="<deep>", by="Ada")
assert "<b>Scrap</b>, S1 scratch: &lt;deep&gt; (Ada" in page and "scrap, S1 scratch: &lt;deep&gt;" in page, page
assert "without disposition" not in get("/") and "#fate" not in get("/") and "without disposition" not in get("/lots?close=1&lot=L9")
assert post("/close", lot="L9", by="Ada")[0].endswith("/lots")
wait_until(lambda: os.path.exists(work + "/scans/lots/L9/lot.json"))
manifest = open(work + "/scans/lots/L9/manifest.csv").read()
assert "disposition" in manifest.splitlines()[0] and manifest.splitlines()[1].rstrip().endswith("scrap"), manifest

# The part of an order chooses the recipe by which its scans are measured and judged; without an order the station's own does.
post("/order", number="W1", part="wide", lot="L10", pieces="1")
assert " Design gen2-classical." in get("/orders"), get("/orders")
drop(7, "G1")
post("/order-close", order=str(database.execute("SELECT id FROM orders WHERE number = 'W1'").fetchone()[0]), by="Ada")
drop(8, "G2")
judged = database.execute("SELECT serial, foils.verdict, setup FROM foils JOIN scans ON scans.id = scan WHERE serial IN ('G1', 'G2') ORDER BY 1").fetchall()
assert [row[:2] for row in judged] == [("G1", "pass"), ("G2", "fail")] and judged[0][2] != judged[1][2], judged
post("/close", lot="L10", by="Ada")
wait_until(lambda: os.path.exists(work + "/scans/lots/L10/lot.json"))
assert "3.42" in open(work + "/scans/lots/L10/lot.json").read()
# A chart has the tolerance of its foils' recipe, not the station's.
post("/order", number="W2", part="wide", lot="L11")
drop(9, "H1")
drop(10, "H2")
page = get("/trends?q=bump:radius_mm&lot=L11")
assert re.search(r"max 3\.420*<", page) and re.search(r"min 3\.380*<", page), re.findall("(?:max|min) 3[^<]*", page)
assert "tolerance of the design" in page
page = get("/trends?q=bump:radius_mm")
assert "tolerance of the newest foil&#39;s recipe" in page or "tolerance of the newest foil's recipe" in page, page

# The clock is set back: the order opened last is in force all the same.
database.execute("UPDATE orders SET opened_at = opened_at + 86400000 WHERE number = 'W2'"), database.commit()
post("/order", number="N1", lot="L12")
assert "Order N1</a>: <b>0</b>" in get("/"), get("/")
def opened(number):
    post("/order", number=number)
    return database.execute("SELECT number, lot, die, coil, pieces FROM orders ORDER BY opened_at DESC").fetchone()
assert opened("000815") == ("000815", "00012", "01", "007", 5), opened("000815")
assert opened("1e3") == ("1e3", "L13", "B", "K7", 4)
assert opened("815") == ("000815", "00012", "01", "007", 5), opened("815")
assert opened("4500012345678901234") == ("4500012345678901234", "1,5", "B", "K7", 4)

# A name that is too long is refused, not cut; the longest one stays whole, and so do the letters of a closer's name.
where, page = post("/order", number="ü" * 60, lot="L14")
assert where == "422" and "The order is too long: at most 119 bytes." in page, (where, page)
where, page = post("/order", number="N2", lot="L" * 128)
assert where == "422" and "The lot is too long: at most 127 bytes." in page, (where, page)
longest = "ü" * 59 + "x"
where, page = post("/order", number=longest)
assert f"Nobody knows the order <b>{longest}</b>" in page, (where, page)
post("/order", number=" " + longest + " ", lot="ß" * 63)
assert opened(longest)[:2] == (longest, "ß" * 63), opened(longest)
shutil.copy(work + "/11.png", work + "/5.png")
post("/scan")
wait_until(lambda: (longest + "-001", "ß" * 63) in [row[:2] for row in foils()])
assert "ß" * 63 in get("/trends?lot=" + urllib.parse.quote("ß" * 63))
post("/close", lot="L9", by="é" * 127)
wait_until(lambda: database.execute("SELECT 1 FROM lots WHERE by = ?", ("é" * 127,)).fetchone())
post("/order", number="N1")

# Coil and order of a foil are in its lot's files.
post("/close", lot="L7", by="Ada")
wait_until(lambda: os.path.exists(work + "/scans/lots/L7/lot.json"))
rows = list(csv.DictReader(open(work + "/scans/lots/L7/foils.csv")))
assert rows and all((row["die"], row["coil"], row["order"]) == ("B", "K7", "4711") for row in rows), rows
assert "coil" not in open(work + "/scans/lots/L9/manifest.csv").readline()

# An order that is opened again has what the ERP says of it now, and is the first of the list; an empty field keeps its
# value, and the order that is open keeps its fields.
post("/order-close", order="1", by="Ada")
with open(work + "/erp/c.csv", "w") as table:
    table.write("Order;Batch;Tool;Material;Quantity\n4711;L77;;K8;60\n")
post("/order", number="4711")
def row():
    return database.execute("SELECT lot, die, coil, pieces, closed_at, id FROM orders WHERE number = '4711'").fetchone()
assert row() == ("L77", "B", "K8", 60, 0, 1), row()
assert re.search(r"<h2>Newest orders</h2>\s*<ul[^>]*>\s*<li><b>4711</b>, lot L77", get("/orders")), get("/orders")
post("/order", number="4711", lot="L78")
post("/order", number="4711")
assert row()[0] == "L78", row()

# Lots whose names are longer than a field stay two lots.
for number in "61", "62":
    assert "/orders" not in post("/order", number=number)[0]
lots = database.execute("SELECT lot FROM orders WHERE number IN ('61', '62') ORDER BY number").fetchall()
assert len(set(lots)) == 2 and all(lot.startswith("campaign-") and len(lot) == 127 and lot[-9] == "~" for lot, in lots), lots
print("orders: ERP, by hand, progress, Scan; dispositions; several recipes")
PY
