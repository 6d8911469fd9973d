#include "scenarios/records/quality_control_report.hpp"

#include "engine/io/csv.hpp"
#include "scenarios/records/machine_quality_control.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

/// Items with the same text, in the order in which the texts first occur.
template <class Item>
std::vector<std::pair<std::string, std::vector<Item>>>
grouped(const std::vector<std::pair<Item, std::string>>& texts) {
    std::vector<std::pair<std::string, std::vector<Item>>> groups;
    for (const auto& [item, text] : texts) {
        auto group = std::ranges::find(groups, text, [](const auto& g) { return g.first; });
        if (group == groups.end()) group = groups.insert(groups.end(), {text, {}});
        group->second.push_back(item);
    }
    return groups;
}

/// "3", "1, 2", "1 to 4, 7".
std::string ranges_of(std::vector<unsigned> ids) {
    std::ranges::sort(ids);
    std::string text;
    for (std::size_t first = 0, next = 0; first < ids.size(); first = next) {
        while (next < ids.size() && ids[next] - ids[first] == next - first) ++next;
        if (next - first == 2) --next; // two numbers are no range
        text += fmt::format("{}{}", text.empty() ? "" : ", ", ids[first]);
        if (next - first > 1) text += fmt::format(" to {}", ids[next - 1]);
    }
    return text;
}

std::string sensors(const std::vector<unsigned>& ids) {
    return fmt::format("sensor{} {}", ids.size() == 1 ? "" : "s", ranges_of(ids));
}

std::vector<unsigned> refused_sensors(const RecordedTest& test) {
    std::vector<unsigned> ids;
    for (const Recording& r : test.recordings)
        if (!accepted(test.findings, r.info.id)) ids.push_back(r.info.id);
    return ids;
}

std::string report_on_machine(const RecordedTest& test) {
    const std::string refused = refused_channels(test);
    std::string text = fmt::format("test machine: accepted, {} records{}\n", test.curves.size(),
                                   refused == "none" ? "" : ", except " + refused);
    for (const auto kind : {Finding::Kind::refusal, Finding::Kind::note}) {
        std::vector<std::pair<std::string, std::string>> texts; // channel and finding
        for (const Finding& f : test.findings)
            if (f.sensor == test_machine && f.kind == kind) texts.emplace_back(f.check, f.text);
        for (const auto& [finding, channels] : grouped(texts))
            text += fmt::format("test machine: {}{}: {}\n",
                                kind == Finding::Kind::refusal ? "refused: " : "", listed(channels),
                                finding);
    }
    return text;
}

/// Whether q or the volumetric strain of the test is known.
bool machine_informs(const RecordedTest& test) {
    for (std::size_t k = 0; k < test.curves.size(); ++k)
        if (test.curves[quantity::axial_strain][k] > 0 &&
            (std::isfinite(test.curves[quantity::deviatoric_stress][k]) ||
             std::isfinite(test.curves[quantity::volumetric_strain][k])))
            return true;
    return false;
}

} // namespace

std::string lines_by_sensor(const std::vector<std::pair<unsigned, std::string>>& texts) {
    std::string lines;
    for (const auto& [text, ids] : grouped(texts))
        lines += fmt::format("{}: {}\n", sensors(ids), text);
    return lines;
}

std::string quality_control_report(const std::vector<Finding>& findings,
                                   const std::vector<Recording>& recordings) {
    std::vector<std::pair<unsigned, std::string>> verdicts, refusals, notes;
    for (const Recording& r : recordings) {
        if (accepted(findings, r.info.id))
            verdicts.emplace_back(r.info.id, fmt::format("accepted, {} samples", r.size()));
        for (const Finding& f : findings) {
            if (f.sensor != r.info.id) continue;
            if (f.kind == Finding::Kind::refusal)
                refusals.emplace_back(f.sensor, fmt::format("refused: {}: {}", f.check, f.text));
            else
                notes.emplace_back(f.sensor, fmt::format("{}: {}", f.check, f.text));
        }
    }
    return lines_by_sensor(verdicts) + lines_by_sensor(refusals) + lines_by_sensor(notes);
}

std::string quality_control_report(const RecordedTest& test) {
    return report_on_machine(test) + quality_control_report(test.findings, test.recordings);
}

std::string observability_report(const RecordedTest& test, double duration,
                                 double displacement_deviation, double rotation_deviation) {
    std::vector<std::pair<unsigned, std::string>> rows;
    for (const Recording& r : test.recordings) {
        if (!accepted(test.findings, r.info.id)) continue;
        for (const Observability& entry :
             observability_of(r, duration, displacement_deviation, rotation_deviation)) {
            const bool is_angle = entry.direction == "tilt" || entry.direction == "yaw";
            rows.emplace_back(
                r.info.id,
                fmt::format(
                    "{:<9}  {:<22}  {:>9} {:<3}  {:9.2g} {:<3}  {:4.2f}  {}", entry.direction,
                    entry.source,
                    std::isfinite(entry.deviation) ? fmt::format("{:.2g}", entry.deviation) : "-",
                    is_angle ? "rad" : "m", is_angle ? rotation_deviation : displacement_deviation,
                    is_angle ? "rad" : "m", entry.gain,
                    entry.observable() ? "observable" : "not observable"));
        }
    }
    if (rows.empty()) return "No sensor is accepted, so none observes anything.\n";
    std::string text = fmt::format(
        "What the accepted sensors observe of the motion of their rocks at the end of the test, "
        "after {:.4g} s.\n"
        "deviation: standard deviation of what the channel measures; model: that of the model's "
        "motion\n(--displacement-deviation, --rotation-deviation of smart_triaxial); gain: "
        "share of the model's variance that the\nmeasurement removes, from 0 (none) to 1 (all); "
        "observable: gain above {:g}.\n",
        duration, Observability::least_gain);
    text +=
        fmt::format("{:<13}  {:<9}  {:<22}  {:<13}  {:<13}  {:<4}  {}\n", "sensors", "direction",
                    "channel", "    deviation", "        model", "gain", "verdict");
    for (const auto& [row, ids] : grouped(rows))
        text += fmt::format("{:<13}  {}\n", ranges_of(ids), row);
    return text;
}

std::string refused_channels(const RecordedTest& test) {
    std::vector<std::string> channels;
    for (const Finding& f : test.findings)
        if (f.sensor == test_machine && f.kind == Finding::Kind::refusal)
            channels.push_back(f.check);
    return channels.empty() ? "none" : listed(channels);
}

std::string verdict_on(const RecordedTest& test) {
    const std::vector<unsigned> refused = refused_sensors(test);
    const std::size_t all = test.recordings.size();
    const std::string channels = refused_channels(test);
    std::string text = refused.empty() ? fmt::format("all {} sensors are accepted", all)
                       : refused.size() == all
                           ? fmt::format("all {} sensors are refused", all)
                           : fmt::format("{} of {} sensors are accepted, refused: {}",
                                         all - refused.size(), all, sensors(refused));
    text += channels == "none"
                ? "; the test machine is accepted"
                : fmt::format("; refused and not used of the test machine: {}", channels);
    if (refused.size() < all) return text;
    return text + (machine_informs(test) ? "; the model learns from the test machine alone"
                                         : "; nothing is left that the model could learn from");
}

} // namespace bris
