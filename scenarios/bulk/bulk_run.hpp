#pragma once

#include "components/settings.hpp"
#include "engine/io/plot.hpp"
#include "engine/io/series.hpp"
#include "engine/run.hpp"
#include "engine/simulation.hpp"
#include "engine/summary.hpp"
#include "scenarios/bulk/bulk_bed.hpp"
#include "systems/output/frames.hpp"
#include "systems/output/picture.hpp"
#include "systems/output/quantities.hpp"

#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

namespace bris {

/// What the bulk cases share: how long, how finely, from which bed.
struct BulkSettings {
    double duration = 1, sample_interval = 0.01; ///< s
    unsigned frames = 20;
    std::filesystem::path bed_file = {}, reference = {};
    bool fill_only = false;
    BedSettings bed = {};

    void describe(auto& option);
};

/// A case: its scene with lists, and what is done to it.
struct BulkCase {
    World world;
    std::vector<RunFile::Column> columns; ///< of the curve; time (s) is the first
    std::function<void(World&)> begin =
        {}; ///< the bed is at rest, the clock at 0: lets the run begin
    std::function<void(World&, Series&)> sample = {}; ///< every sample interval; may edit the scene
    std::function<bool(const World&)> is_over = {}; ///< before the duration is; asked after samples
    std::function<std::string(const Series&)> description = {}; ///< for the line of progress
    std::function<Colour(const World&, Row)> colour = {};       ///< of a body in pictures
};

/// Makes a bed or takes one from a file, then runs the case: samples, frames, pictures,
/// checkpoints.
class BulkRun {
public:
    BulkRun(const Common& common, const BulkSettings& settings, BulkCase bulk_case,
            Simulation& simulation);

    /// False if only the bed was asked for.
    bool run();

    const World& world() const { return std::as_const(simulation_).world(); }
    const Series& series() const { return series_; }
    /// Writes curve, pictures and summary.json, and prints the result; `results` stand before what
    /// all share.
    void report(const Summary& results, std::vector<Plot> plots);
    /// What --reference names, as a curve; empty if nothing.
    std::vector<Curve> reference() const;

private:
    const Clock& clock() const { return world().resource<Clock>(); }
    const BedState& bed() const { return world().resource<BedState>(); }
    void start_from_files();
    Phase bed_phase();
    Phase case_phase();
    void report_bed();
    void begin_case();
    void open_frames();
    bool at_sample(std::uint64_t step);
    void take_sample();
    void measure_contacts();
    void keep_view();

    Common common_;
    BulkSettings settings_;
    BulkCase case_;
    std::uint64_t total_, sample_every_;
    Simulation& simulation_;
    Series series_;
    BedMaker maker_;
    Progress progress_;
    Run run_;
    std::unique_ptr<FrameWriter> frames_;
    std::vector<View> views_;
    double least_stable_step_; ///< s, of all samples
    Quantities last_;
    double deepest_ = 0; ///< m, of all samples
};

/// The simulation of a case.
Simulation start_case(World world, const Common& common);

/// Runs a case; `report` is called if it ran.
void run_bulk(const Common& common, const BulkSettings& settings, BulkCase bulk_case,
              const std::function<void(BulkRun&)>& report);

/// Time (s) of an elastic Hertz impact of two like spheres, 2.87 (m*^2 / (R* E*^2 v))^(1/5)
/// (Johnson 1985, 11.24). radius m, density kg/m3, young_modulus Pa (Poisson's ratio 0.2), speed
/// m/s.
double hertz_contact_time(double radius, double density, double young_modulus, double speed);

void BulkSettings::describe(auto& option) {
    option.group("run");
    option("duration", duration, "s", "simulated, at most", above(0));
    option("step", bed.step, "s", "time step", above(0));
    option("sample_interval", sample_interval, "s", "between points of the curve", above(0));
    option("frames", frames, "", "of the run file", at_least(1));
    option("reference", reference, "",
           "CSV file of a curve to show beside: two columns, time in s and value");
    option.group("bed");
    option("bed", bed_file, "", "file of a bed to begin with, made with --fill-only");
    option("fill_only", fill_only, "", "make the bed, write bed.ckpt.h5 and end");
    bed.describe(option);
}

} // namespace bris
