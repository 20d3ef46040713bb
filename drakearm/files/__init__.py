"""Files: read with limits and checked against a schema, written whole or not at all."""

from drakearm.files.kinds import Kind
from drakearm.files.reading import parse_json, read_json, read_text, read_yaml
from drakearm.files.writing import replacement

__all__ = ["Kind", "parse_json", "read_json", "read_text", "read_yaml", "replacement"]
