#include "scenarios/sensors/column_titles.hpp"

#include "engine/io/csv.hpp"
#include "scenarios/sensors/channels.hpp"
#include "scenarios/sensors/unit_words.hpp"

#include <algorithm>
#include <cctype>
#include <map>
#include <vector>

namespace bris {

namespace {

/// Usual names, in small letters without punctuation, of columns that are of no channel.
const std::map<std::string, std::string_view>& titles_of_others() {
    static const std::map<std::string, std::string_view> all{
        {"t", "t time timestamp elapsedtime sampletime zeit"},
        {"id", "id sensor sensorid node nodeid device deviceid rock rockid nr address"},
        {"axial_strain", "axialstrain strain epsa epsilona ea epax"},
        {"deviatoric_stress_Pa", "q deviatoricstress deviatorstress devstress"},
        {"volumetric_strain", "volumetricstrain volstrain epsv epsilonv ev epv"},
        {"axial_displacement_m", "axialdisplacement displacement axialdeformation deformation weg"},
        {"axial_force_N", "axialforce force axialload load deviatorload kraft"},
        {"volume_change_m3", "volumechange volchange deltav dv"},
        {"confining_pressure_Pa",
         "confiningpressure cellpressure radialstress sigmar sigrad sigma3 s3"}};
    return all;
}

std::string plain(std::string_view text) {
    std::string letters;
    for (const char c : text)
        if (std::isalnum(static_cast<unsigned char>(c)))
            letters += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return letters;
}

/// Whether one of the titles is the name, or the name without `axis` before or after it.
bool is_one_of(std::string_view titles, const std::string& name, const std::string& axis = "") {
    return std::ranges::any_of(cells_of(titles, ' '), [&](std::string_view cell) {
        const std::string title(cell);
        return name == title + axis || name == axis + title ||
               (!axis.empty() && (name == title + "axis" + axis || name == axis + "axis" + title));
    });
}

bool is_called(const std::string& name, const std::string& ours) {
    const Channel* channel = channel_with(ours);
    if (channel == nullptr) {
        const auto other = titles_of_others().find(ours);
        return other == titles_of_others().end() ? name == plain(ours)
                                                 : is_one_of(other->second, name);
    }
    if (channel->size() == 1) return is_one_of(channel->names.titles, name);
    const std::string axis = ours.substr(ours.size() - 1);
    const auto number = std::string_view("wxyz").find(axis); // q0 q1 q2 q3
    return is_one_of(channel->names.titles, name, axis) ||
           (channel->size() == 4 &&
            is_one_of(channel->names.titles, name, std::string(1, "0123"[number])));
}

/// Name and unit of "Time, ms", "acc_x_mg", "Time/s" or "timeMs", if the last word is one of these
/// units.
std::optional<std::pair<std::string, std::string>>
split_last_word(const std::string& title, const std::vector<ColumnUnit>& units) {
    for (auto at = title.find_first_of("_ ,/"); at != std::string::npos;
         at = title.find_first_of("_ ,/", at + 1))
        if (const std::string word = title.substr(at + 1);
            word != "1" && !unit_named(word, units).empty()) // "strain_1" is the first strain
            return std::pair{title.substr(0, at), word};
    for (const std::string_view word : {"Ms", "ms", "Us", "us", "Ns", "ns", "Seconds"})
        if (title.size() > word.size() + 3 && title.ends_with(word)) {
            const std::string unit = plain(word);
            if (!unit_named(unit, units).empty())
                return std::pair{title.substr(0, title.size() - word.size()), unit};
        }
    return {};
}

/// Name and unit of "epsv = dV/V0 [%] (dilation is negative)": the text before the first bracket
/// and before a sign of equality, and the first bracket that holds one of these units.
std::optional<std::pair<std::string, std::string>>
split_explained(const std::string& title, const std::vector<ColumnUnit>& units) {
    const auto first = title.find_first_of("[(=");
    for (auto open = title.find_first_of("[("); open != std::string::npos;
         open = title.find_first_of("[(", open + 1)) {
        const auto close = title.find_first_of("])", open);
        if (close == std::string::npos) break;
        const std::string word(trimmed(title.substr(open + 1, close - open - 1)));
        if (!unit_named(word, units).empty()) return std::pair{title.substr(0, first), word};
    }
    return {};
}

} // namespace

std::optional<TitleMatch> match_title(const std::string& title, const KnownColumn& column) {
    // a unit in the name of BRIS itself: deviatoric_stress_Pa, ring_1_radius_m
    if (title == column.name) {
        const auto mark = title.rfind('_');
        const std::string last = mark == std::string::npos ? "" : title.substr(mark + 1);
        return unit_named(last, column.units).empty() ? TitleMatch{} : TitleMatch{last};
    }
    if (const auto open = title.find_last_of("[("), close = title.find_last_of("])");
        open != std::string::npos && close != std::string::npos && close > open) {
        const std::string word(trimmed(title.substr(open + 1, close - open - 1)));
        const bool is_other = unit_named(word, column.units).empty() && is_unit(word);
        if (is_other) return {}; // "T [C]" is no time
        if (is_called(plain(title.substr(0, open) + title.substr(close + 1)), column.name))
            return word.empty() ? TitleMatch{} : TitleMatch{word};
        const auto split = split_explained(title, column.units);
        if (split && is_called(plain(split->first), column.name)) return TitleMatch{split->second};
        return {};
    }
    if (is_called(plain(title), column.name)) return TitleMatch{};
    if (const auto split = split_last_word(title, column.units))
        if (is_called(plain(split->first), column.name)) return TitleMatch{split->second};
    if (column.name == "t") { // called by its unit: millis, "seconds elapsed"
        constexpr std::string_view more = "elapsed";
        std::string word = plain(title);
        if (word.ends_with(more)) word.erase(word.size() - more.size());
        if (word.size() > 4 && !unit_named(word, column.units).empty()) return TitleMatch{word};
    }
    return {};
}

} // namespace bris
