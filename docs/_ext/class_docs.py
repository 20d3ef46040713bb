"""How classes look in the reference: short signatures, and the fields of dataclasses as a table.

The comments behind fields in the source are their meanings. Types are as the source writes them, without pydantic's
checks. What a class inherits from Drake is left to Drake's documentation.
"""

import ast
import dataclasses
import inspect
import io
import textwrap
import tokenize
from typing import NamedTuple


class Field(NamedTuple):
    type: str
    meaning: str


def is_record(obj: object) -> bool:
    return isinstance(obj, type) and (dataclasses.is_dataclass(obj) or hasattr(obj, "_fields"))


def declared_fields(cls: type) -> dict[str, Field]:
    """The public fields that a class itself declares."""
    source = textwrap.dedent(inspect.getsource(cls))
    tokens = tokenize.generate_tokens(io.StringIO(source).readline)
    comments = {token.start[0]: token.string.lstrip("# ") for token in tokens if token.type == tokenize.COMMENT}
    return {
        node.target.id: Field(ast.unparse(_without_checks(node.annotation)), comments.get(node.end_lineno, ""))
        for node in ast.parse(source).body[0].body
        if isinstance(node, ast.AnnAssign) and not node.target.id.startswith("_")
    }


def _without_checks(annotation: ast.expr) -> ast.expr:
    """T of each Annotated[T, ...]."""

    class Strip(ast.NodeTransformer):
        def visit_Subscript(self, node):
            node = self.generic_visit(node)
            annotated = isinstance(node.value, ast.Name) and node.value.id == "Annotated"
            return node.slice.elts[0] if annotated else node

    return Strip().visit(annotation)


def add_fields(app, what, name, obj, options, lines):
    if what != "class":
        return
    bases = [base.__name__ for base in obj.__bases__ if base.__module__.startswith("drakearm.")]
    if bases:
        lines += ["", f"Base: {', '.join(f'`{base}`' for base in bases)}."]
    fields = declared_fields(obj) if is_record(obj) else {}
    if fields:
        rows = [("field", "meaning", "type")]
        rows += [(f"``{field}``", meaning, f"``{type}``") for field, (type, meaning) in fields.items()]
        lines += ["", ".. list-table::", "   :header-rows: 1", ""]
        lines += [("     - " if column else "   * - ") + cell for row in rows for column, cell in enumerate(row)]
        lines.append("")


def shorten_signature(app, what, name, obj, options, signature, returns):
    """Names and defaults for dataclasses. The arguments of `_construct` for Systems that exist for several scalars."""
    if what == "class" and is_record(obj):
        parameters = inspect.signature(obj).parameters.values()
        return str(inspect.Signature([one.replace(annotation=one.empty) for one in parameters])), None
    if what == "class" and hasattr(obj, "_construct"):
        parameters = inspect.signature(obj._construct).parameters.values()
        kept = [one for one in parameters if one.name not in ("self", "converter")]
        return str(inspect.Signature(kept)).replace("drakearm.model.arm.", ""), None
    return None


def skip_foreign(app, what, name, obj, skip, options):
    """Members that do not come from drakearm are left out."""
    module = getattr(obj, "__module__", None) or ""
    return True if callable(obj) and not module.startswith("drakearm") else None


def setup(app):
    app.connect("autodoc-process-docstring", add_fields)
    app.connect("autodoc-process-signature", shorten_signature)
    app.connect("autodoc-skip-member", skip_foreign)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
