#pragma once

#include "engine/estimation/kalman.hpp"
#include "engine/random.hpp"

namespace bris {

/// An observation of an ensemble of N members: m numbers with independent errors.
struct EnsembleObservation {
    Matrix forecast; ///< m x N: what each member forecasts for these numbers
    Vector measured; ///< m
    Vector variance; ///< m, of the measurement errors, > 0
};

// The updates below change `members`, n x N, one column per member, from the forecast to the
// analysis. They throw InputError if the sizes differ, if there are fewer than two members, or if a
// variance is not positive.

/// Symmetric square-root update (ensemble transform: Bishop et al. 2001; Hunt et al. 2007): the
/// mean and the covariance of the analysis are those of the Kalman filter for the covariance of the
/// members, without random numbers.
void update_by_square_root(Matrix& members, const EnsembleObservation& observation);

/// Update with perturbed observations (Burgers et al. 1998): every member is corrected by the
/// measurement plus an error drawn for it. The mean of the drawn errors is removed.
void update_by_perturbed_observations(Matrix& members, const EnsembleObservation& observation,
                                      Random& random);

/// Local square-root update (Hunt et al. 2007): every variable is updated by the observations near
/// it. `weights`, n x m in [0, 1], multiplies the inverse variance of the m observations for each
/// of the n variables.
void update_locally(Matrix& members, const EnsembleObservation& observation, const Matrix& weights);

/// Fifth-order piecewise rational function of Gaspari and Cohn (1999), eq. 4.10: 1 at distance 0,
/// 0 from twice the `length` on.
double gaspari_cohn(double distance, double length);

/// Multiplies the deviations of the members from their mean by a factor.
void inflate(Matrix& members, double factor);

/// Rotates the deviations of the members by a random orthogonal matrix that preserves their mean
/// and covariance (Sakov and Oke 2008).
void rotate_randomly(Matrix& members, Random& random);

} // namespace bris
