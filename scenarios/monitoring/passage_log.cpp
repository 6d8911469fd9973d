#include "scenarios/monitoring/passage_log.hpp"

#include "engine/errors.hpp"
#include "engine/io/whole_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

namespace bris {

PassageLog::PassageLog(const std::filesystem::path& folder) : path_(folder / "history.csv") {
    write_whole(path_, "passage,sensor,verdict,outlier_share,rms_ratio,power_ratio,reason\n");
    file_.reset(std::fopen(path_.c_str(), "a"));
    if (!file_) throw OutputError(fmt::format("cannot write '{}'", path_.string()));
}

void PassageLog::write(const PassageResult& passage) {
    const auto cell = [](double x) { return std::isfinite(x) ? fmt::format("{:.6g}", x) : ""; };
    std::string text;
    for (const SensorResult& s : passage.sensors) {
        std::string reason = s.reason;
        std::ranges::replace(reason, '"', '\'');
        text +=
            fmt::format("\"{}\",{},{},{},{},{},\"{}\"\n", passage.name, s.id, text_of(s.verdict),
                        cell(s.outlier_share), cell(s.level_ratio), cell(s.power_ratio), reason);
    }
    const bool written = std::fwrite(text.data(), 1, text.size(), file_.get()) == text.size();
    if (std::fflush(file_.get()) != 0 || !written)
        throw OutputError(fmt::format("cannot write '{}': is the disk full?", path_.string()));
}

void PassageLog::add(PassageResult passage) {
    write(passage);
    ++count_;
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
