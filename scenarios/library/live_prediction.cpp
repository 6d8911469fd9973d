#include "scenarios/library/live_prediction.hpp"

#include "engine/io/csv.hpp"
#include "engine/stopwatch.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

namespace bris {

LivePrediction::LivePrediction(const std::filesystem::path& library,
                               std::vector<NamedValue> settings, double core_porosity,
                               double pressure)
    : settings_(std::move(settings)), model_{settings_, core_porosity, pressure} {
    if (!is_given(library))
        reason_ = "none was given";
    else {
        library_ = read_fitting_library(library, {&model_, 1}).library;
        reason_ = reason_against(library_, model_);
    }
    last_.not_used = reason_.empty() ? "nothing has been measured yet" : reason_;
}

bool LivePrediction::update(double strain, const RecordedTest& so_far) {
    if (!reason_.empty()) return false;
    const auto steps = static_cast<std::size_t>(std::floor(strain / library_.axis.step + 1e-6));
    if (steps <= used_ || steps > library_.axis.count) return false;
    const bool has_sensors = steps / library_.axis.every > used_ / library_.axis.every;
    used_ = steps;
    const auto began = this_instant();
    last_ = predict_test(library_, model_, so_far.curves,
                         {.strain = static_cast<double>(steps) * library_.axis.step});
    if (has_sensors) estimate_rings_now(so_far);
    times_.push_back(seconds_since(began));
    if (!last_.not_used.empty()) return false;
    const LibraryPrediction& p = last_.predicted;
    rows_.push_back({last_.used.strain, p.friction.value, p.friction.low, p.friction.high});
    for (const Quantity* q : {&quantity::smoothed_q, &quantity::volumetric_strain}) {
        const TestCurves::Column& c = p.curves.column(*q);
        rows_.back().insert(rows_.back().end(), {c.values.back(), c.low.back(), c.high.back()});
    }
    rows_.back().push_back(p.distance);
    return true;
}

void LivePrediction::estimate_rings_now(const RecordedTest& so_far) {
    RingEstimate now =
        estimate_rings(library_, model_, so_far, static_cast<double>(used_) * library_.axis.step);
    if (!now.not_made.empty()) return;
    rings_ = std::move(now);
    ring_rows_.push_back({rings_.strain});
    for (std::size_t r = 0; r < rings_.mean.size(); ++r)
        for (const auto* values : {&rings_.mean, &rings_.low, &rings_.high})
            ring_rows_.back().push_back((*values)[r]);
}

void LivePrediction::write(const std::filesystem::path& folder) const {
    if (rows_.empty()) return;
    if (last_.not_used.empty()) write_prediction(folder / "predicted.csv", last_.predicted.curves);
    write_csv(folder / "predictions.csv",
              {"axial_strain", "friction", "friction_low", "friction_high", "last_smoothed_q_Pa",
               "last_smoothed_q_low_Pa", "last_smoothed_q_high_Pa", "last_volumetric_strain",
               "last_volumetric_strain_low", "last_volumetric_strain_high", "distance"},
              rows_,
              {"what a library of specimens predicts for its last strain from the measurements up "
               "to axial_strain, with 90 % bands"},
              6);
    if (ring_rows_.empty()) return;
    std::vector<std::string> names{"axial_strain"};
    for (std::size_t r = 1; r <= rings_.mean.size(); ++r)
        for (const char* end : {"", "_low", "_high"})
            names.push_back(fmt::format("ring_{}_radial_strain{}", r, end));
    write_csv(folder / "rings.csv", names, ring_rows_,
              {"radial strains of the rings, from below, estimated from what was measured at "
               "axial_strain, with 90 % bands"},
              6);
}

} // namespace bris
