"""Compiled force balance: the body velocity at which ground forces and torque add up to zero.

Newton's method on the three residuals. Laws that depend on the direction of slip only are smoothed
by epsilon, |v| -> sqrt(v^2 + epsilon^2). From a good guess the last epsilon works at once, unless
a contact point sticks; then the body pivots on it, which leaves one unknown. Where neither works
epsilon is lowered in steps from one at which the law is nearly linear. Own derivation.
Inside, all quantities are in units of the body's size and mean shape speed. One file, because the
compile cache looks at the file of the outermost function only.
"""

from __future__ import annotations

from math import cos, hypot, pi, sin, sqrt

import numpy as np
from numba import njit
from numpy.typing import NDArray

from omega_turn_ros.mechanics.force_laws import COULOMB, ELLIPTIC, LINEAR

Array = NDArray[np.float64]

# Sums may be reordered, which lets the compiler use vector instructions; NaN is still NaN.
FAST = {'reassoc', 'nsz', 'contract', 'arcp'}

LAST_EPSILON = 1e-8  # error of a velocity is its square, unless several points stick
STEP_TOLERANCE = 1e-8  # Newton's last step; the error left is about its square
ROUNDING = 1e-7  # residual left where points stick: rounding of their slip over epsilon
ATTEMPT = (12, 3)  # Newton steps, trials per step
STAGE = (60, 25)
FIRST_EPSILON, TRY_BELOW = 1.0, 0.2
REDUCTIONS = (0.1, 0.4, 0.8)  # of epsilon: patient only where haste fails
PIVOT_STEPS = 6
STICKING = 0.1  # slip in a good guess above which a point does not stick
HUGE_EPSILON = 1e12  # smoothed so far, a law is linear
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


@njit(cache=True, nogil=True, fastmath=FAST, error_model='numpy')
def _elliptic_sums(ratio, px, py, vx, vy, tx, ty, w, xi, epsilon, out):  # type: ignore[no-untyped-def]
    """The same for an elliptic law: isotropic once slip across the link is stretched."""
    a, b, c, e2 = xi[0], xi[1], xi[2], epsilon * epsilon
    g0 = g1 = g2 = h00 = h01 = h11 = h02 = h12 = h22 = 0.0
    for j in range(px.size):
        x, y, t0, t1 = px[j], py[j], tx[j], ty[j]
        n0, n1 = -ratio * t1, ratio * t0
        t2, n2 = x * t1 - y * t0, x * n1 - y * n0
        sx, sy = vx[j] + a - c * y, vy[j] + b + c * x
        along, across = t0 * sx + t1 * sy, n0 * sx + n1 * sy
        inverse = 1.0 / sqrt(along * along + across * across + e2)
        ut, un = along * inverse, across * inverse
        u0, u1, u2 = ut * t0 + un * n0, ut * t1 + un * n1, ut * t2 + un * n2
        k = w[j] * inverse
        g0 += w[j] * u0
        g1 += w[j] * u1
        g2 += w[j] * u2
        h00 += k * (t0 * t0 + n0 * n0 - u0 * u0)
        h01 += k * (t0 * t1 + n0 * n1 - u0 * u1)
        h11 += k * (t1 * t1 + n1 * n1 - u1 * u1)
        h02 += k * (t0 * t2 + n0 * n2 - u0 * u2)
        h12 += k * (t1 * t2 + n1 * n2 - u1 * u2)
        h22 += k * (t2 * t2 + n2 * n2 - u2 * u2)
    out[0], out[1], out[2] = g0, g1, g2
    out[3], out[4], out[5] = h00, h01, h02
    out[6], out[7], out[8] = h01, h11, h12
    out[9], out[10], out[11] = h02, h12, h22


@njit(cache=True, nogil=True, fastmath=FAST, error_model='numpy', inline='always')
def _resist(law, ut, un):  # type: ignore[no-untyped-def]
    """Granular resistance at unit slip, minus the force, and its derivatives by u_t and u_n."""
    bend = 1.0 / (1.0 + abs(un))
    root = 1.0 / sqrt(1.0 + law[3] * law[3] * un * un)
    rt = law[0] * ut + law[1] * ut * abs(ut) * bend
    rn = law[0] * un + law[2] * law[3] * un * root
    tt = law[0] + 2.0 * law[1] * abs(ut) * bend
    tn = -law[1] * ut * abs(ut) * bend * bend * np.copysign(1.0, un)
    return rt, rn, tt, tn, law[0] + law[2] * law[3] * root * root * root


@njit(cache=True, nogil=True, fastmath=FAST, error_model='numpy')
def _granular_sums(law, px, py, vx, vy, tx, ty, w, xi, epsilon, out):  # type: ignore[no-untyped-def]
    """The same for grains. Smoothed in size only: bent inside the circle, the law would fold."""
    a, b, c, e2 = xi[0], xi[1], xi[2], epsilon * epsilon
    g0 = g1 = g2 = h00 = h01 = h02 = h10 = h11 = h12 = h20 = h21 = h22 = 0.0
    for j in range(px.size):
        x, y, t0, t1 = px[j], py[j], tx[j], ty[j]
        n0, n1 = -t1, t0
        t2, n2 = x * t1 - y * t0, x * n1 - y * n0  # levers of the link axes
        sx, sy = vx[j] + a - c * y, vy[j] + b + c * x
        along, across = t0 * sx + t1 * sy, n0 * sx + n1 * sy
        s2 = along * along + across * across + 1e-60
        slip = 1.0 / sqrt(s2)
        inverse = 1.0 / sqrt(s2 + e2)
        ut, un = along * slip, across * slip
        rt, rn, rtt, rtn, rnn = _resist(law, ut, un)
        share, grow = w[j] * s2 * slip * inverse, w[j] * e2 * inverse * inverse * inverse
        # The direction turns with slip across it, the share grows with slip along it.
        k = w[j] * inverse
        dt, dn = k * (rtn * ut - rtt * un), k * rnn * ut
        tt, tn = grow * rt * ut - dt * un, grow * rt * un + dt * ut
        nt, nn = grow * rn * ut - dn * un, grow * rn * un + dn * ut
        g0 += share * (t0 * rt + n0 * rn)
        g1 += share * (t1 * rt + n1 * rn)
        g2 += share * (t2 * rt + n2 * rn)
        along0, along1, along2 = tt * t0 + tn * n0, tt * t1 + tn * n1, tt * t2 + tn * n2
        across0, across1, across2 = nt * t0 + nn * n0, nt * t1 + nn * n1, nt * t2 + nn * n2
        h00 += t0 * along0 + n0 * across0
        h01 += t0 * along1 + n0 * across1
        h02 += t0 * along2 + n0 * across2
        h10 += t1 * along0 + n1 * across0
        h11 += t1 * along1 + n1 * across1
        h12 += t1 * along2 + n1 * across2
        h20 += t2 * along0 + n2 * across0
        h21 += t2 * along1 + n2 * across1
        h22 += t2 * along2 + n2 * across2
    out[0], out[1], out[2] = g0, g1, g2
    out[3], out[4], out[5] = h00, h01, h02
    out[6], out[7], out[8] = h10, h11, h12
    out[9], out[10], out[11] = h20, h21, h22


@njit(cache=True, nogil=True, error_model='numpy')
def _newton(kind, law, p, w, xi, epsilon, tolerance, steps, halvings, out, trial):  # type: ignore[no-untyped-def]
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
        if max(abs(d0), abs(d1), abs(d2)) < tolerance:
            return True
    return norm < ROUNDING**2


@njit(cache=True, nogil=True, error_model='numpy', inline='always')
def _sums(kind, law, p, w, xi, epsilon, out):  # type: ignore[no-untyped-def]
    if kind == COULOMB:
        _coulomb_sums(p[0], p[1], p[2], p[3], w, xi, epsilon, out)
    elif kind == ELLIPTIC:
        _elliptic_sums(law[0], p[0], p[1], p[2], p[3], p[4], p[5], w, xi, epsilon, out)
    elif kind == LINEAR:
        ratio = sqrt(law[0])
        _elliptic_sums(ratio, p[0], p[1], p[2], p[3], p[4], p[5], w, xi, HUGE_EPSILON, out)
    else:
        _granular_sums(law, p[0], p[1], p[2], p[3], p[4], p[5], w, xi, epsilon, out)


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
    if _finish(kind, law, p, w, xi, out, trial):
        return True
    smoothed = np.zeros(3)
    for reduction in REDUCTIONS:
        smoothed[:] = 0.0
        epsilon = FIRST_EPSILON
        while epsilon > LAST_EPSILON:
            _newton(kind, law, p, w, smoothed, epsilon, 0.1 * epsilon, *STAGE, out, trial)
            epsilon *= reduction
            if epsilon < TRY_BELOW:
                xi[:] = smoothed
                if _finish(kind, law, p, w, xi, out, trial):
                    return True
    return _newton(kind, law, p, w, xi, LAST_EPSILON, STEP_TOLERANCE, *STAGE, out, trial)


@njit(cache=True, nogil=True, error_model='numpy')
def _finish(kind, law, p, w, xi, out, trial):  # type: ignore[no-untyped-def]
    """Go from a guess to the solution at once: all points slip, or the slowest one sticks."""
    if _newton(kind, law, p, w, xi, LAST_EPSILON, STEP_TOLERANCE, *ATTEMPT, out, trial):
        return True
    return _pivot(kind, law, p, w, xi, out, trial)


@njit(cache=True, nogil=True, error_model='numpy')
def _pivot(kind, law, p, w, xi, out, trial):  # type: ignore[no-untyped-def]
    """Let the slowest point stick; True, and `xi` in place, if it bears what the others pull."""
    slowest, least = 0, np.inf
    for j in range(w.size):
        slip = hypot(p[2, j] + xi[0] - xi[2] * p[1, j], p[3, j] + xi[1] + xi[2] * p[0, j])
        if slip < least:
            slowest, least = j, slip
    if least > STICKING:
        return False
    x, y = p[0, slowest], p[1, slowest]
    spin = xi[2]
    for _ in range(PIVOT_STEPS):
        trial[0], trial[1], trial[2] = spin * y - p[2, slowest], -spin * x - p[3, slowest], spin
        _sums(kind, law, p, w, trial, LAST_EPSILON, out)
        slope = y * (y * out[3] - x * out[4] + out[5]) - x * (y * out[6] - x * out[7] + out[8])
        slope += y * out[9] - x * out[10] + out[11]
        step = -(y * out[0] - x * out[1] + out[2]) / slope
        spin += step
        if abs(step) < STEP_TOLERANCE:
            if _bears(kind, law, p[4, slowest], p[5, slowest], w[slowest], out[0], out[1]):
                xi[:] = trial
                return True
            return False
    return False


@njit(cache=True, nogil=True, error_model='numpy')
def _bears(kind, law, tx, ty, w, fx, fy):  # type: ignore[no-untyped-def]
    """Whether a point at rest bears a force: a law at unit slip is the edge of what it can."""
    along, across = abs(tx * fx + ty * fy), abs(tx * fy - ty * fx)
    if kind == COULOMB:
        return hypot(along, across) <= w
    if kind == ELLIPTIC:
        return hypot(along, across / law[0]) <= w
    low, high = 0.0, 0.5 * pi
    for _ in range(40):  # the slip whose resistance has the direction of the force
        psi = 0.5 * (low + high)
        rt, rn, _, _, _ = _resist(law, cos(psi), sin(psi))
        if rn * along < rt * across:
            low = psi
        else:
            high = psi
    return hypot(along, across) <= w * hypot(rt, rn)


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


@njit(cache=True, nogil=True, error_model='numpy')
def velocities_of_feet(points, rates, loads, size):  # type: ignore[no-untyped-def]
    """Body velocity of feet under isotropic friction, every shape started from the one before.

    Args:
        points: [m], shape (B, P, 2).
        rates: their velocities with the body held [m/s], shape (B, P, 2).
        loads: of the feet, any unit; 0 is a foot in the air, shape (B, P).
        size: of the body [m].

    Returns:
        xi [m/s, m/s, rad/s], shape (B, 3), and the number of shapes that did not converge.
    """
    law, out, trial, xi = np.ones(4), np.empty(12), np.empty(3), np.zeros(3)
    result = np.zeros((points.shape[0], 3))
    failed = 0
    for b in range(points.shape[0]):
        down = np.flatnonzero(loads[b])
        p, w = np.zeros((6, down.size)), np.empty(down.size)
        p[4] = 1.0  # friction is isotropic: any axis will do
        speed = 0.0
        for j in range(down.size):
            i = down[j]
            p[0, j], p[1, j] = points[b, i, 0] / size, points[b, i, 1] / size
            p[2, j], p[3, j] = rates[b, i, 0], rates[b, i, 1]
            w[j] = loads[b, i]
            speed += (abs(p[2, j]) + abs(p[3, j])) / down.size
        if not speed > 0.0:
            continue
        w /= w.sum()
        p[2:4] /= speed
        if not balance(COULOMB, law, p, w, xi, out, trial):
            failed += 1
            xi[:] = 0.0
        result[b, 0], result[b, 1] = xi[0] * speed, xi[1] * speed
        result[b, 2] = xi[2] * speed / size
    return result, failed
