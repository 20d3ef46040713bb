"""Registers drakearm's environment with Gymnasium, as soon as a program imports Gymnasium.

Gymnasium takes 0.1 s to import. `drakearm list` and programs that only simulate an arm do not need it.
"""

import sys
from importlib.machinery import ModuleSpec
from types import ModuleType
from typing import Any

ID = "drakearm/Track-v0"


def register_with_gymnasium() -> None:
    """Registers now if Gymnasium is imported already, else when it is."""
    if "gymnasium" in sys.modules:
        _register()
    else:
        sys.meta_path.insert(0, _GymnasiumFinder())


def _register() -> None:
    from gymnasium.envs.registration import register

    register(
        id=ID,
        entry_point="drakearm.experiments.environments:make_env",
        vector_entry_point="drakearm.experiments.environments:make_vector_env",
    )


class _GymnasiumFinder:
    """A finder in `sys.meta_path`: lets the other finders find Gymnasium, and registers after Gymnasium is imported.

    It does not derive from importlib.abc.MetaPathFinder, because that takes 8 ms to import.
    """

    def find_spec(self, fullname: str, path: Any, target: ModuleType | None = None) -> ModuleSpec | None:
        if fullname != "gymnasium":
            return None
        from importlib.util import find_spec

        sys.meta_path.remove(self)
        spec = find_spec(fullname)
        if spec is not None and spec.loader is not None:
            execute = spec.loader.exec_module

            def execute_and_register(module: ModuleType) -> None:
                execute(module)
                _register()

            spec.loader.exec_module = execute_and_register  # type: ignore[method-assign]
        return spec
