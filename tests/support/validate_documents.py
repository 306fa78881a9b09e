# SPDX-License-Identifier: GPL-3.0-or-later
"""validate_documents.py SCHEMA_FOLDER FOLDER [--some]: the JSON documents of FOLDER, in a folder for each test that made them,
keep to the schemas that their member "schema" names, and each schema is met, but for --some. Prints a table of Markdown to standard
output and offences to standard error. Exit 0: all valid, 1: not, 77: no python3-jsonschema.

Members of the schemas that no document has are listed, too. For speed arrays are shortened: of the elements beyond the
longest that a schema limits one of each structure stays. Structures differ in names, kinds of values, words and signs
of numbers, so that an unknown word or a negative count stays."""

import collections
import hashlib
import json
import pathlib
import re
import sys

from validate_schema import jsonschema, validator

# Documents that have no schema in reports/schema.
WITHOUT_SCHEMA = {
    "foilgauge/results/2",
}
WORD = re.compile(r"[A-Za-z0-9_ ./-]{0,40}")
NO_SCHEMA = "(no member schema)"


def unique_members(pairs):
    """An object; a name that stands in it twice is an error."""
    names = dict(pairs)
    if len(names) < len(pairs):
        twice = [name for name, count in collections.Counter(n for n, _ in pairs).items() if count > 1]
        raise ValueError(f"members that stand in one object twice: {twice}")
    return names


def refuse_constant(text):
    raise ValueError(f"{text} is no JSON")


def max_items(schema):
    """The largest maxItems of a schema."""
    if isinstance(schema, dict):
        own = schema.get("maxItems", 0)
        return max([own if isinstance(own, int) else 0, *map(max_items, schema.values())])
    return max(map(max_items, schema), default=0) if isinstance(schema, list) else 0


class Reducer:
    """Finds the structure of values, and shortens arrays to `longest` elements and those with a structure of their own."""

    def __init__(self, longest):
        self.longest = longest

    def reduce(self, value):
        """Returns the structure and the shortened value."""
        if isinstance(value, dict):
            members = {name: self.reduce(member) for name, member in value.items()}
            structure = ",".join(f"{name}:{members[name][0]}" for name in sorted(members))
            return digest("{" + structure), {name: member for name, (_, member) in members.items()}
        if isinstance(value, list):
            return self.reduce_array(value)
        if isinstance(value, bool) or value is None:
            return str(value), value
        if isinstance(value, str):
            return ('"' + re.sub(r"[0-9]+", "0", value) if WORD.fullmatch(value) else f"text{len(value) // 10}"), value
        size = "negative" if value < 0 else "zero" if value == 0 else "part" if value < 1 else "one" if value == 1 else "more"
        return f"{type(value).__name__} {size}", value

    def reduce_array(self, value):
        elements, seen = [], set()
        for element in value:
            structure, shorter = self.reduce(element)
            if len(elements) < self.longest or structure not in seen:
                elements.append(shorter)
            seen.add(structure)
        return digest(f"[{len(value)}" + ",".join(sorted(seen))), elements


def digest(text):
    return hashlib.sha256(text.encode("utf-8", "surrogatepass")).hexdigest()[:24]


def named_objects(value):
    """The outermost object, then every object in it that names a schema."""
    yield value
    inner = [value]
    while inner:
        at = inner.pop()
        for member in at.values() if isinstance(at, dict) else at:
            if isinstance(member, (dict, list)):
                inner.append(member)
                if isinstance(member, dict) and str(member.get("schema")).startswith("foilgauge/"):
                    yield member


class Schemas:
    def __init__(self, folder):
        self.files = {}
        for path in sorted(pathlib.Path(folder).glob("*.schema.json")):
            self.files[path.name] = json.loads(path.read_text(encoding="utf-8"))
            jsonschema.Draft202012Validator.check_schema(self.files[path.name])
            del self.files[path.name]["$schema"]  # by which a validator would choose the class of another
        self.met = set()
        kind = self.kind_that_notes()
        self.validators = {name: validator(self.files, name, kind) for name in self.files}

    def kind_that_notes(self):
        """A class of validators that note which members they meet, as the identities of their schemas."""
        plain = jsonschema.Draft202012Validator
        check = plain.VALIDATORS["properties"]

        def properties(at, members, instance, schema):
            if isinstance(instance, dict):
                self.met.update(id(words) for name, words in members.items() if name in instance)
            yield from check(at, members, instance, schema)

        return jsonschema.validators.extend(plain, {"properties": properties})

    def members(self, name):
        """The places of all members of a schema's file, as (place, met)."""
        found, inner = [], [("", self.files[name])]
        while inner:
            place, at = inner.pop(0)
            if isinstance(at, list):
                inner += [(place, part) for part in at]
                continue
            for word, part in at.items() if isinstance(at, dict) else ():
                if word in ("properties", "$defs"):
                    inside = [(f"{place}/{member}".lstrip("/"), words) for member, words in part.items()]
                    found += [(where, id(words) in self.met) for where, words in inside if word == "properties"]
                    inner += inside
                elif isinstance(part, (dict, list)):
                    inner.append((place, part))
        return found

    def constants(self, name):
        """Members of one value, as {"schema": "foilgauge/loop/1", "domain": "scan"}."""
        members = self.files[name].get("properties", {}).items()
        return {member: words["const"] for member, words in members if "const" in words}

    def find(self, document):
        """The schema's file: of those with its name the one that agrees in most constant members; or None."""
        found = [
            (sum(document.get(member) == value for member, value in self.constants(name).items()), name)
            for name in self.files
            if self.constants(name).get("schema") == document["schema"]
            and document.get("domain", "") == self.constants(name).get("domain", document.get("domain", ""))
        ]
        return max(found)[1] if found else None


class Tally:
    def __init__(self, schemas):
        self.schemas = schemas
        self.reducer = Reducer(1 + max_items(list(schemas.files.values())))
        self.documents = collections.Counter()
        self.tests = collections.defaultdict(set)
        self.structures = collections.defaultdict(set)
        self.offences = collections.defaultdict(list)

    def add(self, test, document):
        name = document.get("schema")
        if isinstance(name, str):
            name = self.schemas.find(document) or name
        else:
            name = NO_SCHEMA
        self.documents[name] += 1
        self.tests[name].add(test)
        structure, shorter = self.reducer.reduce(document)
        if structure in self.structures[name]:
            return
        self.structures[name].add(structure)
        if name in self.schemas.files:
            for error in self.schemas.validators[name].iter_errors(shorter):
                self.offend(name, test, error)
        elif name.startswith("foilgauge/") and name not in WITHOUT_SCHEMA:
            self.offences[f"{name} has no file in reports/schema"].append(test)

    def offend(self, name, test, error):
        place = "/".join("*" if isinstance(part, int) else part for part in error.absolute_path)
        self.offences[f"{name}: {place or '(document)'}: {error.message[:300]}"].append(test)

    def table(self):
        print("| schema | documents | tests | members | members met |\n|---|---:|---:|---:|---:|")
        unmet = {}
        for name in sorted(self.documents):
            row = [self.documents[name], len(self.tests[name])]
            if name in self.schemas.files:
                members = self.schemas.members(name)
                unmet[name] = [place for place, met in members if not met]
                row += [len(members), len(members) - len(unmet[name])]
            print(f"| {name} | " + " | ".join([f"{count:,}" for count in row] + ["no schema"] * (4 - len(row))) + " |")
        print("\nMembers that no document has:\n")
        for name, places in unmet.items():
            if places:
                print(f"- {name}: " + ", ".join(f"`{place}`" for place in places))


def main(schema_folder, folder, some=None):
    schemas = Schemas(schema_folder)
    tally = Tally(schemas)
    seen = set()
    for path in sorted(pathlib.Path(folder).glob("*/*.json")):
        if path.name in seen:
            continue
        seen.add(path.name)
        try:
            document = json.loads(
                path.read_bytes(), object_pairs_hook=unique_members, parse_constant=refuse_constant
            )
        except ValueError as error:
            tally.offences[f"not JSON: {error}"].append(path.parent.name)
            continue
        for named in named_objects(document):
            tally.add(path.parent.name, named)
    parts = {name for name in schemas.files if "schema" not in schemas.constants(name)}  # of other documents
    for name in sorted(set(schemas.files) - set(tally.documents) - parts) if some is None else ():
        tally.offences[f"{name}: no test makes such a document"] = []
    for name in sorted(WITHOUT_SCHEMA & {c["schema"] for c in map(schemas.constants, schemas.files) if "schema" in c}):
        tally.offences[f"{name} has a schema now: take it off WITHOUT_SCHEMA"] = []
    tally.table()
    for offence, tests in sorted(tally.offences.items()):
        print(f"{offence} ({len(tests)}: {', '.join(sorted(set(tests))[:5])})", file=sys.stderr)
    return 1 if tally.offences else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]) if jsonschema else 77)
