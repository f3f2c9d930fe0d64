#!/usr/bin/env python3
"""Does the schema of swarm files accept and refuse what the reader does? Usage: swarm_schema.py SCHEMA TABLE"""

import json
import sys

try:
    from jsonschema import Draft202012Validator
except ImportError:
    print("skipped: python3-jsonschema is not installed")
    sys.exit(77)


def main() -> int:
    with open(sys.argv[1]) as schema_file, open(sys.argv[2]) as table_file:
        schema, table = json.load(schema_file), json.load(table_file)
    Draft202012Validator.check_schema(schema)
    validator = Draft202012Validator(schema)
    failures = 0
    for kind, wanted in (("good", True), ("bad", False)):
        for name, file in table[kind].items():
            if validator.is_valid(file) != wanted:
                failures += 1
                print(f"{kind}: {name}: the schema {'refuses' if wanted else 'accepts'} it")
                for error in validator.iter_errors(file):
                    print("   ", error.json_path, error.message[:200])
    print(f"{len(table['good'])} good and {len(table['bad'])} bad files, {failures} failures")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
