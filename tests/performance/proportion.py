"""Intervals of counted proportions."""
import math


def clopper_pearson(k, n):
    """Exact 95 % interval of a probability, by bisection."""
    def below(p):  # probability of at most k
        return sum(math.comb(n, i) * p ** i * (1 - p) ** (n - i) for i in range(k + 1))

    def root(holds):
        a, b = 0.0, 1.0
        for _ in range(60):
            a, b = (0.5 * (a + b), b) if holds(0.5 * (a + b)) else (a, 0.5 * (a + b))
        return 0.5 * (a + b)
    low = 0.0 if k == 0 else root(lambda p: 1 - below(p) + math.comb(n, k) * p ** k * (1 - p) ** (n - k) < 0.025)
    return low, 1.0 if k == n else root(lambda p: below(p) > 0.025)
