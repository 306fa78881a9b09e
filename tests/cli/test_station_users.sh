#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Users with roles: each by a token or by the header of a proxy; actions beyond a role are refused, and every action bears the
# user's name whatever the html form says.
# Usage: test_station_users.sh PROGRAM
name=test_station_users
. "$(dirname "$0")/../support/station.sh"
mkdir "$work/scans"
draw 1 "$work/scans/F1.png"
sed -i 's/"bump_count": 2/"bump_count": 2, "calibration": "not needed: rendered", "tolerances": {"radius_mm": {"min": 3.4}}/' "$work/recipe.json"
printf '# users\nAda,operator,token-of-ada-0000001\nKim,quality,token-of-kim-0000001\nProxied,admin,\n' >"$work/users"
for bad in 'Ada,boss,token-of-ada-0000001' 'Ada,operator' 'Ada,operator,short' '' ',operator,token-of-ada-0000001'; do
  echo "$bad" >"$work/bad"
  ! "$program" station "$work/scans" $recipe --users "$work/bad" --port 0 >"$work/out" 2>&1 || fail "'$bad' was taken"
done
! "$program" station "$work/scans" $recipe --users "$work/users" --token x >"$work/out" 2>&1 || fail "--token beside --users"
! "$program" station "$work/scans" $recipe --users "$work/users" --user-header X-User >"$work/out" 2>&1 || fail "no --origin"
start "$work/scans" $recipe --users "$work/users" --origin http://127.0.0.1:1 --user-header X-Remote-User --port 0
wait_for 20 measured "$work/scans" 1
checks - "$(tail -n 1 "$work/address")" "$work" "$station" >&2 <<'PY' || fail "users"
import re, sqlite3, subprocess, sys, urllib.error, urllib.parse, urllib.request
work = sys.argv[2]
out = subprocess.run(["ss", "-ltnp"], capture_output=True, text=True).stdout
port = re.search(r":(\d+)\s[^\n]*pid=%s," % sys.argv[3], out).group(1)
class Stay(urllib.request.HTTPRedirectHandler):
    def redirect_request(self, *what):
        return None
opener = urllib.request.build_opener(Stay)
def ask(path, user=None, token=None, **fields):
    headers = {"Host": "127.0.0.1:1"}
    if user:
        headers["X-Remote-User"] = user
    if token:
        headers["Cookie"] = "foilgauge=" + token
    data = urllib.parse.urlencode({"form": form, **fields}).encode() if fields else None
    try:
        with opener.open(urllib.request.Request(f"http://127.0.0.1:{port}{path}", data, headers)) as answer:
            return answer.status, answer.read().decode(), answer.headers
    except urllib.error.HTTPError as error:
        return error.code, error.read().decode(), error.headers
form = ""
ada, kim = "token-of-ada-0000001", "token-of-kim-0000001"
assert ask("/")[0] == 401 and ask("/", token="token-of-nobody-0001")[0] == 401 and ask("/", user="Eve")[0] == 401
assert ask("/", user="")[0] == 401
code, _, headers = ask("/?token=" + ada)
assert code == 303 and headers["Set-Cookie"].startswith("foilgauge=" + ada), headers
assert ask("/", token=ada)[0] == ask("/", token=kim)[0] == ask("/", user="Proxied")[0] == 200
# A proxy that names a stranger is not overruled by a cookie.
assert ask("/", user="Eve", token=ada)[0] == 401
form = re.search('name="form" value="([0-9a-f]+)"', ask("/foil?id=1", token=ada)[1]).group(1)
database = sqlite3.connect(work + "/scans/foilgauge.sqlite")
one = lambda sql: database.execute(sql).fetchall()
assert ask("/correct", token=ada, foil="1", serial="F2", by="Somebody")[0] == 303
assert one("SELECT after, by FROM corrections") == [("F2", "Ada")], one("SELECT after, by FROM corrections")
assert ask("/dispose", token=ada, foil="1", kind="concession", by="Kim")[0] == 422
assert ask("/close", token=ada, lot="", by="Kim", open="on")[0] == 403
assert one("SELECT count(*) FROM dispositions") == [(0,)]
assert ask("/dispose", token=kim, foil="1", kind="concession", by="Ada")[0] == 303
assert ask("/dispose", user="Proxied", foil="1", kind="scrap", by="Ada")[0] == 303
assert one("SELECT kind, by FROM dispositions") == [("concession", "Kim"), ("scrap", "Proxied")]
# The trail has all of it, the refused too.
trail = one("SELECT user, action, subject, refused <> '' FROM trail ORDER BY id")
assert trail == [("Ada", "correct", "foil 1, serial F2", 0), ("Ada", "dispose", "foil 1, kind concession", 1), ("Ada", "close", "", 1),
                 ("Kim", "dispose", "foil 1, kind concession", 0), ("Proxied", "dispose", "foil 1, kind scrap", 0)], trail
page = ask("/trail", token=kim)[1]
assert page.count("<tr>") >= 5 and "foil 1, kind concession" in page, page
PY
stop INT
echo "$name: three users, two roles refused, each named"
