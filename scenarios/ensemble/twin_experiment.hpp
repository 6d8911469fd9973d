#pragma once

#include "engine/progress.hpp"
#include "engine/report.hpp"
#include "scenarios/ensemble/analysis.hpp"
#include "scenarios/ensemble/generations.hpp"
#include "scenarios/ensemble/run_models.hpp"
#include "scenarios/ensemble/twin_settings.hpp"
#include "scenarios/ensemble/twin_variants.hpp"

#include <optional>

namespace bris {

/// Estimates from ensemble members, and their forecast.
struct Assimilated {
    Learned learned;
    ModelRun forecast = {};
    RockScatter scatter = {};
    std::size_t outliers = 0; // displacements that were rejected
    double wall = 0;
};

/// A true test, and the variants of its model. `settings` and `common` must outlive it.
class TwinExperiment {
public:
    TwinExperiment(const TwinSettings& settings, const Common& common);
    /// Runs the truth, the ensemble members and the variants, and records the truth if asked for.
    void run();
    /// Prints the results of `run` and writes them to the folder of the results.
    void report() const;

private:
    ModelVariant model_variant(TwinVariant kind) const;
    Assimilated assimilate();
    ModelRun compute_analysis_of(const ModelVariant& variant) const;
    MeasuredCurves measured() const;
    void record(const RecordingSettings& settings) const;
    void make_specimens();
    const PreparedSpecimen& model_specimen() const { return model_ ? *model_ : true_; }
    std::vector<ModelRun> run_all(const PreparedSpecimen& specimen,
                                  const std::vector<ModelVariant>& variants);

    // results
    /// Number of groups of rocks whose errors are reported: the sensor rocks and shells about them.
    /// In another packing only the sensor rocks have the positions of the truth.
    std::size_t shells() const;
    void add_variant(Report& summary, std::size_t k, const TwinErrors* of_free) const;
    Report properties(const ModelRun& run) const;
    void add_starts(Report& summary) const;
    void add_learned(Report& summary, const Assimilated& assimilated) const;
    void draw() const;

    const TwinSettings& t_;
    const Common& common_;
    Learning learning_;
    PreparedSpecimen true_;
    std::optional<PreparedSpecimen> model_; // if it differs from the truth's
    std::vector<TwinVariant> kinds_;
    TriaxialSettings test_;
    Progress progress_;
    ModelRun truth_;
    std::optional<SensorObservations> observations_;
    std::optional<Assimilated> assimilated_; // if a variant needs it
    std::vector<ModelVariant> variants_;     // of each kind
    std::vector<ModelRun> runs_;
};

} // namespace bris
