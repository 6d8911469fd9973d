#include "engine/errors.hpp"
#include "engine/io/whole_file.hpp"
#include "engine/random.hpp"
#include "engine/signal/median.hpp"
#include "scenarios/monitoring/features.hpp"
#include "scenarios/monitoring/site_verdict.hpp"
#include "scenarios/monitoring/synthetic_vibration.hpp"
#include "tests/detection.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <limits>
#include <sstream>

using namespace bris;

namespace {

const SyntheticVibration vibration{.sensors = 2, .lead = 1.2, .duration = 4};
constexpr std::uint64_t seed = 7;

Passage passage(const char* state, unsigned number) {
    return synthetic_passage(vibration, synthetic_state(state), seed, number, state);
}

const std::vector<SensorBaseline>& baselines() {
    static const std::vector<SensorBaseline> all = [] {
        std::vector<Passage> good;
        for (unsigned k = 1; k <= 8; ++k) good.push_back(passage("clean", k));
        return baselines_of(good, {});
    }();
    return all;
}

PassageResult judged(const Passage& p, const MonitorSettings& settings = {}) {
    return judge_passage(p, baselines(), settings);
}

/// The result of the first sensor after `mutate` has changed its recording.
SensorResult after(const std::function<void(Recording&)>& mutate, const char* state = "clean") {
    Passage p = passage(state, 20);
    mutate(p.recordings[0]);
    return judged(p).sensors[0];
}

template <class T>
void erase_range(std::vector<T>& values, std::size_t first, std::size_t count) {
    if (values.empty()) return;
    values.erase(values.begin() + static_cast<std::ptrdiff_t>(first),
                 values.begin() + static_cast<std::ptrdiff_t>(first + count));
}

void lose(Recording& r, std::size_t first, std::size_t count) {
    erase_range(r.time, first, count);
    erase_range(r.sequence, first, count);
    erase_range(r.force, first, count);
    erase_range(r.rate, first, count);
}

Verdict together(const std::vector<PassageResult>& passages) {
    return overall_verdict(judge_together(passages, baselines(), 0.02)).verdict;
}

bool mentions(const SensorResult& s, const char* word) {
    return s.reason.find(word) != std::string::npos;
}

} // namespace

TEST_SUITE("monitoring/sensor_verdict") {
    TEST_CASE(
        "a passage like the baseline is as the baseline, and twice the vibration is a change") {
        for (const SensorBaseline& b : baselines()) {
            CAPTURE(b.impossible_because);
            REQUIRE(b.impossible_because.empty());
            CHECK(b.features.passages() == 8);
        }
        std::size_t clean = 0, fouled = 0;
        for (unsigned k = 30; k < 40; ++k) {
            clean += together({judged(passage("clean", k))}) == Verdict::as_baseline;
            fouled += is_change(together({judged(passage("fouled", k))}));
        }
        CHECK(clean == 10);
        CHECK(fouled == 10);
    }

    TEST_CASE("each fault is named and leads to no all-clear") {
        const double nan = std::numeric_limits<double>::quiet_NaN();
        struct Fault {
            const char* word;
            std::function<void(Recording&)> mutate;
        };
        const std::vector<Fault> faults{
            {"numbers", [&](Recording& r) { r.force[300].y() = nan; }},
            {"gaps", [](Recording& r) { lose(r, 500, 200); }},
            {"too short", [](Recording& r) { lose(r, 400, r.size() - 400); }},
            {"no samples", [](Recording& r) { lose(r, 0, r.size()); }},
            {"gravity",
             [](Recording& r) {
                 for (Vec3& f : r.force) f /= standard_gravity;
             }},
            {"gravity",
             [](Recording& r) {
                 for (Vec3& f : r.force) f *= standard_gravity;
             }},
            {"rate",
             [](Recording& r) {
                 for (Vec3& w : r.rate) w = 180 / pi * (w + Vec3(0.002, 0.002, 0.002));
             }},
            {"saturation",
             [](Recording& r) {
                 for (std::size_t k = 500; k < 505; ++k) r.force[k].x() = r.info.force_range;
             }},
            {"stuck",
             [](Recording& r) {
                 for (std::size_t k = 600; k < 800; ++k) r.force[k] = r.force[600];
             }},
            {"twice", [](Recording& r) { r.time[100] = r.time[99]; }},
            {"order", [](Recording& r) { std::swap(r.time[100], r.time[200]); }},
            {"gaps",
             [](Recording& r) {
                 for (double& t : r.time) t *= 1000;
             }}, // milliseconds
            {"sampling rate",
             [](Recording& r) {
                 r.info.sampling_rate = 100;
                 for (double& t : r.time) t *= 2;
             }},
            {"sampling_rate",
             [](Recording& r) { // milliseconds taken for kiloseconds
                 r.sequence.clear();
                 for (double& t : r.time) t /= 1000;
             }},
            {"they seem to be in deg/s",
             [](Recording& r) {
                 // without the bias, by which quality control would tell
                 const Vec3 bias = median(std::vector(r.rate.begin(), r.rate.begin() + 200));
                 for (Vec3& w : r.rate) w = 180 / pi * (w - bias);
             }},
            {"they seem to be in rad/s",
             [](Recording& r) {
                 for (Vec3& w : r.rate) w *= pi / 180;
             }},
            {"no acceleration", [](Recording& r) { r.force.clear(); }},
            {"of the baseline", [](Recording& r) { r = passage("clean", 3).recordings[0]; }}};
        for (const Fault& fault : faults)
            for (const char* state : {"clean", "fouled"}) {
                const SensorResult s = after(fault.mutate, state);
                CAPTURE(fault.word);
                CAPTURE(s.reason);
                CHECK(s.verdict == Verdict::not_enough_data);
                CHECK(mentions(s, fault.word));
            }
    }

    TEST_CASE("a sensor that hardly moves while others do is quieter, and a turned one is moved") {
        const SensorResult quiet = after([](Recording& r) {
            const Vec3 still = r.force[0];
            for (Vec3& f : r.force) f = still + 0.02 * (f - still);
        });
        CAPTURE(quiet.reason);
        CHECK(quiet.verdict == Verdict::quieter);
        CHECK(quiet.level_ratio() < 0.1);
        const auto turned = [](double angle, const Vec3& axis) {
            return [=](Recording& r) {
                const Mat3 turn = Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
                for (Vec3& f : r.force) f = turn * f;
                for (Vec3& w : r.rate) w = turn * w;
            };
        };
        for (const double angle : {0.3, 1.5, 3.1}) {
            const SensorResult s = after(turned(angle, Vec3(1, 0.3, 0.2)));
            CAPTURE(s.reason);
            CHECK(s.verdict == Verdict::moved);
            CHECK(mentions(s, "as the baseline"));
            const SensorResult fouled = after(turned(angle, Vec3(1, 0.3, 0.2)), "fouled");
            CAPTURE(fouled.reason);
            CHECK(fouled.verdict == Verdict::moved);
            CHECK(mentions(fouled, "times"));
        }
        CHECK(together({judged(passage("clean", 22))}) == Verdict::as_baseline);
    }

    TEST_CASE("no train needs other sensors: one alone is quieter, or there was no train") {
        Passage idle = passage("clean", 21);
        for (Recording& r : idle.recordings) {
            const Vec3 still = r.force[0];
            for (Vec3& f : r.force) f = still + 0.03 * (f - still);
        }
        const PassageResult both = judged(idle);
        CHECK(both.sensors[0].verdict == Verdict::no_train);
        CHECK(together({both}) == Verdict::not_enough_data);
        CHECK(together({both, judged(passage("clean", 22))}) ==
              Verdict::as_baseline); // an idle passage does not count
        Passage alone = idle;
        alone.recordings.pop_back();
        const PassageResult one = judge_passage(alone, {baselines()[0]}, {});
        CHECK(one.sensors[0].verdict == Verdict::quieter_or_no_train);
        CHECK(is_not_judged(one.sensors[0].verdict));
        // declared to hold a train, it is judged as a whole
        MonitorSettings every;
        every.every_one = true;
        std::vector<Passage> good;
        for (unsigned k = 1; k <= 8; ++k) {
            good.push_back(passage("clean", k));
            good.back().recordings.pop_back();
        }
        const auto whole = judge_passage(alone, baselines_of(good, every), every);
        CAPTURE(whole.sensors[0].reason);
        CHECK(whole.sensors[0].verdict == Verdict::quieter);
    }

    TEST_CASE("an unknown sensor is not judged") {
        Passage unknown = passage("clean", 23);
        unknown.recordings[1].info.id = 9;
        const PassageResult p = judged(unknown);
        REQUIRE(p.sensors.size() == 3);
        CHECK(mentions(p.sensors[1], "no recording"));
        CHECK(mentions(p.sensors[2], "no such sensor"));
        CHECK(together({p}) == Verdict::not_enough_data);
        CHECK(together({}) == Verdict::not_enough_data);
    }

    TEST_CASE("two trains in one recording with quiet between them are as the baseline") {
        // the quiet is made of samples of the recording itself, as on a real track
        for (const double quiet : {5.0, 30.0}) {
            Passage two = passage("clean", 50);
            const Passage second = passage("clean", 51);
            for (std::size_t s = 0; s < two.recordings.size(); ++s) {
                Recording& r = two.recordings[s];
                const Recording& other = second.recordings[s];
                Random random(3, s);
                const double step = 1 / r.info.sampling_rate;
                const auto add = [&](const Vec3& force, const Vec3& rate) {
                    r.time.push_back(r.time.back() + step);
                    r.sequence.push_back(r.sequence.back() + 1);
                    r.force.push_back(force);
                    r.rate.push_back(rate);
                };
                for (int k = 0; k < quiet * r.info.sampling_rate; ++k) {
                    const auto from = static_cast<std::size_t>(random.uniform() * 140);
                    add(Vec3(r.force[from]), Vec3(r.rate[from]));
                }
                for (std::size_t k = 0; k < other.size(); ++k) add(other.force[k], other.rate[k]);
            }
            const PassageResult p = judged(two);
            for (const SensorResult& s : p.sensors) {
                CAPTURE(s.reason);
                CHECK(s.verdict == Verdict::as_baseline);
            }
        }
    }

    TEST_CASE("fewer than four passages are no baseline, and an unstated cause is none") {
        std::vector<Passage> good;
        for (unsigned k = 1; k <= 3; ++k) good.push_back(passage("clean", k));
        const auto few = judge_passage(passage("clean", 24), baselines_of(good, {}), {});
        CHECK(few.sensors[0].verdict == Verdict::not_enough_data);
        CHECK(mentions(few.sensors[0], "at least 4 passages"));
        for (unsigned k = 4; k <= 8; ++k) good.push_back(passage("clean", k));
        for (std::size_t k = 0; k < good.size(); ++k)
            good[k].cause = {"freight", "", {{"speed_m_s", 20.0 + static_cast<double>(k)}}};
        const auto by_speed = baselines_of(good, {});
        Passage now = passage("clean", 24);
        CHECK(mentions(judge_passage(now, by_speed, {}).sensors[0], "at least 4 passages"));
        now.cause.condition = "freight";
        CHECK(
            mentions(judge_passage(now, by_speed, {}).sensors[0], "speed_m_s: expected a number"));
        now.cause.numbers["speed_m_s"] = 40;
        CHECK(mentions(judge_passage(now, by_speed, {}).sensors[0], "expected 20 to 27"));
        now.cause.numbers["speed_m_s"] = 23;
        CHECK(judge_passage(now, by_speed, {}).sensors[0].verdict == Verdict::as_baseline);
    }

    TEST_CASE("a baseline that is none gives no verdict, with its reason") {
        const PassageResult p =
            judge_passage(passage("clean", 24), baselines_of({}, {}), MonitorSettings{});
        CHECK(mentions(p.sensors[0], "no baseline"));
        Passage broken = passage("clean", 1);
        broken.recordings[0].force[10].x() = std::nan("");
        const auto few = baselines_of({broken}, {});
        CHECK(few[0].impossible_because.find("numbers") != std::string::npos);
        CHECK(few[1].impossible_because.find("expected at least 1030 samples") !=
              std::string::npos);
        CHECK(judge_passage(passage("clean", 24), few, {}).sensors[0].verdict ==
              Verdict::not_enough_data);
    }

    TEST_CASE("ratios and features are those of the synthetic state") {
        const auto s = judged(passage("fouled", 31)).sensors[0];
        CHECK(s.level_ratio() == doctest::Approx(2).epsilon(0.25));
        const auto ratio = [&](std::string_view name) {
            const auto at = std::ranges::find(all_features(), name, &Feature::name);
            return std::exp(
                s.features[static_cast<std::size_t>(at - all_features().begin())].difference);
        };
        CHECK(ratio("level_total") == doctest::Approx(2).epsilon(0.25));
        CHECK(ratio("roll_rate") == doctest::Approx(4).epsilon(0.4));
        CHECK(ratio("pitch_rate") == doctest::Approx(2).epsilon(0.4));
        CHECK(s.outlier_shares[0] > 0.1);
        CHECK(s.outlier_shares[1] < s.outlier_shares[0]); // standardised: the level is gone
    }
}

// ---- mutated files --------------------------------------------------------------------------

namespace {

/// A fault in the text of a recording.
using Mutation = std::function<void(std::vector<std::string>& lines, Random& random)>;

std::size_t any_of(Random& random, std::size_t n) {
    return static_cast<std::size_t>(random.uniform() * static_cast<double>(n));
}

/// Changes a cell of some rows of sensor 1 by `change`.
void change_cells(std::vector<std::string>& lines, std::size_t first, std::size_t count,
                  std::size_t column,
                  const std::function<std::string(const std::string&)>& change) {
    for (std::size_t k = 0; k < lines.size() && count > 0; ++k) {
        if (lines[k].find(",1,") >= 12) continue; // another sensor, or a comment
        std::vector<std::string> cells;
        std::istringstream in(lines[k]);
        for (std::string cell; std::getline(in, cell, ',');) cells.push_back(cell);
        if (cells.size() < 9 || cells[1] != "1" || first-- > 0) continue;
        first = 0;
        --count;
        cells[column] = change(cells[column]);
        lines[k].clear();
        for (std::size_t c = 0; c < cells.size(); ++c) lines[k] += (c > 0 ? "," : "") + cells[c];
    }
}

std::string scaled(const std::string& cell, double factor) {
    return fmt::format("{:.7g}", factor * std::stod(cell));
}

/// Faults after which sensor 1 cannot be judged. The last columns of a row are t, id, seq, ax ay az
/// gx gy gz.
const std::vector<Mutation>& mutations() {
    constexpr std::size_t all = 1'000'000, rows = 1280; // of a sensor
    static const std::vector<Mutation> list{
        [](auto& l, Random& r) { // some cell is no number
            const char* const bad[] = {"nan",    "",      "inf", "-inf", "-",
                                       "banana", "1e999", "0x",  "1;2"};
            const char* const text = bad[any_of(r, 9)];
            change_cells(l, any_of(r, rows), 1, 3 + any_of(r, 6), [&](auto&) { return text; });
        },
        [](auto& l, Random& r) { // units of the force
            const double factor = r.uniform() < 0.5 ? standard_gravity : 1 / standard_gravity;
            for (std::size_t c = 3; c < 6; ++c)
                change_cells(l, 0, all, c, [&](auto& x) { return scaled(x, factor); });
        },
        [](auto& l, Random& r) { // a gap of 10 to 90 % of the time
            const std::size_t n = l.size() / 10 + any_of(r, 8 * l.size() / 10),
                              first = 10 + any_of(r, l.size() - n - 10);
            std::vector<std::string> kept;
            for (std::size_t k = 0; k < l.size(); ++k) {
                const bool of_one = l[k].find(",1,") != std::string::npos;
                if (!(of_one && k >= first && k < first + n)) kept.push_back(l[k]);
            }
            l = kept;
        },
        [](auto& l, Random& r) { // cut off in the middle of a row
            l.resize(20 + any_of(r, l.size() / 3));
            l.back().resize(l.back().size() / 2);
        },
        [](auto& l, Random& r) { // saturated for a while
            const std::size_t first = any_of(r, rows / 2), column = 3 + any_of(r, 3);
            change_cells(l, first, rows / 20 + any_of(r, rows / 3), column,
                         [&](auto&) { return "156.9"; });
        },
        [](auto& l, Random& r) { // stuck for 0.6 s to the end
            const std::size_t first = any_of(r, rows - 140), n = 125 + any_of(r, rows);
            for (std::size_t c = 3; c < 6; ++c)
                change_cells(l, first, n, c, [](auto&) { return "5.6"; });
        },
        [](auto& l, Random& r) { // clock
            const double factor = r.uniform() < 0.5 ? 1e3 : 1e-3;
            change_cells(l, 0, all, 0, [&](auto& x) { return scaled(x, factor); });
        },
        [](auto& l, Random& r) { // a row twice
            const std::size_t k = 20 + any_of(r, l.size() - 30);
            const auto of_one = std::find_if(l.begin() + static_cast<std::ptrdiff_t>(k), l.end(),
                                             [](const auto& x) { return x.find(",1,") < 12; });
            if (of_one != l.end())
                l.insert(of_one, *of_one);
            else
                l.clear();
        },
        [](auto& l, Random& r) { // sign of an axis, or of all
            const std::size_t first = 3, n = r.uniform() < 0.5 ? 3 : 3;
            for (std::size_t c = first; c < first + n; ++c)
                change_cells(l, 0, all, c, [&](auto& x) { return scaled(x, -1); });
        },
        [](auto& l, Random& r) { // the header
            const auto head =
                std::ranges::find_if(l, [](auto& x) { return x.starts_with("t,id"); });
            const char* const names[] = {"ax", "t", "id", "az"};
            const auto at = head->find(names[any_of(r, 4)]);
            head->replace(at, 1, "x_");
        },
        [](auto& l, Random& r) { // one to three digits, or bytes of any kind
            for (std::size_t k = 1 + any_of(r, 3); k > 0; --k) {
                std::string& line = l[3 + any_of(r, l.size() - 3)];
                line[any_of(r, line.size())] =
                    static_cast<char>(r.uniform() < 0.7 ? '0' + any_of(r, 10) : 1 + any_of(r, 254));
            }
        },
        [](auto& l, Random&) { // no sample of the sensor
            std::erase_if(l, [](const auto& x) { return x.find(",1,") < 12; });
        },
    };
    return list;
}

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);) lines.push_back(line);
    return lines;
}

} // namespace

TEST_SUITE("monitoring/mutated_recordings") {
    TEST_CASE("1000 mutated recordings: no crash, and no all-clear for a sensor with a fault") {
        // Each of 12 faults in turn, with random places and sizes, in the file of a passage; sensor
        // 1 has the fault. In one half the ballast has changed: no fault may hide this as an
        // all-clear of sensor 1. In the other half it has not: the fault still forbids the
        // all-clear. A file that cannot be read is refused with one line, which is none either. The
        // changed bytes are the exception: a few wrong digits do not hide a train, so that an
        // all-clear is deserved where the ballast has not changed, and only there.
        const TemporaryDirectory folder;
        std::vector<std::string> texts;
        for (const char* state : {"clean", "fouled"}) {
            write_passages(folder.path(), {passage(state, 40)}, "synthetic");
            texts.push_back(read_whole(folder / state / "recordings.csv"));
        }
        const auto infos = sensor_infos_in(folder.path(), "");
        const auto verdict_on = [&](const std::string& text) {
            std::ofstream(folder / "mutated.csv") << text; // no need to reach the disk
            const Passage p{"mutated", read_recordings(folder / "mutated.csv", infos)};
            return judged(p);
        };
        // unmutated, both halves have the verdict that they deserve
        CHECK(verdict_on(texts[0]).sensors[0].verdict == Verdict::as_baseline);
        CHECK(verdict_on(texts[1]).sensors[0].verdict == Verdict::louder);
        std::size_t refused = 0, no_data = 0, changed = 0, clear = 0;
        for (std::size_t k = 0; k < 1000; ++k) {
            Random random(99, k);
            const std::size_t which = k % mutations().size(), half = k / mutations().size() % 2;
            std::vector<std::string> lines = lines_of(texts[half]);
            mutations()[which](lines, random);
            std::string text;
            for (const std::string& line : lines) text += line + "\n";
            CAPTURE(k);
            CAPTURE(which);
            try {
                const PassageResult result = verdict_on(text);
                const SensorResult& s = result.sensors[0];
                CAPTURE(s.reason);
                const bool bytes = which == 10, all_clear = s.verdict == Verdict::as_baseline;
                CHECK((!all_clear || (bytes && half == 0)));
                if (!bytes) CHECK(together({result}) != Verdict::as_baseline);
                no_data += s.verdict == Verdict::not_enough_data;
                changed += is_change(s.verdict);
                clear += all_clear;
            } catch (const InputError& e) {
                const std::string message = e.what();
                CHECK(message.find("mutated.csv") != std::string::npos);
                CHECK(message.find('\n') == std::string::npos);
                ++refused;
            }
        }
        MESSAGE("files refused: " << refused << ", not enough data: " << no_data
                                  << ", changed: " << changed << ", as the baseline: " << clear);
        CHECK(clear > 0);
        CHECK(refused > 100);
        CHECK(no_data > 500);
    }
}
