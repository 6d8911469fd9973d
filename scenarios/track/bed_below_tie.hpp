#pragma once

#include "engine/progress.hpp"

#include <filesystem>

namespace bris {

/// What lies below a tie and settles under its loads.
class BedBelowTie {
public:
    virtual ~BedBelowTie() = default;

    /// Brings the bed to rest under the weight of the rails. Throws InputError, SimulationError,
    /// OutputError, Interrupted.
    virtual void prepare(const ReportProgress& report) = 0;
    /// Axles pass: each loads the whole tie with `force` (N, of the rails, above their weight) and
    /// leaves it with the weight of the rails. Returns what the tie has settled meanwhile, m,
    /// downwards. Throws SimulationError and Interrupted.
    virtual double load(double force, unsigned axles) = 0;
    /// N/m, of a whole tie on bed and subgrade, as the last axle has left; 0: none has come.
    virtual double stiffness() const = 0;
    virtual void save(const std::filesystem::path& checkpoint) const = 0;
    /// Continues from a checkpoint of the same bed.
    virtual void resume(const std::filesystem::path& checkpoint) = 0;
};

} // namespace bris
