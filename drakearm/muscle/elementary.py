"""Elementary functions that the compiler can apply to several numbers at once, unlike those of the C library.

They have no branches. The argument is reduced to a small interval (Cody and Waite 1980), where a polynomial, nearly the
minimax one, has a relative error below 2e-17.
"""

import numpy as np

from drakearm.muscle.compiled import fma, inlined

LEAST_EXPONENT, GREATEST_EXPONENT = -708.0, 709.0  # limits of the argument of `exp`
CURVE_EXPONENT = 150.0  # largest exponent in a muscle's curves, where forces are 1e65: their products stay finite

_ROUNDER = 6755399441055744.0  # 1.5 * 2^52: x + _ROUNDER rounds x to an integer, which is in the lowest bits of the sum
_ONE_BITS = 1023 << 52  # 1.0 as an integer
_LOG2_E = 1.4426950408889634
_LN2_HIGH, _LN2_LOW = 0.6931471803691238, 1.9082149292705877e-10
_EXP_EVEN = (2.7620088445409746e-07, 2.4801521295954376e-05, 0.0013888888917213717, 0.04166666666662413, 0.5, 1.0)
_EXP_ODD = (
    2.510038549551032e-08,
    2.7557268459997064e-06,
    0.00019841269863053618,
    0.008333333333330062,
    0.16666666666666669,
    1.0,
)
_TWO_OVER_PI = 0.6366197723675814
_HALF_PI_HIGH, _HALF_PI_MIDDLE, _HALF_PI_LOW = 1.5707963267341256, 6.07710050359346e-11, 2.912732056093356e-20
_SIN = (
    1.591810123027412e-10,
    -2.5051131455427946e-08,
    2.755731610068303e-06,
    -0.0001984126983675497,
    0.008333333333330946,
    -0.16666666666666666,
)
_COS = (
    -1.1382614868556325e-11,
    2.0876146024689747e-09,
    -2.7557317270560326e-07,
    2.4801587298763433e-05,
    -0.0013888888888887395,
    0.041666666666666664,
)


@inlined
def _bits(x):
    return np.float64(x).view(np.int64)


@inlined
def exp(x):
    """Exponential function, accurate to 2 units in the last place. Clamp x to [LEAST_EXPONENT, GREATEST_EXPONENT]."""
    shifted = fma(x, _LOG2_E, _ROUNDER)
    n = shifted - _ROUNDER
    r = fma(n, -_LN2_LOW, fma(n, -_LN2_HIGH, x))
    z = r * r
    even, odd = _EXP_EVEN[0], _EXP_ODD[0]
    for c in _EXP_EVEN[1:]:
        even = fma(even, z, c)
    for c in _EXP_ODD[1:]:
        odd = fma(odd, z, c)
    return fma(r, odd, even) * np.int64((_bits(shifted) << 52) + _ONE_BITS).view(np.float64)  # p(r) 2^n


@inlined
def sincos(x):
    """Sine and cosine, accurate to 2e-16 for |x| up to 1e5."""
    shifted = fma(x, _TWO_OVER_PI, _ROUNDER)
    n = shifted - _ROUNDER
    r = fma(n, -_HALF_PI_LOW, fma(n, -_HALF_PI_MIDDLE, fma(n, -_HALF_PI_HIGH, x)))
    z = r * r
    s, c = _SIN[0], _COS[0]
    for coefficient in _SIN[1:]:
        s = fma(s, z, coefficient)
    for coefficient in _COS[1:]:
        c = fma(c, z, coefficient)
    s, c = fma(r * z, s, r), fma(z * z, c, fma(-0.5, z, 1.0))
    quadrant = _bits(shifted)
    odd = (quadrant & 1) != 0
    sine, cosine = (c if odd else s), (s if odd else c)
    return (-sine if quadrant & 2 else sine), (-cosine if (quadrant + 1) & 2 else cosine)
