#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <string>
#include <vector>

namespace bris::time_vs_error {

/// Settings of a run as text, which fits into the columns of the CSV file. Two runs are equal if
/// their texts are equal.
class Settings {
public:
    Settings() = default;
    Settings(std::initializer_list<std::pair<const std::string, std::string>> words)
        : words_(words) {}

    const std::string& word(const std::string& name) const { return words_.at(name); }
    double number(const std::string& name) const { return std::stod(words_.at(name)); }
    void set(const std::string& name, const std::string& value) { words_.at(name) = value; }
    /// These settings with some of them replaced.
    Settings with(const Settings& others) const;
    /// The settings as "damping=0.3 law=linear ...", sorted by name.
    std::string text() const;

private:
    std::map<std::string, std::string> words_;
};

/// A quantity whose error is measured in a scene.
struct Kind {
    std::string name;
    double tolerance;      ///< of the error
    bool relative = false; ///< the error is relative to the reference; else a difference
    /// Each run has an exact reference; else the reference is another run of the same seed.
    bool exact = false;
};

/// A setting that is varied while all others are constant.
struct Knob {
    std::string label; ///< of its curve
    std::string name;  ///< of the setting
    std::vector<std::string> values;
    Settings with = {};      ///< other settings that differ from the scene's standard
    Settings reference = {}; ///< settings of the reference that differ from standard and `with`
    bool exact = false;      ///< no value may change a bit of the result
};

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

struct Measured {
    double value = unknown, reference = unknown;
};

/// Result of one run.
struct Outcome {
    double wall_time = 0; ///< s, of the steps only if the scene is costly to prepare
    std::uint64_t steps = 0;
    double contacts = 0; ///< number of touching pairs, at the end or as a mean over the run
    std::string fingerprint;
    std::vector<Measured> measured = {}; ///< one for each kind of the scene
    std::string note = {};               ///< reason of a failure, or further information
    std::string compiler = {}, machine = {}, load = {}; ///< when the wall time was measured
};

/// A scene: the settings that are varied, the errors that are measured, and the function that runs
/// it.
struct Scene {
    std::string name, title;
    Settings standard;
    std::vector<Kind> kinds;
    std::vector<Knob> knobs;
    std::function<Outcome(const Settings& settings, std::uint64_t seed)> run;
    const char* cost_unit = ""; ///< what the wall time is for, for example "impact"
};

/// Hash of the measured values as sixteen hexadecimal digits, for runs without a state.
std::string fingerprint_of(const std::vector<Measured>& measured);

/// Median wall time (s) of `rounds` calls, or of fewer if they last `longest` seconds together.
double median_time(unsigned rounds, double longest, const std::function<void()>& call);

Scene single_impacts();
Scene free_top();
Scene gas();
Scene packing();
/// `work` is the folder in which specimens and clump libraries are kept between runs.
Scene triaxial(const std::string& work);

} // namespace bris::time_vs_error
