"""What the points of a sweep say: order of convergence, extrapolation, Pareto front, the cost of an
error bound."""

import numpy as np

# 97.5 % quantiles of Student's t by degrees of freedom
_STUDENT = (12.71, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228)

SCHEME = 2.0  # order of what is sound in SPH and in time


def order(h, error):
    """(order, half width of its 95 % confidence interval, constant) of |error| = constant h^order,
    least squares in logarithms.

    None with fewer than three usable points; the interval is what the scatter about the straight
    line says, so curves that bend or pass through zero have a wide one.
    """
    h, error = np.asarray(h, float), np.abs(np.asarray(error, float))
    good = np.isfinite(error) & (error > 0.0)
    x, y = np.log(h[good]), np.log(error[good])
    n = len(x)
    if n < 3 or np.ptp(x) == 0.0:
        return None
    slope, offset = np.polyfit(x, y, 1)
    rest = y - (slope * x + offset)
    deviation = np.sqrt(rest @ rest / (n - 2) / np.sum((x - x.mean())**2))
    return float(slope), float(deviation * _STUDENT[min(n - 2, len(_STUDENT)) - 1]), float(
        np.exp(offset))


def extrapolate(h, value):
    """(limit, order, uncertainty) of value = limit + constant h^order by Richardson's
    extrapolation.

    Least squares over orders of 0.3 to 6. The uncertainty is the largest of three: the change when
    the coarsest point is left out, a quarter of the last step to the limit, and the distance to the
    limit with order 2, where the order found is above that of the schemes (a coarsest run far off
    looks like a high order). None where the values do not approach a limit: fewer than three,
    differences that grow, or a limit less certain than the values.
    """
    h, value = (np.asarray(a, float) for a in (h, value))
    by_size = np.argsort(h)[::-1]
    h, value = h[by_size], value[by_size]
    if len(h) < 3 or not np.all(np.isfinite(value)):
        return None
    steps = np.diff(value)[-2:]
    # compared per unit of h^1, so that unequal refinement does not count as convergence
    if steps[0] * steps[1] <= 0.0 or abs(steps[1] / (h[-2] - h[-1])) > 1.5 * abs(
        steps[0] / (h[-3] - h[-2])):
        return None
    limit, power = _fit(h, value)
    change = abs(_fit(h[1:], value[1:])[0] - limit) if len(h) > 3 else 0.0
    of_second = value[-1] + steps[1] / ((h[-2] / h[-1])**SCHEME - 1.0)
    uncertainty = max(change, 0.25 * abs(limit - value[-1]), abs(of_second - limit) if power
                      > SCHEME else 0.0)
    return (limit, power, uncertainty) if uncertainty <= 2.0 * abs(steps[1]) else None


def between(h, value):
    """(limit by first order, limit by second order) of two values at two spacings: what a finer run
    would tend to."""
    (coarse, a), (fine, b) = sorted(zip(h, value), reverse=True)
    return tuple(b + (b - a) / ((coarse / fine)**order - 1.0) for order in (1, 2))


def _fit(h, value):
    best = None
    for power in np.linspace(0.3, 6.0, 571):
        matrix = np.column_stack([np.ones_like(h), h**power])
        solution, *_ = np.linalg.lstsq(matrix, value, rcond=None)
        rest = np.sum((matrix @ solution - value)**2)
        if best is None or rest < best[0]:
            best = rest, float(solution[0]), float(power)
    return best[1:]


def pareto(cost, error, tolerance=0.0):
    """Indices of the points that no other beats, cheapest first.

    A point is beaten by one of lower error whose cost is not more than `tolerance` above its own,
    or of equal error and lower cost.
    """
    cost, error = np.asarray(cost, float), np.asarray(error, float)
    front = [k for k in range(len(cost)) if np.isfinite(error[k])
             and not np.any((error < error[k]) & (cost <= cost[k] * (1.0 + tolerance)))
             and not np.any((error == error[k]) & (cost < cost[k]))]
    return sorted(front, key=lambda k: cost[k])


def crossings(error):
    """For signed errors from coarse to fine: which of them are suspiciously small because the error
    changes sign next to them."""
    error = np.asarray(error, float)
    flags = np.zeros(len(error), bool)
    for k in range(len(error) - 1):
        if error[k] * error[k + 1] < 0.0:
            flags[k if abs(error[k]) < abs(error[k + 1]) else k + 1] = True
    return flags


def reach(error, bound):
    """Index of the coarsest run, in errors from coarse to fine, from which on all are within the
    bound; None if there is none."""
    inside = np.abs(np.asarray(error, float)) <= bound
    if not len(inside) or not inside[-1]:
        return None
    outside = np.flatnonzero(~inside)
    return 0 if not outside.size else int(outside[-1] + 1)
