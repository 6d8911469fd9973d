#pragma once

#include "engine/choice.hpp"
#include "engine/named_value.hpp"

#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace bris {

/// The range of numbers that an option accepts. NaN and infinity are never accepted.
struct Range {
    double low = -std::numeric_limits<double>::infinity();
    double high = std::numeric_limits<double>::infinity();
    bool low_accepted = true;
    bool high_accepted = true;
    /// Values outside of these are accepted with a warning.
    double usual_low = -std::numeric_limits<double>::infinity();
    double usual_high = std::numeric_limits<double>::infinity();

    /// The same range with the values that are usual, both ends included.
    Range usually(double lowest, double highest) const {
        Range range = *this;
        range.usual_low = lowest;
        range.usual_high = highest;
        return range;
    }
};

/// Both ends accepted.
inline Range within(double low, double high) { return {.low = low, .high = high}; }
/// The lower end excluded, the upper one accepted.
inline Range above(double low, double high = std::numeric_limits<double>::infinity()) {
    return {.low = low, .high = high, .low_accepted = false};
}
inline Range at_least(double low) { return {.low = low}; }
inline Range at_most(double high) { return {.high = high}; }
inline Range below(double high) { return {.high = high, .high_accepted = false}; }
/// The lower end accepted, the upper one excluded.
inline Range half_open(double low, double high) {
    return {.low = low, .high = high, .high_accepted = false};
}
/// Both ends excluded.
inline Range between(double low, double high) {
    return {.low = low, .high = high, .low_accepted = false, .high_accepted = false};
}

/// Members of a settings struct under the names that a user sees: flags of the command line
/// (`--confining-pressure 110e3`), keys of a config file (`confining_pressure = 110e3`), entries of
/// --help, and keys of the settings written with the results. A struct declares its options itself:
///
///     void declare_options(auto& option) {
///         option("confining_pressure", confining_pressure, "Pa",
///                "Pressure on the membrane.", above(0, 1e8));
///         option("law", law, "", "Contact law.", {"linear", "hertz"});
///     }
///
/// The values that the members have when they are described are the defaults.
class Options {
public:
    /// What a command line requests.
    enum class Request { run, help, version };

    /// Describes a member. Names are snake_case; the unit is "" where there is none. The help is
    /// one or more whole sentences; --help appends the unit, the range, the choices, and the
    /// default unless a sentence of the help begins with "Default:". A list of numbers is given as
    /// `0.01,0.02`; its range holds for each number. A path or a string may be empty.
    void operator()(std::string name, double& value, std::string unit, std::string help,
                    Range range = {});
    void operator()(std::string name, unsigned& value, std::string unit, std::string help,
                    Range range = {});
    void operator()(std::string name, std::uint64_t& value, std::string unit, std::string help,
                    Range range = {});
    void operator()(std::string name, std::vector<double>& value, std::string unit,
                    std::string help, Range range = {});
    void operator()(std::string name, bool& value, std::string unit, std::string help);
    void operator()(std::string name, std::string& value, std::string unit, std::string help,
                    std::vector<std::string> choices = {});
    void operator()(std::string name, std::filesystem::path& value, std::string unit,
                    std::string help);
    template <WithTexts E>
    void operator()(std::string name, E& value, std::string unit, std::string help) {
        add({std::move(name),
             std::move(unit),
             std::move(help),
             Choice{
                 &value,
                 [](const void* p) { return static_cast<std::size_t>(*static_cast<const E*>(p)); },
                 [](void* p, std::size_t k) { *static_cast<E*>(p) = static_cast<E>(k); }},
             Range{},
             texts_of(E{}),
             {}});
    }

    /// Starts a new group in --help.
    void group(std::string title);

    /// Reads the flags into the described members: `--name value`, `--name=value`, and `--name` for
    /// a switch. `--config FILE` is read first, so that flags take precedence. If --help (-h) or
    /// --version is among the flags, nothing is read. Throws InputError, one line with the option
    /// (or file:line: key), what was expected and what was found, and OutputError for an unreadable
    /// config file.
    Request parse(const std::vector<std::string>& arguments);

    /// Sets the described members to those of the settings of another run that have their keys;
    /// text that is empty leaves a member as it is. Throws InputError, beginning with `where`, if a
    /// value is none that the option accepts.
    void take(const std::vector<NamedValue>& settings, const std::string& where);

    /// A line for each option that was set to something unusual (Range::usually), with the question
    /// whether another power of ten of the unit is meant: "--confining-pressure: expected usually
    /// 1000 to 1e+07 Pa, found 55: 55e3?".
    std::vector<std::string> warnings() const;

    /// The text of --help, in lines of at most 100 columns.
    std::string help(const std::string& program, const std::string& description) const;

    /// The current values of all members, in the order of their description; keys carry the unit.
    std::vector<NamedValue> values() const;

    /// A member whose value is no longer its default; the values as a command line gives them.
    struct Change {
        std::string flag, key, value, initially, help;
    };
    std::vector<Change> changes() const;

private:
    /// A value of an enumeration, as the index of its text among the choices of the option.
    struct Choice {
        void* value;
        std::size_t (*get)(const void*);
        void (*set)(void*, std::size_t);
    };
    using Target = std::variant<double*, unsigned*, std::uint64_t*, std::vector<double>*, bool*,
                                std::string*, std::filesystem::path*, Choice>;
    struct Option {
        std::string name, unit, help;
        Target target;
        Range range;
        std::vector<std::string> choices;
        std::string initially;
        std::string text() const; ///< the value as a user would type it
    };
    struct Group {
        std::string title;
        std::size_t first;
    };
    void add(Option option);
    const Option* find(const std::string& name) const;
    const Option* find_flag(const std::string& flag) const;
    std::string nearest(const std::string& name) const;
    void read_config(const std::filesystem::path& file);
    /// The values given with a flag, one for each time that it was given; a switch may have none.
    using Values = std::vector<std::optional<std::string>>;
    /// The values of each option, in the order of their description.
    std::vector<Values> split(const std::vector<std::string>& arguments) const;
    void assign_flag(const Option& option, const Values& values) const;
    [[noreturn]] void reject_unknown(const std::string& found) const;
    static std::string heading(const Option& option);
    static std::string notes(const Option& option);

    std::vector<Option> options_;
    std::vector<Group> groups_;
};

/// The key with the unit as a suffix: ("pressure", "Pa") -> pressure_Pa, ("rate", "1/s") ->
/// rate_per_s, ("density", "kg/m3") -> density_kg_per_m3.
std::string key_with_unit(const std::string& name, const std::string& unit);

} // namespace bris
