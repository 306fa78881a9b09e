# SPDX-License-Identifier: GPL-3.0-or-later
"""validate_schema.py SCHEMA_FOLDER SCHEMA FILE...: exit 0 valid, 1 not, 77 no python3-jsonschema."""

import json
import pathlib
import sys

try:
    import jsonschema
except ImportError:
    jsonschema = None

try:
    from referencing import Registry
    from referencing.jsonschema import DRAFT202012
except ImportError:
    Registry = None


def validator(schemas, name, kind=None):
    """A validator that finds the schemas of the folder by their $id; `kind`: its class."""
    kind = kind or jsonschema.Draft202012Validator
    schema = schemas[name]
    if Registry:
        registry = Registry().with_resources(
            (key, DRAFT202012.create_resource(value)) for key, value in schemas.items()
        )
        return kind(schema, registry=registry)
    resolver = jsonschema.RefResolver("", schema, store=schemas)  # jsonschema before 4.18
    return kind(schema, resolver=resolver)


def main(folder, name, *files):
    schemas = {}
    for path in pathlib.Path(folder).glob("*.schema.json"):
        schemas[path.name] = json.loads(path.read_text(encoding="utf-8"))
        jsonschema.Draft202012Validator.check_schema(schemas[path.name])
    failed = False
    for file in files:
        report = json.loads(pathlib.Path(file).read_text(encoding="utf-8"))
        for error in validator(schemas, name).iter_errors(report):
            failed = True
            place = "/".join(map(str, error.absolute_path))
            print(f"{file}: {place}: {error.message[:300]} ({folder}/{name})")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]) if jsonschema else 77)
