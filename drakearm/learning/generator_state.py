"""The state of a generator of random numbers as an array, for checkpoints."""

import numpy as np


def generator_state(generator: np.random.Generator) -> np.ndarray:
    """The state (6,), uint64, of a generator of the kind that `numpy.random.default_rng` makes (PCG64)."""
    state = generator.bit_generator.state
    low = 2**64
    numbers = (state["state"]["state"], state["state"]["inc"])
    return np.array(
        [*(part for n in numbers for part in divmod(n, low)), state["has_uint32"], state["uinteger"]], np.uint64
    )


def restored_generator(state: np.ndarray) -> np.random.Generator:
    """The generator with a state of `generator_state`."""
    high_state, low_state, high_inc, low_inc, has_uint32, uinteger = (int(number) for number in state)
    generator = np.random.default_rng()
    generator.bit_generator.state = {
        "bit_generator": "PCG64",
        "state": {"state": (high_state << 64) + low_state, "inc": (high_inc << 64) + low_inc},
        "has_uint32": has_uint32,
        "uinteger": uinteger,
    }
    return generator
