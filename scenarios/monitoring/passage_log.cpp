#include "scenarios/monitoring/passage_log.hpp"

#include "engine/errors.hpp"
#include "engine/io/whole_file.hpp"
#include "scenarios/monitoring/features.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

namespace bris {

PassageLog::PassageLog(const std::filesystem::path& folder) : path_(folder / "history.csv") {
    std::string head = "passage,revision,state,sensor,verdict,rms_ratio,seen_below,seen_above";
    for (const Feature& feature : all_features()) head += fmt::format(",{}", feature.name);
    for (const auto reading : readings) head += fmt::format(",outside_{}", reading);
    write_whole(path_, head + ",reason\n");
    file_.reset(std::fopen(path_.c_str(), "a"));
    if (!file_) throw OutputError(fmt::format("cannot write '{}'", path_.string()));
}

void PassageLog::write(const PassageResult& passage) {
    const auto cell = [](double x) { return std::isfinite(x) ? fmt::format("{:.6g}", x) : ""; };
    std::string text;
    for (const SensorResult& s : passage.sensors) {
        std::string reason = s.reason;
        std::ranges::replace(reason, '"', '\'');
        text += fmt::format("\"{}\",{},{},{},\"{}\",{},{},{}", passage.name, passage.revision,
                            passage.is_final ? "final" : "provisional", s.id, text_of(s.verdict),
                            cell(s.level_ratio()), cell(s.seen_below()), cell(s.seen_above()));
        for (std::size_t f = 0; f < all_features().size(); ++f) // standard deviations
            text += "," + (s.features.empty()
                               ? ""
                               : cell(s.features[f].difference / s.features[f].deviation));
        for (const double share : s.outlier_shares) text += "," + cell(share);
        text += fmt::format(",\"{}\"\n", reason);
    }
    const bool written = std::fwrite(text.data(), 1, text.size(), file_.get()) == text.size();
    if (std::fflush(file_.get()) != 0 || !written)
        throw OutputError(fmt::format("cannot write '{}': is the disk full?", path_.string()));
}

void PassageLog::add(PassageResult passage, const std::vector<std::uint64_t>& replaces) {
    write(passage);
    const auto forget = [&](std::uint64_t id) {
        const auto counted = provisional_.find(id);
        if (counted == provisional_.end()) return;
        tally_.add(counted->second, -1);
        provisional_.erase(counted);
        std::erase_if(kept_, [&](const PassageResult& one) { return one.id == id; });
    };
    forget(passage.id);
    for (const std::uint64_t id : replaces) forget(id);
    tally_.add(verdict_on(passage));
    if (!passage.is_final) provisional_[passage.id] = verdict_on(passage);
    kept_.push_back(std::move(passage));
    std::set<unsigned> ids;
    for (const PassageResult& one : kept_)
        for (const SensorResult& s : one.sensors) ids.insert(s.id);
    std::set<const SensorResult*> shown; // with all details
    std::set<const PassageResult*> serious;
    for (const unsigned id : ids) {
        const MostSerious worst = most_serious_result(kept_, id);
        shown.insert(worst.sensor);
        serious.insert(worst.passage);
    }
    for (PassageResult& one : kept_) {
        if (!serious.contains(&one)) one.findings = {};
        for (SensorResult& s : one.sensors)
            if (!shown.contains(&s)) {
                s.points = {};
                s.spectrum = {};
            }
    }
    if (kept_.size() <= most_last) return;
    const auto last = kept_.end() - static_cast<std::ptrdiff_t>(most_last);
    std::vector<PassageResult> remaining;
    for (auto at = kept_.begin(); at != kept_.end(); ++at)
        if (at >= last || serious.contains(&*at)) remaining.push_back(std::move(*at));
    kept_ = std::move(remaining);
}

} // namespace bris
