"""Mutations of texts, trees and XML: from a valid file to one that is probably not valid.

A mutation takes a random generator and the file's bytes, and returns other bytes. The same generator gives the same
bytes.
"""

import copy
import json
import re
from collections.abc import Callable
from random import Random
from typing import Any

import yaml

from tests.attacks.nasty import BYTES, RAW_JSON, RAW_YAML, TEXTS, VALUES, XML_BOMB, XML_PIECES, XML_VALUES

Mutation = Callable[[Random, bytes], bytes]

_RAW = "raw-{}-raw"  # stands in a dumped tree for text that no dump would write


def mutate_bytes(random: Random, data: bytes) -> bytes:
    """Cuts, flips, inserts, repeats and removes bytes, or replaces them all."""
    data = bytearray(data)
    for _ in range(random.choice((1, 1, 1, 2, 8))):
        at = random.randrange(len(data) + 1)
        length = random.choice((1, 1, 4, 30, 300))
        match random.randrange(8):
            case 0:
                del data[at:]
            case 1:
                for i in range(at, min(at + length, len(data))):
                    data[i] ^= 1 << random.randrange(8)
            case 2:
                data[at:at] = random.choice(BYTES) * random.choice((1, 1, 50))
            case 3:
                data[at:at] = data[at : at + length] * random.choice((1, 5, 100))
            case 4:
                del data[at : at + length]
            case 5:
                data[at : at + length] = random.randbytes(length)
            case 6:
                other = random.randrange(len(data) + 1)
                piece = data[at : at + length]
                data[other : other + len(piece)] = piece
            case 7 if random.random() < 0.3:
                data = bytearray(random.choice(TEXTS).encode() if random.random() < 0.8 else random.randbytes(400))
    return bytes(data)


def mutate_yaml(random: Random, data: bytes) -> bytes:
    """Mutates the bytes of a YAML file, or what it holds."""
    return _mutate_text(random, data, yaml.safe_load, _dump_yaml, RAW_YAML)


def mutate_json(random: Random, data: bytes) -> bytes:
    """Mutates the bytes of a JSON file, or what it holds."""
    return _mutate_text(random, data, json.loads, json.dumps, RAW_JSON)


def mutate_xml(random: Random, data: bytes) -> bytes:
    """Mutates the bytes of an XML file, or its attributes and elements."""
    text = data.decode()
    if random.random() < 0.2:
        return mutate_bytes(random, data)
    for _ in range(random.choice((1, 1, 2, 4))):
        attributes = list(re.finditer(r'([\w:]+)="([^"]*)"', text))
        elements = list(re.finditer(r"<(/?)([\w:]+)[^>]*>", text))
        if not attributes or not elements:
            break
        attribute, element, other = random.choice(attributes), random.choice(elements), random.choice(elements)
        match random.randrange(8):
            case 0 | 1 | 2:
                value = random.choice((*XML_VALUES, *(v.group(2) for v in attributes)))
                text = text[: attribute.start(2)] + value + text[attribute.end(2) :]
            case 3:
                text = text[: attribute.start()] + text[attribute.end() :]
            case 4:
                text = text[: element.start()] + text[element.end() :]
            case 5:
                text = text[: element.end()] + random.choice(XML_PIECES) + text[element.end() :]
            case 6:
                text = text[: element.start(2)] + other.group(2) + text[element.end(2) :]
            case 7:
                start, end = sorted((element.start(), other.start()))
                text = text[:end] + text[start:end] + text[end:]
    if random.random() < 0.02:
        text = text.replace("<robot", XML_BOMB + "<robot", 1).replace("limb", "&i;")
    return text.encode("utf-8", "surrogatepass")


def mutate_tree(random: Random, tree: Any, raw: list[str] = ()) -> Any:
    """Replaces, removes, adds, repeats and swaps values in a tree of lists and dictionaries.

    raw: texts that may take a value's place; they are written as they are, see `fill_raw`.
    """
    tree = copy.deepcopy(tree)
    gentle = random.random() < 0.3  # changes only numbers, by less than a factor of 10
    for _ in range(random.choice((1, 1, 1, 2, 5))):
        places = list(_places(tree))
        if not places:
            return random.choice(VALUES)
        parent, key = random.choice(places)
        if gentle:
            parent, key = random.choice([(p, k) for p, k in places if isinstance(p[k], int | float)] or places)
            if isinstance(parent[key], float):
                parent[key] *= random.choice((-1.0, 0.0, 0.1, 0.5, 0.9, 1.0001, 2.0, 9.0))
            elif isinstance(parent[key], int):
                parent[key] += random.choice((-10, -1, 1, 2, 30))
            continue
        match random.randrange(10):
            case 0 | 1 | 2:
                parent[key] = copy.deepcopy(random.choice(VALUES))
            case 3 if raw:
                parent[key] = _RAW.format(random.randrange(len(raw)))
            case 3 | 4 if isinstance(parent[key], int | float):
                parent[key] = random.choice(
                    (-parent[key], parent[key] * 10.0 ** random.randint(-12, 12), True, [parent[key]])
                )
            case 5:
                del parent[key]
            case 6 if isinstance(parent, dict):
                parent[random.choice(("x", "", "type", "name", "a" * 200, "<<", "weight"))] = random.choice(VALUES)
            case 6 | 7 if isinstance(parent, list):
                parent[key:key] = [copy.deepcopy(parent[key])] * random.choice((1, 1, 2, 300))
            case 8:
                other, place = random.choice(places)
                parent[key] = copy.deepcopy(other[place]) if random.random() < 0.5 else {str(place)[:40]: parent[key]}
            case 9:
                for _ in range(random.choice((1, 3, 30, 60))):
                    parent[key] = [parent[key]]
    return tree


def _places(tree: Any) -> Any:
    """All places in a tree: the list or dictionary, and the index or key."""
    items = tree.items() if isinstance(tree, dict) else enumerate(tree) if isinstance(tree, list) else ()
    for key, value in list(items):
        yield tree, key
        yield from _places(value)


def fill_raw(text: str, raw: list[str]) -> str:
    """A dumped tree in which the raw texts have taken their places."""
    return re.sub(r"['\"]?raw-(\d+)-raw['\"]?", lambda match: raw[int(match[1])], text)


def _dump_yaml(tree: Any) -> str:
    return yaml.safe_dump(tree, sort_keys=False, default_flow_style=True, width=10**6, allow_unicode=True)


def _mutate_text(random: Random, data: bytes, load: Callable, dump: Callable, raw: list[str]) -> bytes:
    if random.random() < 0.25:
        return mutate_bytes(random, data)
    text = fill_raw(dump(mutate_tree(random, load(data.decode()), raw)), raw)
    if random.random() < 0.02:
        text = text.ljust(random.choice((400_000, 600_000, 6_000_000)), " ")
    return text.encode("utf-8", "surrogatepass")
