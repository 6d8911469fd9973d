#pragma once

#include "engine/progress.hpp"
#include "engine/scenario.hpp"
#include "scenarios/ensemble/run_models.hpp"
#include "scenarios/library/specimen_library.hpp"

#include <cstddef>
#include <string>
#include <vector>

namespace bris {

/// A specimen of a library that the measurements of a test favour.
struct FavouredSpecimen {
    std::size_t index = 0; ///< in the library
    double weight = 0;     ///< of the sum over the library
};

/// The `count` specimens with the largest weights (one for each specimen), the largest first.
std::vector<FavouredSpecimen> favoured(const std::vector<double>& weights, std::size_t count);

/// Number, friction, porosity and weight of the specimens, for the user.
std::string sentence_of(const SpecimenLibrary& library,
                        const std::vector<FavouredSpecimen>& members);

/// The test by which the specimens of a library were made and sheared, from its settings. Throws
/// InputError if they are none of a triaxial test.
Triaxial test_of(const SpecimenLibrary& library);

/// A packing of a library: its porosity and its seed.
struct LibraryPacking {
    double porosity;
    std::uint64_t seed;
};

/// Name of the folder of a packing in the results.
std::string folder_of_packing(std::uint64_t seed);

/// Makes a packing, in its folder of the results, on one thread. `settings`: those
/// that its checkpoint carries, apart from porosity and seed; --resume reads the packing from the
/// same folder. Throws as make_specimen does.
PreparedSpecimen make_packing(const Triaxial& test, const LibraryPacking& packing,
                              std::vector<NamedValue> settings, const Common& common,
                              const ReportProgress& report);

/// Shears a specimen of a library, whose packing has been made, at a pressure (Pa) to an axial
/// strain. Its curve is that of the library, bit for bit, if the version of BRIS that made the
/// library makes the same specimens. Throws SimulationError, Interrupted.
ModelRun run_member(const SpecimenLibrary& library, std::size_t index,
                    const PreparedSpecimen& packing, double pressure, double strain,
                    const ModelWatch& watch);

/// Largest difference of q between a run of a specimen and the library, relative to the largest q
/// of the library, over the strains that both have. `pressure`: index of the library's pressure.
double difference_from(const SpecimenLibrary& library, std::size_t index, std::size_t pressure,
                       const ModelRun& run);

} // namespace bris
