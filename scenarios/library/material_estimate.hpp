#pragma once

#include "scenarios/library/library_prediction.hpp"
#include "scenarios/records/test_curves.hpp"
#include "scenarios/specimens/material_card_file.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace bris {

/// A measured test from which the properties of its rocks are estimated.
struct TestOfMaterial {
    MeasuredCurves measured;
    double pressure = 0;      ///< Pa
    double core_porosity = 0; ///< at the start of shearing; 0: not known
    double last_strain = 1;   ///< axial strain up to which measurements are used
};

/// The prediction of a test of the same specimen at another pressure, or of the rest of this one.
struct PredictedTest {
    double pressure = 0; ///< Pa
    LibraryPrediction predicted;
};

/// A further measurement on the same specimen, and how far it would narrow the parameters.
struct FurtherTest {
    std::string what;        ///< for the user, as "a test at 55 kPa to 4 %"
    double pressure = 0;     ///< Pa
    double strain = 0;       ///< axial strain to which it is measured
    bool measured = false;   ///< what is known already, to compare with
    double ln_friction = 0;  ///< root mean square error that is expected afterwards
    double ln_stiffness = 0; ///< likewise
};

/// What a test tells of its rocks, by a library of specimens.
struct MaterialEstimate {
    LibraryObservations used;
    MaterialCard card;
    double ln_friction_prior = 0;           ///< standard deviation of ln friction in the library
    double distance = 0;                    ///< of the measurements (LibraryPrediction)
    std::vector<PredictedTest> tests;       ///< by increasing pressure
    std::vector<FurtherTest> further_tests; ///< what is known first, then the most telling first
    std::vector<std::string> notes;         ///< what is interpolated, extrapolated or not used
};

/// Adds the results of all specimens at a pressure between two of the library's, interpolated in
/// the logarithm of the pressure (ln q, all else linearly), unless the library has this pressure
/// within 1 %. Returns its index. Throws InputError, naming --pressure, outside of the library's
/// pressures.
std::size_t add_pressure(SpecimenLibrary& library, double pressure);

/// Estimates the properties of the rocks of a test and predicts it at the pressures of the library.
/// Throws InputError if the test is too short for the library, begins too late, has gaps in q, or
/// was made at a pressure that the library does not include.
MaterialEstimate estimate_material(SpecimenLibrary library, const TestOfMaterial& test);

/// Writes further_tests.csv. Throws OutputError.
void write_further_tests(const std::filesystem::path& csv, const MaterialEstimate& estimate);

/// Draws q and volumetric strain at each pressure with their bands, and the measured test.
bool draw_material(const std::filesystem::path& png, const MaterialEstimate& estimate,
                   const TestOfMaterial& test);

} // namespace bris
