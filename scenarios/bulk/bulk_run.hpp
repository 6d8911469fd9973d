#pragma once

#include "components/settings.hpp"
#include "engine/io/plot.hpp"
#include "engine/io/series.hpp"
#include "engine/report.hpp"
#include "engine/run.hpp"
#include "engine/simulation.hpp"
#include "scenarios/bulk/bulk_bed.hpp"
#include "scenarios/specimens/last_quantities.hpp"
#include "scenarios/specimens/write_option.hpp"
#include "systems/output/picture.hpp"

#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <vector>

namespace bris {

/// Settings that the bulk cases share: duration, sampling and bed.
struct BulkSettings {
    double duration = 1, sample_interval = 0.01; ///< s
    unsigned frames = 20;
    std::filesystem::path bed_file = {}, reference = {};
    bool fill_only = false;
    BedSettings bed = {};
    WriteOption written = {};

    void declare_options(auto& option);
};

/// Throws InputError and OutputError if the curve to compare with, or the bed, cannot be used.
void check_bulk(const BulkSettings& settings, const Common& common);

/// A case: its scene with neighbour lists, and what it does at the samples of a run.
struct BulkCase {
    World world;
    Series& curve; ///< to which `sample` adds
    /// Starts the run; called when the bed is at rest and the clock is at 0.
    std::function<void(World&)> begin = {};
    /// Adds a sample to the curve, at every sample interval. Of a divided world all ranks do.
    std::function<void(const World&)> sample = {};
    /// Edits the scene after each sample, of a divided world this rank's part; empty: nothing does.
    std::function<void(World&)> edit = {};
    /// Whether the run is over before its duration; called after each sample.
    std::function<bool(const World&)> is_over = {};
    std::function<std::string()> description = {};        ///< for the progress line
    std::function<Colour(const World&, Row)> colour = {}; ///< of a body in pictures
};

/// Makes a bed or reads one from a file, then runs the case with its samples, frames, pictures and
/// checkpoints.
class BulkRun {
public:
    BulkRun(const Common& common, const BulkSettings& settings, BulkCase bulk_case,
            Simulation& simulation);

    /// Runs everything; returns false if only the bed was requested.
    bool run();

    /// At the last sample; of a divided world this rank's part.
    const World& world() const {
        return simulation_.is_observed() ? simulation_.observed()
                                         : std::as_const(simulation_).world();
    }
    /// Writes the curve, the pictures and summary.json, and prints the summary: `results` first,
    /// then the values that all cases share.
    void report(const Report& results, std::vector<Plot> plots);
    /// The reference curve that --reference names; empty without one.
    std::vector<Curve> reference() const;

private:
    const Clock& clock() const {
        const World* part = simulation_.part();
        return (part != nullptr ? *part : world()).resource<Clock>();
    }
    const BedState& bed() const { return world().resource<BedState>(); }
    void start_from_files();
    Phase bed_phase();
    Phase case_phase();
    void report_bed();
    void begin_case();
    void open_frames();
    bool at_sample(std::uint64_t step);
    void measure_contacts();
    void edit();
    void keep_view();

    Common common_;
    BulkSettings settings_;
    BulkCase case_;
    std::uint64_t total_, sample_every_;
    Simulation& simulation_;
    BedMaker maker_;
    Progress progress_;
    Run run_;
    std::unique_ptr<FrameWriter> frames_;
    std::vector<View> views_;
    LastQuantities last_;
    struct Extremes {                                                 // of all samples
        double stable_step = std::numeric_limits<double>::infinity(); ///< s, the least
        double overlap = 0;                                           ///< m, the largest
        void save(Archive& archive) const;
        void load(const Archive& archive);
    } extremes_;
};

/// Starts the simulation of a case, with the viscous Hertz-Mindlin law.
Simulation start_case(World world, const Common& common);

/// Runs a case; `report` is called afterwards, unless only the bed was requested.
void run_bulk(const Common& common, const BulkSettings& settings, BulkCase bulk_case,
              const std::function<void(BulkRun&)>& report);

/// Duration (s) of an elastic Hertz impact of two equal spheres, 2.87 (m*^2 / (R* E*^2 v))^(1/5)
/// (Johnson 1985, eq. 11.24). `radius` in m, `density` in kg/m3, `young_modulus` in Pa (with
/// Poisson's ratio 0.2), `speed` in m/s.
double hertz_contact_time(double radius, double density, double young_modulus, double speed);

void BulkSettings::declare_options(auto& option) {
    option.group("Run");
    option("duration", duration, "s", "Longest simulated time.", above(0, 1e6));
    option("step", bed.step, "s", "Time step.", above(0, 1));
    option("sample_interval", sample_interval, "s", "Simulated time between points of the curve.",
           above(0, 1e6));
    option("frames", frames, "", "Number of frames in the run file.", within(1, 1e6));
    written.declare_options(option, write_of_spheres);
    option("reference", reference, "",
           "CSV file of a curve to show for comparison: two columns, time in s and value.");
    option.group("Bed");
    option("bed", bed_file, "", "File of a bed to begin with, made with --fill-only.");
    option("fill_only", fill_only, "", "Make the bed, write bed.ckpt.h5 and stop.");
    bed.declare_options(option);
}

} // namespace bris
