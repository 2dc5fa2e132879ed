"""Compiled force balance: the body velocity at which ground forces and torque add up to zero.

Newton's method on the three residuals. Laws that depend on the direction of slip only are smoothed
by epsilon, |v| -> sqrt(v^2 + epsilon^2): a first attempt takes the last epsilon at once from the
caller's guess, which nearly always works along a path; where it does not (a foot that sticks, a
bad guess), epsilon is lowered in steps from one at which the law is nearly linear.
Own derivation. Inside, all quantities are in units of the body's size and mean shape speed. One
file, because the compile cache looks at the file of the outermost function only.
"""

from __future__ import annotations

from math import cos, sin, sqrt

import numpy as np
from numba import njit
from numpy.typing import NDArray

from omega_turn_ros.mechanics.force_laws import COULOMB, ELLIPTIC, LINEAR

Array = NDArray[np.float64]

# Sums may be reordered, which lets the compiler use vector instructions; NaN is still NaN.
FAST = {'reassoc', 'nsz', 'contract', 'arcp'}

LAST_EPSILON = 1e-8  # error of a velocity where a foot sticks; else its square
STEP_TOLERANCE = 1e-10  # Newton's last step; the error left is about its square
ROUNDING = 1e-7  # residual left where a foot sticks: rounding of its slip over epsilon
ATTEMPT = (8, 2)  # Newton steps, trials per step
STAGE = (60, 25)
FIRST_EPSILON, REDUCTION = 0.3, 0.1
# workspace: 0..2 residual, 3..11 its derivative by rows


@njit(cache=True, nogil=True, fastmath=FAST, error_model='numpy')
def _coulomb_sums(px, py, vx, vy, w, xi, epsilon, out):  # type: ignore[no-untyped-def]
    """Residual and Jacobian for isotropic friction, in the axes of the body."""
    a, b, c, e2 = xi[0], xi[1], xi[2], epsilon * epsilon
    g0 = g1 = g2 = h00 = h01 = h11 = h02 = h12 = h22 = 0.0
    for j in range(px.size):
        x, y = px[j], py[j]
        sx, sy = vx[j] + a - c * y, vy[j] + b + c * x
        inverse = 1.0 / sqrt(sx * sx + sy * sy + e2)
        ux, uy = sx * inverse, sy * inverse
        k = w[j] * inverse
        lever = x * uy - y * ux
        g0 += w[j] * ux
        g1 += w[j] * uy
        g2 += w[j] * lever
        h00 += k * (1.0 - ux * ux)
        h01 -= k * ux * uy
        h11 += k * (1.0 - uy * uy)
        h02 -= k * (y + ux * lever)
        h12 += k * (x - uy * lever)
        h22 += k * (x * x + y * y - lever * lever)
    out[0], out[1], out[2] = g0, g1, g2
    out[3], out[4], out[5] = h00, h01, h02
    out[6], out[7], out[8] = h01, h11, h12
    out[9], out[10], out[11] = h02, h12, h22


@njit(cache=True, nogil=True, fastmath=FAST, error_model='numpy', inline='always')
def _resist(kind, law, vt, vn, e2):  # type: ignore[no-untyped-def]
    """Resistance (minus the force) in link axes and its derivatives: rt, rn, tt, tn, nt, nn."""
    if kind == LINEAR:
        return vt, law[0] * vn, 1.0, 0.0, 0.0, law[0]
    if kind == ELLIPTIC:
        c2 = law[0] * law[0]
        inverse = 1.0 / sqrt(vt * vt + c2 * vn * vn + e2)
        ut, un = vt * inverse, vn * inverse
        mixed = -c2 * ut * un * inverse
        across = c2 * inverse * (1.0 - c2 * un * un)
        return ut, c2 * un, inverse * (1.0 - ut * ut), mixed, mixed, across
    # Smoothed in size only: bent inside the circle, the law would fold and stick twice.
    slip = sqrt(vt * vt + vn * vn + 1e-60)
    inverse = 1.0 / sqrt(slip * slip + e2)
    ut, un, share = vt / slip, vn / slip, slip * inverse
    bend = 1.0 / (1.0 + abs(un))
    root = 1.0 / sqrt(1.0 + law[3] * law[3] * un * un)
    rt = law[0] * ut + law[1] * ut * abs(ut) * bend
    rn = law[0] * un + law[2] * law[3] * un * root
    # by the direction first, then the direction by the velocity
    a = law[0] + 2.0 * law[1] * abs(ut) * bend
    b = -law[1] * ut * abs(ut) * bend * bend * (1.0 if un >= 0.0 else -1.0)
    d = law[0] + law[2] * law[3] * root * root * root
    tt, mixed, nn = inverse * un * un, -inverse * ut * un, inverse * ut * ut
    grow = e2 * inverse * inverse * inverse
    return (
        share * rt,
        share * rn,
        a * tt + b * mixed + grow * rt * ut,
        a * mixed + b * nn + grow * rt * un,
        d * mixed + grow * rn * ut,
        d * nn + grow * rn * un,
    )


@njit(cache=True, nogil=True, fastmath=FAST, error_model='numpy')
def _law_sums(kind, law, px, py, vx, vy, tx, ty, w, xi, epsilon, out):  # type: ignore[no-untyped-def]
    """Residual and Jacobian for a law in link axes."""
    a, b, c, e2 = xi[0], xi[1], xi[2], epsilon * epsilon
    g0 = g1 = g2 = h00 = h01 = h02 = h10 = h11 = h12 = h20 = h21 = h22 = 0.0
    for j in range(px.size):
        x, y, cosine, sine = px[j], py[j], tx[j], ty[j]
        sx, sy = vx[j] + a - c * y, vy[j] + b + c * x
        rt, rn, tt, tn, nt, nn = _resist(
            kind, law, cosine * sx + sine * sy, cosine * sy - sine * sx, e2
        )
        lt, ln = x * sine - y * cosine, x * cosine + y * sine  # levers of the link axes
        g0 += w[j] * (cosine * rt - sine * rn)
        g1 += w[j] * (sine * rt + cosine * rn)
        g2 += w[j] * (lt * rt + ln * rn)
        # rows of d(rt, rn)/d(xi)
        t0, t1, t2 = tt * cosine - tn * sine, tt * sine + tn * cosine, tt * lt + tn * ln
        n0, n1, n2 = nt * cosine - nn * sine, nt * sine + nn * cosine, nt * lt + nn * ln
        h00 += w[j] * (cosine * t0 - sine * n0)
        h01 += w[j] * (cosine * t1 - sine * n1)
        h02 += w[j] * (cosine * t2 - sine * n2)
        h10 += w[j] * (sine * t0 + cosine * n0)
        h11 += w[j] * (sine * t1 + cosine * n1)
        h12 += w[j] * (sine * t2 + cosine * n2)
        h20 += w[j] * (lt * t0 + ln * n0)
        h21 += w[j] * (lt * t1 + ln * n1)
        h22 += w[j] * (lt * t2 + ln * n2)
    out[0], out[1], out[2] = g0, g1, g2
    out[3], out[4], out[5] = h00, h01, h02
    out[6], out[7], out[8] = h10, h11, h12
    out[9], out[10], out[11] = h20, h21, h22


@njit(cache=True, nogil=True, error_model='numpy')
def _newton(kind, law, p, w, xi, epsilon, steps, halvings, out, trial):  # type: ignore[no-untyped-def]
    """Damped Newton at one epsilon, in place; True once a full step is below the tolerance."""
    _sums(kind, law, p, w, xi, epsilon, out)
    norm = out[0] ** 2 + out[1] ** 2 + out[2] ** 2
    for _ in range(steps):
        if norm == 0.0:
            return True
        d0, d1, d2 = _solve(out)
        factor, after = 1.0, np.inf
        for _ in range(halvings):
            trial[0], trial[1] = xi[0] + factor * d0, xi[1] + factor * d1
            trial[2] = xi[2] + factor * d2
            _sums(kind, law, p, w, trial, epsilon, out)
            after = out[0] ** 2 + out[1] ** 2 + out[2] ** 2
            if after < (1.0 - 0.1 * factor) * norm:
                break
            factor *= 0.5
        if not after < norm:  # only rounding is left to win, or the guess was bad
            return norm < ROUNDING**2
        norm = after
        xi[:] = trial
        if max(abs(d0), abs(d1), abs(d2)) < STEP_TOLERANCE:
            return True
    return norm < ROUNDING**2


@njit(cache=True, nogil=True, error_model='numpy', inline='always')
def _sums(kind, law, p, w, xi, epsilon, out):  # type: ignore[no-untyped-def]
    if kind == COULOMB:
        _coulomb_sums(p[0], p[1], p[2], p[3], w, xi, epsilon, out)
    else:
        _law_sums(kind, law, p[0], p[1], p[2], p[3], p[4], p[5], w, xi, epsilon, out)


@njit(cache=True, nogil=True, error_model='numpy', inline='always')
def _solve(s):  # type: ignore[no-untyped-def]
    """Newton step -J^-1 r by cofactors."""
    c0 = s[7] * s[11] - s[8] * s[10]
    c1 = s[8] * s[9] - s[6] * s[11]
    c2 = s[6] * s[10] - s[7] * s[9]
    inverse = -1.0 / (s[3] * c0 + s[4] * c1 + s[5] * c2)
    d0 = c0 * s[0] + (s[5] * s[10] - s[4] * s[11]) * s[1] + (s[4] * s[8] - s[5] * s[7]) * s[2]
    d1 = c1 * s[0] + (s[3] * s[11] - s[5] * s[9]) * s[1] + (s[5] * s[6] - s[3] * s[8]) * s[2]
    d2 = c2 * s[0] + (s[4] * s[9] - s[3] * s[10]) * s[1] + (s[3] * s[7] - s[4] * s[6]) * s[2]
    return d0 * inverse, d1 * inverse, d2 * inverse


@njit(cache=True, nogil=True, error_model='numpy')
def balance(kind, law, p, w, xi, out, trial):  # type: ignore[no-untyped-def]
    """Find the balancing body velocity of one shape, in place from the guess `xi`.

    Args:
        kind: of the force law.
        law: its parameters, shape (4,).
        p: rows x, y, velocity x, y at xi = 0, link axis x, y of the points, shape (6, P).
        w: loads of the points, sum 1, shape (P,).
        xi: guess in, solution out, shape (3,).
        out: workspace, shape (12,).
        trial: workspace, shape (3,).

    Returns:
        Whether it converged.
    """
    if kind == LINEAR:
        return _newton(kind, law, p, w, xi, 0.0, 3, 1, out, trial)
    if _newton(kind, law, p, w, xi, LAST_EPSILON, *ATTEMPT, out, trial):
        return True
    best, before = np.zeros(3), np.zeros(3)
    xi[:] = 0.0
    epsilon = FIRST_EPSILON
    while epsilon > LAST_EPSILON:
        done = _newton(kind, law, p, w, xi, epsilon, *STAGE, out, trial)
        best[:] = xi
        if done and _newton(kind, law, p, w, xi, LAST_EPSILON, *ATTEMPT, out, trial):
            return True
        # A foot that sticks slips in proportion to epsilon: the next guess goes on in line.
        if epsilon < FIRST_EPSILON:
            xi[:] = best + REDUCTION * (best - before)
        else:
            xi[:] = best
        before[:] = best
        epsilon *= REDUCTION
    return _newton(kind, law, p, w, xi, LAST_EPSILON, *STAGE, out, trial)


@njit(cache=True, nogil=True, error_model='numpy')
def place_links(lengths, fractions, angles, rates, links):  # type: ignore[no-untyped-def]
    """Kinematics of one shape in the mean body frame.

    Args:
        lengths: of the links [m], shape (L,).
        fractions: their shares of the body length, shape (L,).
        angles: joint angles [rad], shape (L - 1,).
        rates: joint rates [rad/s], shape (L - 1,).
        links: result; rows centre x, y, its velocity x, y, axis x, y, turning rate; shape (7, L).
    """
    n = lengths.size
    angle = rate = mean_angle = mean_rate = 0.0
    for i in range(n):
        if i > 0:
            angle += angles[i - 1]
            rate += rates[i - 1]
        links[4, i], links[6, i] = angle, rate
        mean_angle += fractions[i] * angle
        mean_rate += fractions[i] * rate
    x = y = vx = vy = mx = my = mvx = mvy = 0.0
    for i in range(n):
        c, s = cos(links[4, i] - mean_angle), sin(links[4, i] - mean_angle)
        turn = links[6, i] - mean_rate
        hx, hy = 0.5 * lengths[i] * c, 0.5 * lengths[i] * s
        links[0, i], links[1, i] = x - hx, y - hy
        links[2, i], links[3, i] = vx + turn * hy, vy - turn * hx
        x, y, vx, vy = x - 2.0 * hx, y - 2.0 * hy, vx + 2.0 * turn * hy, vy - 2.0 * turn * hx
        links[4, i], links[5, i], links[6, i] = c, s, turn
        mx += fractions[i] * links[0, i]
        my += fractions[i] * links[1, i]
        mvx += fractions[i] * links[2, i]
        mvy += fractions[i] * links[3, i]
    for i in range(n):
        links[0, i] -= mx
        links[1, i] -= my
        links[2, i] -= mvx
        links[3, i] -= mvy


@njit(cache=True, nogil=True, error_model='numpy')
def _place_points(links, link, along, across, size, p):  # type: ignore[no-untyped-def]
    """Fill rows x, y (per size), velocity x, y (per mean speed), axis x, y; return that speed."""
    speed = 0.0
    for j in range(link.size):
        i = link[j]
        c, s, turn = links[4, i], links[5, i], links[6, i]
        x, y = along[j] * c - across[j] * s, along[j] * s + across[j] * c
        p[0, j], p[1, j] = (links[0, i] + x) / size, (links[1, i] + y) / size
        p[2, j], p[3, j] = links[2, i] - turn * y, links[3, i] + turn * x
        p[4, j], p[5, j] = c, s
        speed += abs(p[2, j]) + abs(p[3, j])
    speed /= link.size
    if speed > 0.0:
        for j in range(link.size):
            p[2, j] /= speed
            p[3, j] /= speed
    return speed


@njit(cache=True, nogil=True, error_model='numpy')
def velocities(kind, law, lengths, link, along, across, w, angles, rates):  # type: ignore[no-untyped-def]
    """Body velocity of every shape, each started from the one before.

    Args:
        kind: of the force law.
        law: its parameters, shape (4,).
        lengths: of the links [m], shape (L,).
        link: index of each contact point's link, shape (P,).
        along: place of each point along its link from the centre [m], shape (P,).
        across: and to its left [m], shape (P,).
        w: loads, sum 1, shape (P,).
        angles: joint angles [rad], shape (B, N).
        rates: joint rates [rad/s], shape (B, N).

    Returns:
        xi [m/s, m/s, rad/s], shape (B, 3), and the number of shapes that did not converge.
    """
    size = lengths.sum() / 2.0
    fractions = lengths / lengths.sum()
    links, p = np.empty((7, lengths.size)), np.empty((6, link.size))
    out, trial, xi = np.empty(12), np.empty(3), np.zeros(3)
    result = np.zeros((angles.shape[0], 3))
    failed = 0
    for b in range(angles.shape[0]):
        place_links(lengths, fractions, angles[b], rates[b], links)
        speed = _place_points(links, link, along, across, size, p)
        if not speed > 0.0:
            continue
        if not balance(kind, law, p, w, xi, out, trial):
            failed += 1
            xi[:] = 0.0
        result[b, 0], result[b, 1] = xi[0] * speed, xi[1] * speed
        result[b, 2] = xi[2] * speed / size
    return result, failed
