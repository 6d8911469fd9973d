#pragma once

#include "scenarios/library/library_use.hpp"
#include "scenarios/library/ring_estimate.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace bris {

/// The prediction of a test by a library of specimens while the test goes on: anew at each strain
/// of the library, from all measurements so far.
class LivePrediction {
public:
    /// `library`: file or folder (read_fitting_library); empty: there is no prediction. Throws
    /// InputError and OutputError.
    LivePrediction(const std::filesystem::path& library, std::vector<NamedValue> settings,
                   double core_porosity, double pressure);
    LivePrediction(const LivePrediction&) = delete; // the model refers to the settings
    LivePrediction& operator=(const LivePrediction&) = delete;

    /// Why there is no prediction; empty: there is one.
    const std::string& reason() const { return reason_; }
    /// Predicts anew if the test has reached another strain of the library since the last time;
    /// returns whether it did. Only measurements up to `strain` are used.
    bool update(double strain, const RecordedTest& so_far);
    /// The last prediction; without one its `not_used` is not empty.
    const TestPrediction& last() const { return last_; }
    /// The rings at the last strain at which the library has sensor rocks.
    const RingEstimate& rings() const { return rings_; }
    /// Wall times (s) of the updates.
    const std::vector<double>& times() const { return times_; }
    /// Writes predicted.csv (the last prediction), predictions.csv (friction and q at the last
    /// strain with their 90 % bands, by strain) and rings.csv (the rings, by strain) into a folder.
    /// Throws OutputError.
    void write(const std::filesystem::path& folder) const;

private:
    void estimate_rings_now(const RecordedTest& so_far);

    SpecimenLibrary library_;
    std::vector<NamedValue> settings_;
    ModelOfTest model_;
    std::string reason_;
    std::size_t used_ = 0; ///< number of the library's strains in the last prediction
    TestPrediction last_;
    RingEstimate rings_;
    std::vector<double> times_;
    std::vector<std::vector<double>> rows_, ring_rows_;
};

} // namespace bris
