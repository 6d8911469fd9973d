// Cost of accuracy: settings are varied one at a time in five scenes, and wall time is compared
// with error, with its uncertainty over seeds. An interrupted campaign can be continued.
#include "engine/assets.hpp"
#include "engine/errors.hpp"
#include "engine/scenario.hpp"
#include "tests/performance/time_vs_error/results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <set>

namespace bris::time_vs_error {

namespace {

const std::filesystem::path results_folder =
    assets_folder().parent_path() / "tests/performance/results";

struct Campaign {
    std::string scenes = "S1,S2,S3,S4,S5";
    std::string knobs;
    unsigned seeds = 5;
    std::filesystem::path out = results_folder / "time_vs_error.csv";
    std::filesystem::path plots = results_folder;
    std::filesystem::path work = "results/time_vs_error";
    double longest = 1e9;

    void declare_options(auto& option) {
        option("scenes", scenes, "",
               "Scenes, separated by commas: S1 impacts, S2 rotation, S3 gas, S4 packing, S5 "
               "triaxial test.");
        option("knobs", knobs, "",
               "Beginnings of the names of the curves to run, separated by semicolons, for example "
               "step;skin. Empty: run all.");
        option("seeds", seeds, "", "Number of seeds of each value.", within(1, 1000));
        option("out", out, "", "CSV file of the results. Runs that are in it are not repeated.");
        option("plots", plots, "", "Directory of the PNG files.");
        option("work", work, "", "Directory of the specimens and clump libraries of S5.");
        option("longest", longest, "s",
               "Wall time after which no further run begins. The next campaign continues.",
               above(0));
    }
};

std::vector<std::string> split(const std::string& text, char mark) {
    std::vector<std::string> parts;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t end = std::min(text.find(mark, at), text.size());
        parts.push_back(text.substr(at, end - at));
        at = end + 1;
    }
    return parts;
}

Scene scene_of(const std::string& name, const Campaign& campaign) {
    if (name == "S1") return single_impacts();
    if (name == "S2") return free_top();
    if (name == "S3") return gas();
    if (name == "S4") return packing();
    require(name == "S5", "--scenes: expected some of S1,S2,S3,S4,S5, found '" + name + "'");
    return triaxial(campaign.work.string());
}

class Running {
public:
    Running(const Campaign& campaign) : campaign_(campaign), results_(campaign.out) {}

    /// Runs a scene. Returns false if the time limit is reached.
    bool run(const Scene& scene) {
        for (std::uint64_t seed = 1; seed <= campaign_.seeds; ++seed)
            for (const Knob& knob : scene.knobs)
                if (wanted(knob) && !run(scene, knob, seed)) return false;
        return true;
    }
    const Results& results() const { return results_; }
    bool same_bits() const { return same_bits_; }

private:
    bool wanted(const Knob& knob) const {
        const auto names = split(campaign_.knobs, ';');
        const auto named = [&](const std::string& name) { return knob.label.starts_with(name); };
        return names.empty() || std::any_of(names.begin(), names.end(), named);
    }

    bool run(const Scene& scene, const Knob& knob, std::uint64_t seed) {
        const Settings base = scene.standard.with(knob.with);
        std::optional<Outcome> reference;
        const bool needed = knob.exact || std::any_of(scene.kinds.begin(), scene.kinds.end(),
                                                      [](const Kind& k) { return !k.exact; });
        if (needed && !(reference = obtain(scene, base.with(knob.reference), seed))) return false;
        const auto settings_at = [&](const std::string& value) {
            Settings settings = base;
            settings.set(knob.name, value);
            return settings;
        };
        std::vector<std::string> values =
            knob.values; // the reference comes first, since it has been run and must be recorded
        std::stable_partition(values.begin(), values.end(), [&](const std::string& value) {
            return settings_at(value).text() == base.with(knob.reference).text();
        });
        for (const std::string& value : values) {
            if (results_.has(scene, knob.label, value, seed)) continue;
            const Settings settings = settings_at(value);
            const auto outcome = obtain(scene, settings, seed);
            if (!outcome) return false;
            results_.add(scene, knob, value, settings, seed, *outcome, reference);
            if (knob.exact && outcome->fingerprint != reference->fingerprint) {
                same_bits_ = false;
                fmt::print(stderr, "{} {} = {}, seed {}: different bits\n", scene.name, knob.label,
                           value, seed);
            }
        }
        return true;
    }

    /// Outcome from the file, from this campaign, or by a run. Empty if there is no time for a run.
    std::optional<Outcome> obtain(const Scene& scene, const Settings& settings,
                                  std::uint64_t seed) {
        const std::string key = fmt::format("{} {} {}", scene.name, seed, settings.text());
        if (const auto found = done_.find(key); found != done_.end()) return found->second;
        if (auto found = results_.outcome(scene, settings, seed)) return found;
        if (std::chrono::duration<double>(std::chrono::steady_clock::now() - began_).count() >
            campaign_.longest)
            return {};
        Outcome outcome;
        try {
            outcome = scene.run(settings, seed);
        } catch (const SimulationError& error) { // an unstable setting is a result, too
            outcome = {};
            outcome.note = error.what();
        }
        stamp(outcome);
        fmt::print("{} seed {} {}: {:.3g} s, {} steps; {}\n", scene.name, seed, settings.text(),
                   outcome.wall_time, outcome.steps, outcome.note);
        std::fflush(stdout);
        return done_[key] = outcome;
    }

    const Campaign& campaign_;
    Results results_;
    std::map<std::string, Outcome> done_;
    std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
    bool same_bits_ = true;
};

void run(const Campaign& campaign) {
    std::vector<Scene> scenes;
    for (const std::string& name : split(campaign.scenes, ','))
        scenes.push_back(scene_of(name, campaign));
    Running running(campaign);
    bool complete = true;
    for (const Scene& scene : scenes)
        if (!(complete = running.run(scene))) break;
    std::vector<Summed> everything;
    for (const char* name :
         {"S1", "S2", "S3", "S4", "S5"}) { // results of earlier campaigns are included
        const Scene scene = scene_of(name, campaign);
        const auto all = sum_up(scene, running.results().lines());
        everything.insert(everything.end(), all.begin(), all.end());
        if (std::none_of(scenes.begin(), scenes.end(),
                         [&](const Scene& s) { return s.name == scene.name; }) ||
            all.empty())
            continue;
        print_summed(scene, all);
        print_recommendation(scene, all);
        std::filesystem::create_directories(campaign.plots);
        draw(campaign.plots / fmt::format("time_vs_error_{}.png", scene.name), scene, all);
    }
    std::set<std::string> machines;
    for (const Line& line : running.results().lines())
        machines.insert(line.machine + ", " + line.compiler);
    if (machines.size() > 1)
        fmt::print("\nthese rows mix wall times of {} different machines or compilers\n",
                   machines.size());
    auto summary = campaign.out;
    write_summed(summary.replace_extension().string() + "_summary.csv", everything);
    fmt::print("\n{}; rows in {}\n",
               complete ? "complete" : "time limit reached: run again to continue",
               campaign.out.string());
    if (!running.same_bits())
        throw SimulationError(
            "time_vs_error: expected the same bits with every skin, found others");
}

} // namespace

} // namespace bris::time_vs_error

int main(int argc, char** argv) {
    return bris::detail::exit_code_of("time_vs_error", [&] {
        bris::time_vs_error::Campaign campaign;
        bris::Options options;
        campaign.declare_options(options);
        if (bris::detail::parse_or_answer(
                options, {argv + 1, argv + argc}, "time_vs_error",
                "Compares wall time with error for each setting in five scenes."))
            bris::time_vs_error::run(campaign);
    });
}
