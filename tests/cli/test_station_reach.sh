#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Addresses of a station: every address and name of the machine, names that --host adds, a proxy with TLS before
# it (nginx, where it is installed), and no other name. Usage: test_station_reach.sh PROGRAM
name=test_station_reach
. "$(dirname "$0")/../support/station.sh"
proxy=
at_end() {
  [ -z "$proxy" ] || kill "$proxy" 2>/dev/null || true
}
token=a-token-of-this-test
echo "$token" >"$work/token"
chmod 600 "$work/token"
mkdir "$work/in"
draw 1 "$work/in/1.png"

# refused CODE WORDS OPTION...
refused() {
  local code=0 expected=$1 words=$2
  shift 2
  timeout 20 "$program" station "$work/in" --port 0 "$@" >"$work/out" 2>"$work/said" || code=$?
  [ $code -eq "$expected" ] || fail "exit code $code, expected $expected: $*"
  grep -qF -- "$words" "$work/said" || fail "no word of '$words': $*"
}
refused 64 "give --token-file" --listen 0.0.0.0
refused 64 "give --token-file" --listen ::
refused 64 "give --token-file" --origin https://scanner.example.com
refused 64 "is no address" --listen scanner.example.com --token-file "$work/token"
refused 64 "is none" --origin https://scanner.example.com/path --token-file "$work/token"
refused 64 "is none" --origin scanner.example.com --token-file "$work/token"
refused 64 "is no name" --host "http://scanner" --token-file "$work/token"
refused 64 "one of them" --token "$token" --token-file "$work/token"
refused 74 "cannot be opened" --token-file "$work/nowhere"
: >"$work/empty"
refused 65 "must be the token" --token-file "$work/empty"
echo short >"$work/short"
refused 64 "a token needs 16 to 64" --token-file "$work/short"

# codes.py WHERE TOKEN HOST...: the answer's code to a request for each host, with the cookie; a dash first: without.
cat >"$work/codes.py" <<'PY'
import socket, sys
where, token, hosts = sys.argv[1], sys.argv[2], sys.argv[3:]
address, port = where.rsplit(":", 1)
for host in hosts:
    with socket.create_connection((address.strip("[]"), int(port)), 10) as to:
        to.sendall(("GET /lots HTTP/1.1\r\nHost: %s\r\nCookie: foilgauge=%s\r\nConnection: close\r\n\r\n"
                    % (host.replace("PORT", port), token)).encode())
        print(to.recv(64).split(b" ")[1].decode(), end=" ")
PY
addresses=$(python3 - <<'PY'
import re, subprocess
try:
    text = subprocess.run(["ip", "-4", "-o", "addr", "show", "up"], capture_output=True, text=True).stdout
except OSError:
    text = ""
print(*re.findall(r"inet ([0-9.]+)", text) or ["127.0.0.1"])
PY
)
machine=$(hostname)
for listen in 0.0.0.0 ::; do
  [ $listen = 0.0.0.0 ] || [ -e /proc/net/if_inet6 ] || continue
  start "$work/in" $recipe --listen $listen --token-file "$work/token" --host scanner.example.com --host other.example:443
  grep -q "^http://[^/]*/?token=$token$" "$work/address" || fail "$listen: no address: $(cat "$work/address")"
  ! grep -q "://0.0.0.0\|://\[::\]" "$work/address" || fail "$listen is no address that a browser can open"
  ! tr '\0' ' ' <"/proc/$station/cmdline" | grep -q "$token" || fail "the token is in /proc"
  port=$(sed -E 's/.*:([0-9]+)\/.*/\1/; q' "$work/address")
  for address in $addresses; do
    found=$(python3 "$work/codes.py" "$address:$port" "$token" $address:PORT "$machine:PORT" "${machine^^}:PORT" \
      "${machine%%.*}.local:PORT" localhost:PORT scanner.example.com scanner.example.com:PORT other.example:443)
    [ "$found" = "200 200 200 200 200 200 200 200 " ] || fail "$listen at $address: $found"
    found=$(python3 "$work/codes.py" "$address:$port" "$token" evil.example:PORT evil.example 203.0.113.7:PORT \
      $address "$machine.evil.example:PORT" other.example:PORT "$address:PORT.evil.example" "[::2]:PORT" "" "@" "[")
    [ "$found" = "421 421 421 421 421 421 421 421 421 421 421 " ] || fail "$listen at $address, other names: $found"
  done
  [ $listen = 0.0.0.0 ] || [ "$(python3 "$work/codes.py" "[::1]:$port" "$token" "[::1]:PORT" "[0:0::1]:PORT")" = "200 200 " ] ||
    fail "::1"
  stop
done

# Without a token, on this machine alone: no name of the machine.
start "$work/in" $recipe
where=$(sed -E 's/http:\/\/([^/]*).*/\1/' "$work/address")
found=$(python3 "$work/codes.py" "$where" x "$where" localhost:PORT "$machine:PORT" evil.example:PORT)
case $machine in localhost*) ;; *) [ "$found" = "200 200 421 421 " ] || fail "this machine alone: $found" ;; esac
stop

if ! command -v nginx >/dev/null || ! command -v openssl >/dev/null; then
  echo "reach: addresses and names; nginx or openssl is not installed: no proxy"
  exit 0
fi
port=$(python3 -c 'import socket; s = socket.socket(); s.bind(("127.0.0.1", 0)); print(s.getsockname()[1])')
start "$work/in" $recipe --token-file "$work/token" --origin "https://localhost:$port"
wait_for 10 grep -q "^http://127" "$work/address"
head -n 1 "$work/address" | grep -qx "https://localhost:$port/?token=$token" || fail "$(cat "$work/address")"
inside=$(sed -nE 's/^(http:\/\/127[^/]*).*/\1/p' "$work/address")
openssl req -x509 -newkey rsa:2048 -nodes -days 2 -subj /CN=localhost -addext subjectAltName=DNS:localhost \
  -keyout "$work/key.pem" -out "$work/cert.pem" 2>/dev/null
# proxy LINE: nginx with another line of its configuration.
run_proxy() {
  cat >"$work/nginx.conf" <<N
daemon off; pid $work/nginx.pid; error_log $work/nginx.log; worker_processes 1;
events { worker_connections 128; }
http {
  access_log off; client_body_temp_path $work/n1; proxy_temp_path $work/n2; fastcgi_temp_path $work/n3;
  uwsgi_temp_path $work/n4; scgi_temp_path $work/n5;
  server {
    listen 127.0.0.1:$port ssl; server_name localhost;
    ssl_certificate $work/cert.pem; ssl_certificate_key $work/key.pem;
    location / { proxy_pass $inside; proxy_read_timeout 1h; $1 }
  }
}
N
  nginx -p "$work" -c "$work/nginx.conf" 2>>"$work/said" &
  proxy=$!
}
cat >"$work/browse.py" <<'PY'
import http.cookiejar, re, ssl, sys, time, urllib.error, urllib.parse, urllib.request
base, cert, token, serial = sys.argv[1:]
jar = http.cookiejar.CookieJar()
opener = urllib.request.build_opener(urllib.request.HTTPCookieProcessor(jar),
    urllib.request.HTTPSHandler(context=ssl.create_default_context(cafile=cert)))
def ask(path, fields=None, **headers):
    data = urllib.parse.urlencode(fields).encode() if fields else None
    try:
        with opener.open(urllib.request.Request(base + path, data, headers), timeout=10) as answer:
            return answer.status, plain(answer.read().decode())
    except urllib.error.HTTPError as error:
        return error.code, plain(error.read().decode())
assert ask("/")[0] == 401
code, page = ask("/?token=" + token)
assert code == 200 and "foilgauge" in page, (code, page)
cookie, = jar
assert cookie.secure and cookie.has_nonstandard_attr("HttpOnly"), vars(cookie)
form = re.search('data-form="([0-9a-f]+)"|name="form" value="([0-9a-f]+)"', ask("/foil?id=1")[1] + page)
form = form[1] or form[2]
fields = dict(re.findall('type="hidden" name="(was_[a-z]+)" value="([^"]*)"', ask("/foil?id=1")[1]))
fields.update({"form": form, "foil": 1, "serial": serial, "lot": "L", "die": "", "operator": "me"})
for origin, expected in [("https://evil.example", 403), (base.replace("https", "http"), 403), ("null", 403), (base, 200)]:
    site = {"Sec-Fetch-Site": "same-origin" if origin == base else "cross-site"}
    code, page = ask("/correct", fields, Origin=origin, **site)
    assert code == expected, (origin, code, page)
assert serial in ask("/foil?id=1")[1]
PY
for line in "" 'proxy_set_header Host $host;' 'proxy_set_header Host $http_host;' \
  'proxy_http_version 1.1; proxy_set_header Connection "";'; do
  case $line in
    *' $host;'*) # without the port: as on 443
      stop
      start "$work/in" $recipe --token-file "$work/token" --origin "https://localhost:$port" --host localhost
      wait_for 10 grep -q "^http://127" "$work/address"
      inside=$(sed -nE 's/^(http:\/\/127[^/]*).*/\1/p' "$work/address")
      ;;
  esac
  run_proxy "$line"
  wait_for 10 python3 -c 'import socket, sys; socket.create_connection(("127.0.0.1", int(sys.argv[1])))' "$port"
  checks "$work/browse.py" "https://localhost:$port" "$work/cert.pem" "$token" "S-$RANDOM" 2>>"$work/said" ||
    fail "through nginx with '$line'"
  kill $proxy && wait $proxy 2>/dev/null || true
  proxy=
done
stop
echo "reach: addresses and names, nginx with TLS in four ways"
