"""Makes the meshes of arm14: `python docs/make_meshes.py` writes them beside its skeleton.

Each is in the frame of its body: x forward, y up, z to the right. The thumb points forward and the palm to the body.
They are schematic and made for drakearm: no bone was measured or copied.
"""

import argparse
from collections.abc import Callable
from pathlib import Path

import numpy as np
from surfaces import Mesh, ball, blend, plate, rod, surface, together, tube, write_obj

FOLDER = Path(__file__).parents[1] / "drakearm" / "model" / "arm14"


def humerus() -> Mesh:
    shaft = tube(
        [[0, -0.012, 0.004], [-0.001, -0.06, 0.002], [0, -0.14, 0], [0.001, -0.20, -0.004], [0.004, -0.262, -0.011]],
        [0.019, 0.0135, 0.0115, 0.0105, 0.011],
    )
    head = [ball([0, 0, -0.003], 0.0235), ball([0.003, -0.008, 0.016], 0.013), ball([0.018, -0.012, 0.004], 0.008)]
    flare = plate([[0.003, -0.225, -0.006], [0.004, -0.284, 0.012], [0.003, -0.278, -0.034]], 0.011)
    trochlea = tube(
        [[0.0065, -0.2904, -0.031], [0.0061, -0.2904, -0.018], [0.0061, -0.2904, -0.008]], [0.012, 0.0095, 0.0115]
    )
    ends = [
        ball([0.009, -0.2900, 0.006], 0.0115),
        ball([0.002, -0.278, -0.037], 0.007),
        ball([0.003, -0.286, 0.016], 0.008),
    ]
    shape = blend([shaft, *head, flare, trochlea, *ends], 0.008)
    return surface(shape, [-0.04, -0.32, -0.06], [0.045, 0.04, 0.045], [0.0092, 0.0140, 0.0092])


def ulna() -> Mesh:
    shaft = tube(
        [
            [-0.010, -0.012, -0.001],
            [-0.009, -0.05, 0.004],
            [-0.010, -0.12, 0.017],
            [-0.006, -0.19, 0.034],
            [-0.004, -0.232, 0.044],
        ],
        [0.0105, 0.0085, 0.0070, 0.0060, 0.0075],
    )
    olecranon = tube(
        [[-0.0145, -0.016, -0.001], [-0.0175, 0.004, -0.001], [-0.0150, 0.013, -0.001]], [0.009, 0.0085, 0.0075]
    )
    coronoid = tube([[-0.006, -0.020, 0], [0.006, -0.014, 0]], [0.009, 0.006])
    shape = blend([shaft, olecranon, coronoid], 0.006)
    return surface(shape, [-0.04, -0.26, -0.03], [0.03, 0.04, 0.07], [0.0072, 0.0138, 0.0072])


def radius() -> Mesh:
    shaft = tube(
        [[0, -0.010, 0], [0.001, -0.035, 0.001], [0.011, -0.11, 0.010], [0.018, -0.18, 0.019], [0.021, -0.222, 0.024]],
        [0.0075, 0.0075, 0.0078, 0.0085, 0.0115],
    )
    head = tube([[0, 0.0015, 0], [0, -0.004, 0]], [0.0095, 0.0095])
    tuberosity = ball([0.004, -0.036, 0.001], [0.006, 0.011, 0.006])
    end = ball([0.023, -0.226, 0.024], [0.019, 0.011, 0.0115])
    shape = blend([shaft, head, tuberosity, end], 0.006)
    return surface(shape, [-0.03, -0.26, -0.03], [0.06, 0.03, 0.055], [0.0074, 0.0142, 0.0068])


def hand() -> Mesh:
    carpus = ball([-0.004, -0.004, -0.001], [0.025, 0.020, 0.0135])
    palm = [
        tube([[0.012, -0.010, 0], [0.026, -0.082, 0.001]], [0.0115, 0.0125]),
        tube([[0.004, -0.010, 0], [0.006, -0.086, 0.002]], [0.0115, 0.0130]),
        tube([[-0.006, -0.010, 0], [-0.0135, -0.082, 0.001]], [0.0115, 0.0120]),
        tube([[-0.016, -0.010, 0], [-0.032, -0.075, -0.001]], [0.0110, 0.0110]),
        ball([0.014, -0.046, -0.009], [0.018, 0.028, 0.013]),
        ball([-0.022, -0.042, -0.008], [0.013, 0.028, 0.011]),
    ]
    thumb = tube([[0.010, -0.014, -0.005], [0.030, -0.036, -0.013], [0.046, -0.060, -0.019]], [0.010, 0.013, 0.0115])
    shape = blend([carpus, *palm, thumb], 0.014)
    digits = [
        _finger([0.0255, -0.076, 0.001], 0.20, [0.050, 0.025, 0.019], 0.0090),
        _finger([0.0068, -0.080, 0.002], 0.04, [0.056, 0.029, 0.020], 0.0092),
        _finger([-0.0128, -0.076, 0.001], -0.13, [0.052, 0.027, 0.020], 0.0088),
        _finger([-0.0300, -0.069, -0.001], -0.32, [0.041, 0.020, 0.018], 0.0079),
        rod(
            [[0.040, -0.050, -0.017], [0.049, -0.064, -0.020], [0.057, -0.085, -0.025], [0.060, -0.103, -0.029]],
            [0.0105, 0.0104, 0.0100, 0.0080],
            6,
            8,
        ),
    ]
    box = [-0.075, -0.13, -0.05], [0.08, 0.035, 0.035]
    return together([surface(shape, *box, [0.0095, 0.0110, 0.0085]), *digits])


def _finger(knuckle: list[float], spread: float, bones: list[float], radius: float) -> Mesh:
    """A finger, slightly bent. spread: rad, of its direction in the plane of the palm. bones: m, their lengths."""
    points, bend = [np.array(knuckle)], 0.16
    for bone in bones:
        along = np.array([np.sin(spread) * np.cos(bend), -np.cos(spread) * np.cos(bend), -np.sin(bend)])
        points.append(points[-1] + bone * along)
        bend += 0.34
    return rod(points, [radius, 0.97 * radius, 0.90 * radius, 0.76 * radius], 8, 8)


def scapula() -> Mesh:
    """With the clavicle."""
    body = plate([[-0.060, 0.000, 0.135], [-0.112, 0.022, 0.078], [-0.118, -0.125, 0.092]], 0.012)
    glenoid = ball([-0.047, -0.005, 0.144], [0.010, 0.019, 0.010])
    crest = rod(
        [[-0.116, -0.010, 0.084], [-0.100, 0.014, 0.118], [-0.070, 0.034, 0.156], [-0.034, 0.037, 0.176]],
        [0.004, 0.0065, 0.0085, 0.0095],
        9,
        7,
    )
    coracoid = rod(
        [[-0.055, 0.008, 0.136], [-0.034, 0.020, 0.128], [-0.008, 0.006, 0.131], [0.002, -0.010, 0.134]],
        [0.009, 0.0075, 0.0065, 0.006],
        7,
        7,
    )
    clavicle = rod(
        [[-0.002, 0.004, 0.020], [0.012, 0.017, 0.058], [-0.006, 0.032, 0.108], [-0.026, 0.038, 0.160]],
        [0.0105, 0.0066, 0.0062, 0.0080],
        11,
        8,
    )
    shape = blend([body, glenoid], 0.012)
    flat = surface(shape, [-0.15, -0.15, 0.04], [0.0, 0.06, 0.18], [0.0105, 0.0125, 0.0105])
    return together([flat, crest, coracoid, clavicle])


def thorax() -> Mesh:
    """Ribs, sternum and spine."""
    sternum = [[0.001, 0.000, 0], [0.008, -0.030, 0], [0.016, -0.070, 0], [0.023, -0.120, 0], [0.027, -0.170, 0]]
    spine = [[-0.060, 0.16, 0], [-0.066, 0.08, 0], [-0.088, 0.0, 0], [-0.114, -0.07, 0], [-0.126, -0.14, 0]]
    spine += [[-0.120, -0.22, 0], [-0.098, -0.30, 0], [-0.088, -0.36, 0]]
    parts = [
        rod(sternum, [0.009, 0.011, 0.008, 0.009, 0.006], 7, 6, 1.8),
        rod(spine, np.linspace(0.011, 0.019, len(spine)), 10, 6),
    ]
    for level in np.linspace(0.0, 1.0, 8):
        right = _rib(level)
        parts += [rod(right * [1, 1, side], [0.0045] * len(right), 9, 4) for side in (1, -1)]
    return together(parts)


def _rib(level: float) -> np.ndarray:
    """Points of a right rib: level 0 is the first one. It runs from the spine around to the sternum, and downwards."""
    turn = np.linspace(0.04, 1.0, 10)
    x = -0.088 - 0.040 * np.sin(2.1 * level)
    back = np.array([x, 0.012 - 0.225 * level])
    at = min(level / 0.75, 1.0)
    front = np.array([0.003 + 0.022 * at, -0.014 - 0.145 * at])
    width, middle, half = 0.060 + 0.072 * np.sin(1.6 * level), 0.5 * (back + front), 0.5 * (front - back)
    low = max(level - 0.75, 0.0)  # the lowest ribs do not reach the sternum
    angle = np.pi * turn * (1.0 - 0.55 * low)
    return np.stack(
        [
            middle[0] - (half[0] + 0.004) * np.cos(angle),
            back[1] + (front[1] - back[1]) * turn**1.3 - 0.035 * np.sin(angle) - 0.05 * low * turn,
            width * np.sin(angle) ** 0.8,
        ],
        axis=1,
    )


def head() -> Mesh:
    """With the neck."""
    shape = blend(
        [
            ball([-0.040, 0.215, 0], [0.098, 0.088, 0.074]),
            ball([-0.008, 0.165, 0], [0.062, 0.072, 0.058]),
            tube([[0.020, 0.115, 0], [-0.020, 0.125, 0.03]], [0.026, 0.026]),
            tube([[0.020, 0.115, 0], [-0.020, 0.125, -0.03]], [0.026, 0.026]),
            ball([0.056, 0.174, 0], [0.024, 0.024, 0.014]),
            tube([[-0.058, 0.16, 0], [-0.060, 0.085, 0], [-0.058, 0.030, 0]], [0.052, 0.050, 0.058]),
        ],
        0.03,
    )
    return surface(shape, [-0.20, -0.06, -0.15], [0.13, 0.36, 0.15], [0.023, 0.024, 0.022])


def upper_arm_skin() -> Mesh:
    shape = tube(
        [
            [-0.004, -0.005, 0.006],
            [-0.004, -0.06, 0.006],
            [-0.004, -0.13, 0.0],
            [-0.001, -0.21, -0.006],
            [0.004, -0.285, -0.012],
        ],
        [0.044, 0.047, 0.045, 0.040, 0.036],
        [1.1, 1, 0.95],
    )
    return surface(shape, [-0.09, -0.37, -0.08], [0.08, 0.09, 0.08], [0.0209, 0.033, 0.0209])


def forearm_skin() -> Mesh:
    shape = tube(
        [
            [-0.002, 0.0, 0.004],
            [0.003, -0.05, 0.014],
            [0.006, -0.11, 0.024],
            [0.012, -0.18, 0.035],
            [0.018, -0.245, 0.044],
        ],
        [0.036, 0.040, 0.037, 0.030, 0.0235],
        [1.1, 1, 0.95],
    )
    return surface(shape, [-0.08, -0.31, -0.06], [0.08, 0.07, 0.11], [0.0189, 0.034, 0.0189])


MESHES: list[Callable[[], Mesh]] = [humerus, ulna, radius, hand, scapula, thorax, head, upper_arm_skin, forearm_skin]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", nargs="?", type=Path, default=FOLDER)
    folder = parser.parse_args().folder
    print("| mesh | vertices | faces | size (kB) |")
    print("|---|---|---|---|")
    for make in MESHES:
        file = folder / f"{make.__name__}.obj"
        mesh = make()
        write_obj(file, mesh)
        print(f"| {file.name} | {len(mesh.vertices)} | {len(mesh.faces)} | {file.stat().st_size / 1000:.0f} |")


if __name__ == "__main__":
    main()
