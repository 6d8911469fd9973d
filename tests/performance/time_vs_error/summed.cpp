// Summary of the rows: errors with their uncertainty, recommended settings, plots.
#include "engine/io/plot.hpp"
#include "engine/io/whole_file.hpp"
#include "tests/performance/time_vs_error/results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace bris::time_vs_error {

namespace {

/// Value that the absolute value of Student's t exceeds with a probability of 5 % (two-sided) or 10
/// %.
double student(std::size_t freedom, bool five_percent) {
    constexpr std::array two{12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262};
    constexpr std::array one{6.314, 2.920, 2.353, 2.132, 2.015, 1.943, 1.895, 1.860, 1.833};
    if (freedom == 0) return std::numeric_limits<double>::infinity();
    if (freedom <= two.size()) return (five_percent ? two : one)[freedom - 1];
    const double z = five_percent ? 1.95996 : 1.64485; // first term of Fisher's expansion
    return z + (z * z * z + z) / (4 * static_cast<double>(freedom));
}

double median(std::vector<double> values) {
    if (values.empty()) return unknown;
    std::sort(values.begin(), values.end());
    return 0.5 * (values[(values.size() - 1) / 2] + values[values.size() / 2]);
}

/// Verdict on a summary. If runs have an exact reference, the worst seed decides. Otherwise
/// equivalence is tested: the mean error plus its uncertainty (one-sided with a probability of 5 %,
/// Schuirmann 1987) must be within the tolerance.
std::string verdict_of(const Summed& s, const Kind& kind, double tolerance) {
    if (s.seeds == 0) return "failed";
    if (kind.exact) return s.failed == 0 && s.worst <= tolerance ? "meets" : "fails";
    if (s.is_reference) return "reference";
    if (s.seeds < 2) return s.bias == 0 ? "meets" : "undecided";
    const double doubt = student(s.seeds - 1, false) * s.standard_error;
    if (s.failed > 0 || std::abs(s.bias) - doubt > tolerance) return "fails";
    return std::abs(s.bias) + doubt <= tolerance ? "meets" : "undecided";
}

Summed sum_up(const Scene& scene, const Knob& knob, const std::string& value, const Kind& kind,
              const std::vector<Line>& lines) {
    Summed s{.scene = scene.name,
             .knob = knob.label,
             .value = value,
             .kind = kind.name,
             .tolerance = kind.tolerance};
    std::vector<double> errors, times, steps, contacts;
    for (const Line& l : lines) {
        if (l.scene != s.scene || l.knob != s.knob || l.value != s.value || l.kind != s.kind)
            continue;
        if (!std::isfinite(l.error)) {
            ++s.failed;
            continue;
        }
        errors.push_back(l.error);
        times.push_back(l.wall_time);
        steps.push_back(static_cast<double>(l.steps));
        contacts.push_back(l.contacts);
    }
    s.seeds = errors.size();
    s.wall_time = median(times);
    s.steps = median(steps);
    s.contacts = median(contacts);
    const Settings base = scene.standard.with(knob.with);
    Settings mine = base;
    mine.set(knob.name, value);
    s.is_reference = !knob.exact && !kind.exact && mine.text() == base.with(knob.reference).text();
    if (errors.empty()) {
        s.verdict = "failed";
        return s;
    }
    const auto n = static_cast<double>(errors.size());
    s.bias = s.worst = 0;
    for (const double e : errors) {
        s.bias += e / n;
        s.worst = std::max(s.worst, std::abs(e));
    }
    double squares = 0;
    for (const double e : errors) squares += (e - s.bias) * (e - s.bias);
    if (errors.size() > 1) {
        s.standard_error = std::sqrt(squares / (n - 1) / n);
        s.half_interval = student(errors.size() - 1, true) * s.standard_error;
    }
    s.verdict = verdict_of(s, kind, s.tolerance);
    return s;
}

const Summed* find(const std::vector<Summed>& all, const Knob& knob, const std::string& value,
                   const Kind& kind) {
    const auto found = std::find_if(all.begin(), all.end(), [&](const Summed& s) {
        return s.knob == knob.label && s.value == value && s.kind == kind.name;
    });
    return found == all.end() ? nullptr : &*found;
}

/// Error in the plots: that of the worst seed if runs have an exact reference, else the mean.
double drawn_error(const Summed& s, const Kind& kind) {
    return kind.exact ? s.worst : std::abs(s.bias);
}

std::string cheapest(const Knob& knob, const Kind& kind, double tolerance,
                     const std::vector<Summed>& all) {
    const Summed *best = nullptr, *undecided = nullptr;
    for (const std::string& value : knob.values) {
        const Summed* s = find(all, knob, value, kind);
        if (!s) continue;
        const std::string verdict = verdict_of(*s, kind, tolerance);
        if (verdict == "meets" && (!best || s->wall_time < best->wall_time)) best = s;
        if (verdict == "undecided" && (!undecided || s->wall_time < undecided->wall_time))
            undecided = s;
    }
    if (best) return best->value;
    return undecided ? undecided->value + "?" : "-";
}

Plot panel(const Scene& scene, const Kind& kind, const std::vector<Summed>& all, bool steps) {
    std::string quantity = kind.name;
    std::ranges::replace(quantity, '_', ' ');
    Plot plot{.title = fmt::format("{}: {}", scene.title, quantity),
              .x_label = fmt::format("{}error of {}", kind.relative ? "relative " : "", quantity),
              .y_label = steps ? fmt::format("steps per {}", scene.cost_unit)
                               : fmt::format("wall time (s) per {}", scene.cost_unit),
              .x_logarithmic = true,
              .y_logarithmic = true};
    std::size_t number = 0;
    for (const Knob& knob : scene.knobs) {
        Curve line{.label = knob.label,
                   .style = number++ < 7 ? Curve::Style::line : Curve::Style::dashed};
        for (const std::string& value : knob.values) {
            const Summed* s = find(all, knob, value, kind);
            if (!s || s->seeds == 0 || s->is_reference) continue;
            line.x.push_back(drawn_error(*s, kind)); // a logarithmic axis does not show zeros
            line.y.push_back(steps ? s->steps : s->wall_time);
        }
        Curve points{.x = line.x, .y = line.y, .style = Curve::Style::points};
        if (line.x.empty() ||
            std::all_of(line.x.begin(), line.x.end(), [](double x) { return x == 0; }))
            continue;
        plot.curves.push_back(std::move(line));
        plot.curves.push_back(std::move(points));
    }
    return plot;
}

} // namespace

std::vector<Summed> sum_up(const Scene& scene, const std::vector<Line>& lines) {
    std::vector<Summed> all;
    for (const Knob& knob : scene.knobs)
        for (const std::string& value : knob.values)
            for (const Kind& kind : scene.kinds) {
                Summed s = sum_up(scene, knob, value, kind, lines);
                if (s.seeds + s.failed > 0) all.push_back(std::move(s));
            }
    return all;
}

void write_summed(const std::filesystem::path& csv, const std::vector<Summed>& all) {
    std::string text = "scene,knob,value,error_kind,seeds,failed,wall_time_s,steps,contacts,bias,"
                       "standard_error,half_interval_95,worst,"
                       "tolerance,verdict\n";
    for (const Summed& s : all)
        text += fmt::format(
            "{},\"{}\",\"{}\",{},{},{},{:.4g},{:.6g},{:.6g},{:.4g},{:.3g},{:.3g},{:.3g},{:g},{}\n",
            s.scene, s.knob, s.value, s.kind, s.seeds, s.failed, s.wall_time, s.steps, s.contacts,
            s.bias, s.standard_error, s.half_interval, s.worst, s.tolerance, s.verdict);
    write_whole(csv, text);
}

void print_summed(const Scene& scene, const std::vector<Summed>& all) {
    fmt::print("\n{}: {}. Medians over seeds, mean error +- 95 % (worst seed if the reference is "
               "exact)\n",
               scene.name, scene.title);
    fmt::print("{:30} {:22} {:>9} {:>9}", "knob", "value", "wall (s)", "steps");
    for (const Kind& kind : scene.kinds) fmt::print("  {:>22.22}", kind.name);
    fmt::print("\n");
    for (const Knob& knob : scene.knobs)
        for (const std::string& value : knob.values) {
            const Summed* first = find(all, knob, value, scene.kinds.front());
            if (!first) continue;
            fmt::print("{:30} {:22} {:9.3g} {:9.0f}", knob.label, value, first->wall_time,
                       first->steps);
            for (const Kind& kind : scene.kinds) {
                const Summed* s = find(all, knob, value, kind);
                fmt::print("  {:>22}", !s || s->seeds == 0 ? "failed"
                                       : kind.exact        ? fmt::format("{:.2g}", s->worst)
                                       : s->is_reference   ? "reference"
                                                         : fmt::format("{:+.2g} +- {:.2g}", s->bias,
                                                                       s->half_interval));
            }
            fmt::print("\n");
        }
}

void print_recommendation(const Scene& scene, const std::vector<Summed>& all) {
    fmt::print("{}: fastest value that meets the tolerance times 10, 1 and 0.1 (\"?\": too few "
               "seeds to decide, \"-\": none but the reference)\n",
               scene.name);
    for (const Knob& knob : scene.knobs) {
        if (std::none_of(all.begin(), all.end(),
                         [&](const Summed& x) { return x.knob == knob.label; }))
            continue;
        if (knob.exact) {
            fmt::print("  {:30} all values give the same bits: use the fastest\n", knob.label);
            continue;
        }
        for (const Kind& kind : scene.kinds)
            fmt::print("  {:30} {:30} {:8.1g}: {:22} {:8.1g}: {:22} {:8.1g}: {}\n", knob.label,
                       kind.name, 10 * kind.tolerance,
                       cheapest(knob, kind, 10 * kind.tolerance, all), kind.tolerance,
                       cheapest(knob, kind, kind.tolerance, all), kind.tolerance / 10,
                       cheapest(knob, kind, kind.tolerance / 10, all));
    }
}

void draw(const std::filesystem::path& png, const Scene& scene, const std::vector<Summed>& all) {
    std::vector<Plot> panels;
    for (const Kind& kind : scene.kinds)
        for (const bool steps : {false, true}) {
            Plot plot = panel(scene, kind, all, steps);
            if (!plot.curves.empty()) panels.push_back(std::move(plot));
        }
    draw_plots(png, panels, 2);
}

} // namespace bris::time_vs_error
