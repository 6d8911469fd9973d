#pragma once

#include "tests/performance/time_vs_error/scene.hpp"

#include <filesystem>
#include <optional>

namespace bris::time_vs_error {

/// One line of the CSV file: the result of one run for one kind of error.
struct Line {
    std::string scene, knob, value, kind, settings;
    std::uint64_t seed = 0;
    double wall_time = 0; ///< s
    std::uint64_t steps = 0;
    double contacts = 0;
    double measured = unknown, reference = unknown, error = unknown; ///< NaN if the run failed
    std::string fingerprint, compiler, machine, load, note;
};

/// Adds compiler, machine and its present load to an outcome.
void stamp(Outcome& outcome);

/// All lines of the CSV file, which is written after every run. A run whose lines are there is not
/// repeated.
class Results {
public:
    explicit Results(std::filesystem::path csv);

    bool has(const Scene& scene, const std::string& knob, const std::string& value,
             std::uint64_t seed) const;
    /// Outcome of a run with these settings, for whichever knob it was run. Empty if there is none.
    std::optional<Outcome> outcome(const Scene& scene, const Settings& settings,
                                   std::uint64_t seed) const;
    void add(const Scene& scene, const Knob& knob, const std::string& value,
             const Settings& settings, std::uint64_t seed, const Outcome& outcome,
             const std::optional<Outcome>& reference);
    const std::vector<Line>& lines() const { return lines_; }

private:
    std::filesystem::path csv_;
    std::vector<Line> lines_;
};

/// Summary of the lines of a knob's value over all seeds.
struct Summed {
    std::string scene, knob, value, kind;
    std::size_t seeds = 0, failed = 0;
    double wall_time = 0, steps = 0, contacts = 0;   ///< medians
    double bias = unknown, standard_error = unknown; ///< mean error and its standard error
    double half_interval = unknown; ///< half width of the 95 % interval (Student's distribution)
    double worst = unknown;         ///< largest |error| of a seed
    double tolerance = 0;
    bool is_reference = false;
    std::string verdict = {}; ///< meets, fails, undecided
};
std::vector<Summed> sum_up(const Scene& scene, const std::vector<Line>& lines);
void write_summed(const std::filesystem::path& csv, const std::vector<Summed>& all);
void print_summed(const Scene& scene, const std::vector<Summed>& all);
/// The cheapest value of each knob that meets the tolerance of each kind.
void print_recommendation(const Scene& scene, const std::vector<Summed>& all);
/// Draws wall time and steps against error: a curve for each knob, a row of panels for each kind.
void draw(const std::filesystem::path& png, const Scene& scene, const std::vector<Summed>& all);

} // namespace bris::time_vs_error
