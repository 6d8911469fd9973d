#include "scenarios/library/library_join.hpp"

#include "engine/errors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

namespace bris {

namespace {

constexpr std::array lowest{"lowest_friction", "lowest_stiffness", "lowest_porosity"},
    highest{"highest_friction", "highest_stiffness", "highest_porosity"};
/// Settings that are not of the single specimen, besides the ranges.
constexpr std::array of_design{"seed", "packings", "longest_preparation"};

const NamedValue* find(const std::vector<NamedValue>& settings, const std::string& key) {
    const auto at = std::ranges::find(settings, key, &NamedValue::key);
    return at == settings.end() ? nullptr : &*at;
}

bool may_differ(const std::string& key) {
    return std::ranges::count(lowest, key) > 0 || std::ranges::count(highest, key) > 0 ||
           std::ranges::count(of_design, key) > 0;
}

void require_same_specimens(const SpecimenLibrary& a, const SpecimenLibrary& b,
                            const std::string& where) {
    for (const NamedValue& theirs : b.settings) {
        const NamedValue* ours = find(a.settings, theirs.key);
        if (may_differ(theirs.key) || (ours && ours->text() == theirs.text())) continue;
        throw InputError(fmt::format("{}: expected specimens with {} {}, as the library has, found "
                                     "{}",
                                     where, theirs.key, ours ? ours->text() : "of its own",
                                     theirs.text()));
    }
    require(a.pressures == b.pressures && a.axis.count == b.axis.count &&
                std::abs(a.axis.step - b.axis.step) < 1e-12 && a.rings == b.rings &&
                a.sensors == b.sensors,
            fmt::format("{}: expected the pressures, strains, rings and sensor rocks of the "
                        "library, found others",
                        where));
}

/// Widens the ranges among the settings, so that they include those of the other library.
void widen(std::vector<NamedValue>& settings, const std::vector<NamedValue>& others) {
    const auto choose = [&](const std::string& key, const auto& better) {
        const NamedValue* theirs = find(others, key);
        const auto ours = std::ranges::find(settings, key, &NamedValue::key);
        if (theirs == nullptr || ours == settings.end()) return;
        if (better(std::stod(theirs->text()), std::stod(ours->text()))) ours->value = theirs->value;
    };
    for (const char* key : lowest) choose(key, std::less<>());
    for (const char* key : highest) choose(key, std::greater<>());
}

} // namespace

void join(SpecimenLibrary& library, const SpecimenLibrary& other,
          const std::filesystem::path& name) {
    const std::string where = fmt::format("--join '{}'", name.string());
    require_same_specimens(library, other, where);
    std::set<std::uint64_t> packings;
    std::uint64_t last = 0;
    for (const LibrarySpecimen& s : library.specimens) {
        packings.insert(s.seed);
        last = std::max(last, s.number);
    }
    for (const std::uint64_t number : library.given_up) last = std::max(last, number);
    for (LibrarySpecimen s : other.specimens) {
        require(packings.insert(s.seed).second,
                fmt::format("{}: expected packings that the library does not have, found the one "
                            "with the seed {} in both",
                            where, s.seed));
        s.number += last;
        library.add(std::move(s));
    }
    for (const std::uint64_t number : other.given_up) library.given_up.push_back(number + last);
    widen(library.settings, other.settings);
}

} // namespace bris
