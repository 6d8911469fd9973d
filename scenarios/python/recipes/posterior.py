"""Recipe: a posterior. Restitution is estimated from noisy heights of a bouncing sphere: an ensemble drawn from the prior is
weighted by the likelihood of the observations (importance sampling)."""
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from own_scenario import heights

TRUTH, NOISE, MEMBERS = 0.62, 2e-3, 24  # restitution, m, number of ensemble members


def main(out):
    random = np.random.default_rng(1)
    observed = heights(TRUTH, samples=60)[1] + random.normal(0, NOISE, 60)
    prior = np.linspace(0.4, 0.95, MEMBERS)  # uniform prior: equally spaced members
    members = np.array([heights(e, samples=60)[1] for e in prior])
    misfit = ((members - observed)**2).sum(axis=1) / (2 * NOISE**2)
    weight = np.exp(misfit.min() - misfit)
    weight /= weight.sum()
    mean = weight @ prior
    spread = max(np.sqrt(weight @ (prior - mean)**2), (prior[1] - prior[0]) / np.sqrt(12))  # at least that of the grid
    print(f'restitution {mean:.3f} +- {spread:.3f}, truth {TRUTH}')
    assert abs(mean - TRUTH) < 3 * spread < 0.1
    plt.bar(prior, weight, width=0.8 * (prior[1] - prior[0]))
    plt.axvline(TRUTH, color='black')
    plt.xlabel('restitution')
    plt.ylabel('posterior weight')
    plt.savefig(out / 'posterior.png', dpi=150)


if __name__ == '__main__':
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    main(folder)
