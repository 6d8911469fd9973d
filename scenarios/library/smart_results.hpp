#pragma once

#include "engine/report.hpp"
#include "scenarios/ensemble/generations.hpp"
#include "scenarios/ensemble/misfit.hpp"
#include "scenarios/library/library_member.hpp"
#include "scenarios/library/library_use.hpp"
#include "scenarios/library/ring_estimate.hpp"
#include "scenarios/records/recorded_test.hpp"
#include "systems/output/picture.hpp"

#include <vector>

namespace bris {

/// What is computed for a recorded test. Where a library fits the test, "fused" is its prediction,
/// and the specimens that it favours go on with the test; otherwise "fused" is a model that takes
/// over its estimates.
struct SmartTest {
    RockParameters before;                 ///< estimate at the beginning of the test
    TestPrediction library;                ///< by a library of specimens
    RingEstimate rings;                    ///< by the library, at the end of the test
    std::vector<FavouredSpecimen> members; ///< that go on with the test, the favourite first
    Learned learned;                       ///< without a library that fits
    ModelRun free;                         ///< DEM only
    std::vector<ModelRun> running;         ///< the members, or the fused model
    std::vector<View> views;               ///< of the first of them

    bool by_library() const { return library.not_used.empty(); }
    bool complete() const; ///< whether no run was stopped
};

/// What the results of a test depend on besides.
struct SmartResults {
    double learned_strain = 0.01;   ///< axial strain up to which measurements are assimilated
    double last_strain = 0.08;      ///< of the test
    bool nudged = false;            ///< sensor rocks were nudged
    const SpecimenLibrary* library; ///< without specimens if none was given
    /// Strains that are scored: beyond those learned from, if the test goes beyond them.
    StrainRange scored(double to) const {
        return {last_strain > learned_strain ? learned_strain : 0, to};
    }
};

/// Adds the numbers of a test to the summary, with the pressure in front of each key.
void add_results(Report& summary, const RecordedTest& test, const SmartTest& computed,
                 const SmartResults& settings);

/// Writes the curves of all runs of a test that were not stopped into its folder: dem_only.csv, and
/// specimen_NUMBER.csv for each member, or fused.csv. Throws OutputError.
void write_runs(const std::filesystem::path& folder, const SmartTest& computed,
                const SmartResults& settings);

/// Draws q, volumetric strain and rings of all tests into smart_triaxial.png, and the sensor rocks
/// of each test into smart_rocks.png in its folder.
void draw_results(const std::filesystem::path& out, const std::vector<RecordedTest>& tests,
                  const std::vector<SmartTest>& computed, double learned_strain);

} // namespace bris
