#include "scenarios/library/library_results.hpp"

#include "engine/estimation/linear_fit.hpp"
#include "engine/io/whole_file.hpp"
#include "engine/report.hpp"
#include "scenarios/records/draw_curves.hpp"
#include "scenarios/triaxial/triaxial_results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace bris {

namespace {

constexpr std::uint64_t bootstrap_seed = 1;

struct Ratios {
    RatioInterval over_prior, over_single;
    double inside, crps;
};

Ratios ratios_of(const std::vector<SpecimenScore>& scores, std::size_t quantity) {
    std::vector<double> prior, single;
    double inside = 0, crps = 0, prior_crps = 0;
    for (const SpecimenScore& s : scores) {
        const QuantityScore& q = s.of[quantity];
        prior.push_back(q.error / q.prior);
        single.push_back(q.error / q.single);
        inside += q.inside / static_cast<double>(scores.size());
        crps += q.crps;
        prior_crps += q.prior_crps;
    }
    return {geometric_mean(prior, bootstrap_seed), geometric_mean(single, bootstrap_seed), inside,
            crps / prior_crps};
}

template <class Number>
std::vector<double> over(const std::vector<SpecimenScore>& scores, const Number& number) {
    std::vector<double> numbers;
    for (const SpecimenScore& s : scores) numbers.push_back(number(s));
    return numbers;
}

double root_mean_square(const std::vector<double>& numbers) {
    double sum = 0;
    for (const double x : numbers) sum += x * x;
    return std::sqrt(sum / static_cast<double>(numbers.size()));
}

/// Regression of the true logarithms of friction on the learned ones.
LinearFit true_on_learned(const std::vector<SpecimenScore>& scores) {
    constexpr double all = std::numeric_limits<double>::infinity();
    const auto x = over(scores, [](const SpecimenScore&s) { return s.learned_friction; }),
               y = over(scores, [](const SpecimenScore&s) { return s.friction; });
    const auto [low, high] = std::ranges::minmax(x);
    if (x.size() < 3 || !(high - low > 1e-9)) return {std::nan(""), 0, std::nan("")};
    return fit_line(x, y, -all, all);
}

/// Root mean square over specimens at each strain: of the first over that of the second.
std::vector<double> ratio_by_strain(const std::vector<SpecimenScore>& scores,
                                    std::vector<double> SpecimenScore::*error,
                                    std::vector<double> SpecimenScore::*prior) {
    std::vector<double> ratio;
    for (std::size_t k = 0; k < (scores.front().*error).size(); ++k)
        ratio.push_back(
            root_mean_square(over(scores, [&](const SpecimenScore& s) { return (s.*error)[k]; })) /
            root_mean_square(over(scores, [&](const SpecimenScore& s) { return (s.*prior)[k]; })));
    return ratio;
}

std::vector<double> strains_of(const LibraryAxis& axis) {
    std::vector<double> percent;
    for (std::size_t k = 0; k < axis.count; ++k) percent.push_back(100 * axis.strain(k));
    return percent;
}

/// Measured curve, prior, and prediction with its band.
Plot panel_of(const std::string& title, const std::string& label, const Curve& measured,
              const LibraryPrediction& prior, const LibraryPrediction& predicted,
              const Quantity& quantity) {
    Plot plot{.title = title,
              .x_label = "axial strain (%)",
              .y_label = label,
              .curves = curves_with_band(predicted.curves, quantity, "predicted")};
    plot.curves.insert(plot.curves.begin(), {measured, curve_of("prior mean", prior.curves,
                                                                quantity, Curve::Style::dashed)});
    return plot;
}

} // namespace

std::vector<Variant> compared_variants(const LibraryObservations& asked, bool can_observe_sensors) {
    LibraryObservations none = asked;
    none.force = none.volume = none.rings = none.tracked = none.tilt = none.porosity = false;
    const auto with = [&](auto... members) {
        LibraryObservations o = none;
        ((o.*members = true), ...);
        return o;
    };
    using O = LibraryObservations;
    std::vector<Variant> variants{
        {"force_and_volume", with(&O::force, &O::volume)},
        {"force", with(&O::force)},
        {"volume", with(&O::volume)},
        {"porosity", with(&O::porosity)},
        {"force_volume_porosity", with(&O::force, &O::volume, &O::porosity)},
        {"force_volume_porosity_rings", with(&O::force, &O::volume, &O::porosity, &O::rings)}};
    if (can_observe_sensors) {
        variants.push_back({"tilt", with(&O::tilt)});
        variants.push_back({"sensors", with(&O::tracked)});
        variants.push_back({"force_volume_porosity_sensors",
                            with(&O::force, &O::volume, &O::porosity, &O::tracked)});
    }
    variants.push_back({"sham", with(&O::force, &O::volume, &O::porosity), true});
    return variants;
}

Report scores_of(const ScoredVariant& v, double last_strain) {
    Report summary;
    for (std::size_t k = 0; k < scored_count; ++k) {
        const std::string name = name_of(static_cast<Scored>(k), v.observed.strain, last_strain);
        const Ratios r = ratios_of(v.scores, k);
        for (const auto& [what, ratio] :
             {std::pair{"over_prior", r.over_prior}, {"over_single_run", r.over_single}}) {
            summary.add(fmt::format("{}_{}", name, what), ratio.mean);
            summary.add(fmt::format("{}_{}_low", name, what), ratio.low);
            summary.add(fmt::format("{}_{}_high", name, what), ratio.high);
        }
        summary.add(name + "_inside_band", r.inside);
        summary.add(name + "_crps_over_prior", r.crps);
        if (k == static_cast<std::size_t>(Scored::q_near))
            summary.show({name + "_over_prior", name + "_over_single_run", name + "_inside_band"});
    }
    const LinearFit fit = true_on_learned(v.scores);
    const auto errors =
        over(v.scores, [](const SpecimenScore& s) { return s.learned_friction - s.friction; });
    const auto inside = std::ranges::count_if(v.scores, &SpecimenScore::friction_is_inside);
    summary.add("friction_true_on_learned_slope", fit.slope);
    summary.add("friction_true_on_learned_slope_error", fit.slope_error);
    summary.add("friction_log_rms_error", root_mean_square(errors));
    summary.add("friction_inside_band",
                static_cast<double>(inside) / static_cast<double>(v.scores.size()));
    summary.add("stiffness_log_rms_error",
                root_mean_square(over(v.scores, [](const SpecimenScore& s) {
                    return s.learned_stiffness - s.stiffness;
                })));
    summary.add("specimens_scored", v.scores.size());
    summary.show({"friction_true_on_learned_slope", "friction_log_rms_error",
                  "friction_inside_band", "specimens_scored"});
    return summary;
}

void write_scores(const std::filesystem::path& csv, const std::vector<ScoredVariant>& variants,
                  double last_strain) {
    std::string text = "variant,pressure_kPa,quantity,over_prior,low,high,over_single_run,low,high,"
                       "inside_band,crps_over_prior\n";
    for (const ScoredVariant& v : variants)
        for (std::size_t k = 0; k < scored_count; ++k) {
            const Ratios r = ratios_of(v.scores, k);
            text += fmt::format("{},{:g},{},{:.4g},{:.4g},{:.4g},{:.4g},{:.4g},{:.4g},{:.4g},"
                                "{:.4g}\n",
                                v.name, v.pressure / 1e3,
                                name_of(static_cast<Scored>(k), v.observed.strain, last_strain),
                                r.over_prior.mean, r.over_prior.low, r.over_prior.high,
                                r.over_single.mean, r.over_single.low, r.over_single.high, r.inside,
                                r.crps);
        }
    write_whole(csv, text);
}

void write_specimen_scores(const std::filesystem::path& csv,
                           const std::vector<ScoredVariant>& variants, double last_strain) {
    constexpr std::array quantities{Scored::q_near, Scored::smoothed_q_near, Scored::volume_all,
                                    Scored::rings_last};
    std::string text =
        "variant,pressure_kPa,specimen,distance,friction,learned_friction,friction_low,"
        "friction_high";
    for (const Scored q : quantities) {
        const std::string name = name_of(q, variants.front().observed.strain, last_strain);
        text += fmt::format(",{0}_over_prior,{0}_inside_band", name);
    }
    for (const ScoredVariant& v : variants)
        for (std::size_t k = 0; k < v.scores.size(); ++k) {
            const SpecimenScore& s = v.scores[k];
            text += fmt::format("\n{},{:g},{},{:.3g},{:.4g},{:.4g},{:.4g},{:.4g}", v.name,
                                v.pressure / 1e3, k + 1, s.distance, std::exp(s.friction),
                                std::exp(s.learned_friction),
                                std::exp(s.learned_friction - s.friction_band),
                                std::exp(s.learned_friction + s.friction_band));
            for (const Scored q : quantities) {
                const QuantityScore& score = s.of[static_cast<std::size_t>(q)];
                text += fmt::format(",{:.3g},{:.3g}", score.error / score.prior, score.inside);
            }
        }
    write_whole(csv, text + "\n");
}

std::size_t median_specimen(const std::vector<SpecimenScore>& scores) {
    std::vector<std::size_t> order(scores.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    constexpr auto smoothed = static_cast<std::size_t>(Scored::smoothed_q_near);
    std::ranges::sort(order, {}, [&](std::size_t k) {
        return scores[k].of[smoothed].error / scores[k].of[smoothed].prior;
    });
    return order[order.size() / 2];
}

bool draw_scores(const std::filesystem::path& png, const SpecimenLibrary& library,
                 const LibrarySpecimen& example, const LibraryPrediction& predicted,
                 const LibraryPrediction& prior, std::size_t pressure,
                 const std::vector<SpecimenScore>& scores) {
    const auto x = strains_of(library.axis);
    const LibraryTest& test = example.tests[pressure];
    const auto measured = [&](const std::vector<float>& numbers, double factor) {
        Curve curve{"measured", x, {}, Curve::Style::points};
        for (const float number : numbers) curve.y.push_back(factor * double{number});
        return curve;
    };
    constexpr auto bands = ", 90 % band";
    const std::string at = " at " + label_of(library.pressures[pressure]);
    Plot ratio{
        .title = "Error over that of the prior ensemble",
        .x_label = "axial strain (%)",
        .y_label = "ratio",
        .curves = {{"ln q", x, ratio_by_strain(scores, &SpecimenScore::q, &SpecimenScore::prior_q)},
                   {"volumetric strain", x,
                    ratio_by_strain(scores, &SpecimenScore::volume, &SpecimenScore::prior_volume)},
                   {"no gain", {x.front(), x.back()}, {1, 1}, Curve::Style::dashed}}};
    const auto friction = [&](double SpecimenScore::*value) {
        return over(scores, [&](const SpecimenScore& s) { return std::exp(s.*value); });
    };
    const auto truth = friction(&SpecimenScore::friction);
    const auto [least, most] = std::ranges::minmax(truth);
    Plot learned{.title = "Friction",
                 .x_label = "learned",
                 .y_label = "true",
                 .curves = {{"specimens", friction(&SpecimenScore::learned_friction), truth,
                             Curve::Style::points},
                            {"equal", {least, most}, {least, most}, Curve::Style::dashed}}};
    constexpr std::size_t bins = 10;
    std::vector<double> edges, shares(bins);
    double count = 0;
    for (const SpecimenScore& s : scores)
        for (const double p : s.probabilities) {
            ++shares[std::min(bins - 1, static_cast<std::size_t>(p * bins))];
            ++count;
        }
    Curve histogram{"smoothed q", {}, {}};
    for (std::size_t k = 0; k < bins; ++k)
        for (const double edge : {0.0, 1.0}) {
            histogram.x.push_back((static_cast<double>(k) + edge) / bins);
            histogram.y.push_back(shares[k] / count * bins);
        }
    Plot ranks{.title = "Probability of the measured value in its prediction",
               .x_label = "probability",
               .y_label = "density",
               .curves = {histogram, {"calibrated", {0, 1}, {1, 1}, Curve::Style::dashed}}};
    return draw_plots(
        png,
        {panel_of("q" + at + bands, "q (kPa)", measured(test.q, 1e-3), prior, predicted,
                  quantity::deviatoric_stress),
         panel_of("Smoothed q" + at + bands, "q (kPa)", measured(test.smoothed_q, 1e-3), prior,
                  predicted, quantity::smoothed_q),
         panel_of("Volumetric strain" + at + bands, "volumetric strain (%)",
                  measured(test.volume, 100), prior, predicted, quantity::volumetric_strain),
         ratio, learned, ranks},
        3);
}

} // namespace bris
