#pragma once

#include "scenarios/library/library_prediction.hpp"
#include "scenarios/records/test_curves.hpp"

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace bris {

/// The model of a test, as far as it decides whether a library fits it.
struct ModelOfTest {
    std::span<const NamedValue> settings; ///< of the scenario
    double core_porosity = 0;             ///< asked for
    double pressure = 0;                  ///< Pa
};

/// What a library predicts of a measured test.
struct TestPrediction {
    std::string not_used;               ///< why the library is not used; empty: it is
    LibraryObservations used;           ///< the measurements that were used
    LibraryPrediction predicted, prior; ///< prior: without measurements
    std::vector<double> weights;        ///< of the library's specimens (HybridRegression)
};

/// Whether a library is given by the option --library: it is neither empty nor "none".
bool is_given(const std::filesystem::path& library);

/// Index of the library's pressure that agrees within 1 % (`pressure`: Pa); the number of its
/// pressures if none does.
std::size_t pressure_index(const SpecimenLibrary& library, double pressure);

/// Why a library does not fit the model of a test: other rocks, another size or procedure, a
/// pressure that it does not have, or a porosity outside its range. Empty: it fits.
std::string reason_against(const SpecimenLibrary& library, const ModelOfTest& model);

struct LibraryOfFile {
    std::filesystem::path file;
    SpecimenLibrary library;
};
/// Reads the library given by the option --library: a file, or of those in a folder (*.h5) the one
/// that fits most of the models, the first by name of equals. Throws as read_library, and
/// InputError if there is none.
LibraryOfFile read_fitting_library(const std::filesystem::path& file_or_folder,
                                   std::span<const ModelOfTest> models);

/// A measured test at the strains of a library up to `observed.strain`, as a specimen whose test at
/// the `pressure`-th pressure has q and volumetric strain; what was not measured at all of these
/// strains is taken out of `observed`. Between records that are no more than `widest_gap` of axial
/// strain apart numbers are interpolated.
LibrarySpecimen measured_specimen(const SpecimenLibrary& library, std::size_t pressure,
                                  const MeasuredCurves& measured, LibraryObservations& observed,
                                  double widest_gap);

/// Predicts a test from its measured q and volumetric strain up to the strain `observed.strain`,
/// each as far as it is asked for and measured at the strains of the library, and from the core
/// porosity of its model. Where the library
/// does not fit the test, or nothing was measured, `not_used` says why, and there is no prediction.
/// `motion`: predict the sensor rocks and the displacement field too.
TestPrediction predict_test(const SpecimenLibrary& library, const ModelOfTest& model,
                            const MeasuredCurves& measured, LibraryObservations observed,
                            bool motion = false);

/// One line for the user: what was learned, how far the measurements lie from the library, or why
/// the library is not used.
std::string sentence_of(const TestPrediction& prediction);

/// Writes the predicted curves with their bands as CSV. Throws OutputError.
void write_prediction(const std::filesystem::path& csv, const TestCurves& predicted);

} // namespace bris
