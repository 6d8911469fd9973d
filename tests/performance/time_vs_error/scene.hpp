#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <string>
#include <vector>

namespace bris::time_vs_error {

/// What a run is told, as words: the columns of the CSV can hold them, and two runs are the same if
/// their texts are.
class Settings {
public:
    Settings() = default;
    Settings(std::initializer_list<std::pair<const std::string, std::string>> words)
        : words_(words) {}

    const std::string& word(const std::string& name) const { return words_.at(name); }
    double number(const std::string& name) const { return std::stod(words_.at(name)); }
    void set(const std::string& name, const std::string& value) { words_.at(name) = value; }
    /// These settings but for some.
    Settings with(const Settings& others) const;
    /// "damping=0.3 law=linear ...", by name.
    std::string text() const;

private:
    std::map<std::string, std::string> words_;
};

/// A quantity that a scene is judged by.
struct Kind {
    std::string name;
    double tolerance;      ///< of the error
    bool relative = false; ///< error over the reference; else the difference
    bool exact =
        false; ///< each run knows its own reference; else it is another run of the same seed
};

/// One setting that is varied while the others stay.
struct Knob {
    std::string label; ///< of its curve
    std::string name;  ///< of the setting
    std::vector<std::string> values;
    Settings with = {};      ///< what else differs from the scene's standard
    Settings reference = {}; ///< what the reference differs by, from the standard and `with`
    bool exact = false;      ///< no value may change a bit of the result
};

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

struct Measured {
    double value = unknown, reference = unknown;
};

/// What one run came to.
struct Outcome {
    double wall_time = 0; ///< s, of the steps alone where a scene is costly to prepare
    std::uint64_t steps = 0;
    double contacts = 0; ///< touching pairs: at the end, or the mean over the run
    std::string fingerprint;
    std::vector<Measured> measured = {};                ///< one for each kind of the scene
    std::string note = {};                              ///< why a run failed, or what else it says
    std::string compiler = {}, machine = {}, load = {}; ///< of the wall time
};

/// A scene of section 6 of the accuracy reference: what is varied, how it is judged, how it is run.
struct Scene {
    std::string name, title;
    Settings standard;
    std::vector<Kind> kinds;
    std::vector<Knob> knobs;
    std::function<Outcome(const Settings& settings, std::uint64_t seed)> run;
    const char* cost_unit = ""; ///< of which the wall time is one
};

/// Hash of what was measured, for runs that keep no state: sixteen hexadecimal digits.
std::string fingerprint_of(const std::vector<Measured>& measured);

/// Median wall time (s) of `rounds` calls, or of fewer if they last `longest` seconds together.
double median_time(unsigned rounds, double longest, const std::function<void()>& call);

Scene single_impacts();
Scene free_top();
Scene gas();
Scene packing();
/// `work`: where specimens and clump libraries are kept between runs.
Scene triaxial(const std::string& work);

} // namespace bris::time_vs_error
