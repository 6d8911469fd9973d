#include "components/material.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bris {

namespace {

double series(double a, double b) { return a + b > 0 ? a * b / (a + b) : 0; }

double plane_modulus(const Material& m) {
    return m.young_modulus / (1 - m.poisson_ratio * m.poisson_ratio);
}
double shear_compliance_modulus(const Material& m) { // G / (2 - nu)
    return m.young_modulus / (2 * (1 + m.poisson_ratio) * (2 - m.poisson_ratio));
}

double lower_above_zero(double a, double b) { return a > 0 && b > 0 ? std::min(a, b) : a + b; }
double inverse_or_zero(double a) { return a > 0 ? 1 / a : 0; }

/// `modulus`: E* of the pair, Pa.
EdgeRow edges_of(const Material& a, const Material& b, double modulus) {
    const double strength = lower_above_zero(a.contact_strength, b.contact_strength),
                 angle = lower_above_zero(a.cone_half_angle, b.cone_half_angle),
                 sine = std::sin(angle);
    return {.yield_ratio = strength > 0 ? 0.5 * pi * strength / modulus : EdgeRow::never_yields,
            .blunting = angle > 0 ? (1 - sine) / sine : 0,
            .radius = a.edge_radius > 0 && b.edge_radius > 0 ? series(a.edge_radius, b.edge_radius)
                                                             : a.edge_radius + b.edge_radius,
            .rise = std::min(a.friction_rise, b.friction_rise),
            .easing_pressure = inverse_or_zero(
                lower_above_zero(a.friction_half_pressure, b.friction_half_pressure)),
            .easing_force =
                inverse_or_zero(lower_above_zero(a.friction_half_force, b.friction_half_force)),
            .arm = std::min(a.couple_arm, b.couple_arm),
            .couple_easing = inverse_or_zero(lower_above_zero(a.couple_force, b.couple_force))};
}

// each property that has a value replaces that of the mixing rules
void apply(const PairProperties& from, double& friction, double& restitution, RollingRow& rolling) {
    friction = from.friction.value_or(friction);
    restitution = from.restitution.value_or(restitution);
    rolling.rolling_friction = from.rolling_friction.value_or(rolling.rolling_friction);
    rolling.twisting_friction = from.twisting_friction.value_or(rolling.twisting_friction);
}

auto fields(auto& m) {
    return std::tie(m.density, m.normal_stiffness, m.shear_stiffness, m.friction, m.normal_damping,
                    m.shear_damping, m.restitution, m.young_modulus, m.poisson_ratio,
                    m.rolling_friction, m.twisting_friction);
}
auto fields_of_edges(auto& m) {
    return std::tie(m.contact_strength, m.cone_half_angle, m.edge_radius, m.friction_rise,
                    m.friction_half_pressure, m.friction_half_force, m.couple_arm, m.couple_force);
}
bool has_edges(const Material& m) {
    return fields_of_edges(m) != std::tuple(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
}
auto fields_of_policy(auto& p) {
    return std::tie(p.tension, p.shear_history, p.patch, p.shear_dashpot, p.rolling_stiffness_ratio,
                    p.rolling_damping_ratio);
}
std::string path_of(std::size_t material) { return "materials/" + std::to_string(material); }
std::string path_of_edges(std::size_t material) { return path_of(material) + "_edges"; }

} // namespace

std::uint32_t Materials::add(const Material& material) {
    list.push_back(material);
    mix();
    return static_cast<std::uint32_t>(list.size() - 1);
}

void Materials::set_pair(std::uint32_t a, std::uint32_t b, const PairProperties& properties) {
    std::erase_if(overrides_, [&](const Override& o) {
        return (o.a == a && o.b == b) || (o.a == b && o.b == a);
    });
    overrides_.push_back({a, b, properties});
    mix();
}

void Materials::set_own(LawName law, std::uint32_t a, std::uint32_t b,
                        const OwnCoefficients& values) {
    std::erase_if(own_, [&](const Own& o) { return o.is_of(a, b); });
    own_.push_back({law, a, b, values});
    mix();
}

OwnCoefficients Materials::own(LawName law, std::uint32_t a, std::uint32_t b) const {
    for (const Own& o : own_)
        if (o.law == law && o.is_of(a, b)) return o.values;
    return {};
}

void Materials::mix() {
    linear_pairs.clear();
    hertz_pairs.clear();
    rolling_pairs.clear();
    edge_pairs.clear();
    restitution.clear();
    own_pairs.assign(list.size() * list.size(), OwnRow{});
    for (const Own& o : own_)
        own_pairs[pair(o.a, o.b)] = own_pairs[pair(o.b, o.a)] = traits(o.law).own_row(o.values);
    for (std::uint32_t i = 0; i < list.size(); ++i)
        for (std::uint32_t j = 0; j < list.size(); ++j) {
            const Material &a = list[i], &b = list[j];
            const double mixed = std::min(a.friction, b.friction);
            double friction = mixed, rebound = std::sqrt(a.restitution * b.restitution);
            RollingRow rolling{std::min(a.rolling_friction, b.rolling_friction),
                               std::min(a.twisting_friction, b.twisting_friction),
                               policy.rolling_stiffness_ratio, policy.rolling_damping_ratio};
            for (const Override& o : overrides_)
                if ((o.a == i && o.b == j) || (o.a == j && o.b == i))
                    apply(o.properties, friction, rebound, rolling);
            const double ratio = 2 * damping_ratio(rebound, policy.tension),
                         shear = policy.shear_dashpot ? ratio : 0;
            const double hertz = std::sqrt(5.0 / 6); // Tsuji, Tanaka and Ishida (1992)
            LawRow linear{series(a.normal_stiffness, b.normal_stiffness),
                          series(a.shear_stiffness, b.shear_stiffness),
                          friction,
                          0.5 * (a.normal_damping + b.normal_damping),
                          0.5 * (a.shear_damping + b.shear_damping),
                          ratio,
                          0,
                          0};
            LawRow curved = linear;
            curved.kn = series(plane_modulus(a), plane_modulus(b));
            curved.ks = 4 * series(shear_compliance_modulus(a), shear_compliance_modulus(b));
            curved.normal_ratio = hertz * ratio;
            // the kernels compute one square root only, that of the normal stiffness
            linear.shear_ratio = linear.kn > 0 ? shear * std::sqrt(linear.ks / linear.kn) : 0;
            curved.shear_ratio =
                curved.kn > 0 ? hertz * shear * std::sqrt(curved.ks / curved.kn) : 0;
            linear_pairs.push_back(linear);
            hertz_pairs.push_back(curved);
            rolling_pairs.push_back(rolling);
            EdgeRow edges = edges_of(a, b, curved.kn);
            if (mixed > 0) edges.rise *= friction / mixed; // of a pair with a friction of its own
            edge_pairs.push_back(edges);
            restitution.push_back(rebound);
        }
    mix_weakened();
}

void Materials::weaken(std::vector<WeakenedPair> pairs) {
    weakened_ = std::move(pairs);
    const std::size_t unweakened = pairs_of_materials();
    linear_pairs.resize(unweakened);
    hertz_pairs.resize(unweakened);
    rolling_pairs.resize(unweakened);
    edge_pairs.resize(unweakened);
    own_pairs.resize(unweakened);
    mix_weakened();
}

// normal and tangential stiffness have one factor, so the ratios of the dashpots remain
void Materials::mix_weakened() {
    const auto weakened = [](LawRow row, const WeakenedPair& w) {
        row.friction =
            std::max(row.friction * w.friction, std::min(row.friction, w.least_friction));
        row.kn *= w.stiffness;
        row.ks *= w.stiffness;
        return row;
    };
    for (const WeakenedPair& w : weakened_) {
        linear_pairs.push_back(weakened(linear_pairs[w.pair], w));
        hertz_pairs.push_back(weakened(hertz_pairs[w.pair], w));
        rolling_pairs.push_back(RollingRow(rolling_pairs[w.pair]));
        // the strength falls with the modulus, so that the contact yields at the same overlap
        EdgeRow edges = edge_pairs[w.pair];
        edges.rise *= w.friction;
        edge_pairs.push_back(edges);
        own_pairs.push_back(OwnRow(own_pairs[w.pair]));
    }
}

void Materials::save(Archive& archive) const {
    for (std::size_t i = 0; i < list.size(); ++i) {
        put_fields(archive, path_of(i), fields(list[i]));
        if (has_edges(list[i])) put_fields(archive, path_of_edges(i), fields_of_edges(list[i]));
    }
    put_fields(archive, "materials/policy", fields_of_policy(policy));
    // for each pair: a, b, then for each of four properties whether it is set, and its value
    std::vector<double> numbers;
    for (const Override& o : overrides_) {
        numbers.insert(numbers.end(), {static_cast<double>(o.a), static_cast<double>(o.b)});
        for (const auto& p : {o.properties.friction, o.properties.restitution,
                              o.properties.rolling_friction, o.properties.twisting_friction})
            numbers.insert(numbers.end(), {p ? 1.0 : 0.0, p.value_or(0)});
    }
    archive.put("materials/overrides", std::span<const double>(numbers));
    save_own(archive);
}

// for each pair: law, a, b, then the coefficients; absent if no pair has any
void Materials::save_own(Archive& archive) const {
    std::vector<double> numbers;
    for (const Own& o : own_) {
        numbers.insert(numbers.end(), {static_cast<double>(o.law), static_cast<double>(o.a),
                                       static_cast<double>(o.b)});
        numbers.insert(numbers.end(), o.values.begin(), o.values.end());
    }
    if (!numbers.empty()) archive.put("materials/own", std::span<const double>(numbers));
}

void Materials::load_own(const Archive& archive) {
    own_.clear();
    if (archive.find("materials/own") == nullptr) return;
    constexpr std::size_t width = 3 + most_own_coefficients;
    const auto numbers = archive.get<double>("materials/own");
    for (std::size_t k = 0; k + width <= numbers.size(); k += width) {
        Own o{static_cast<LawName>(numbers[k]),
              static_cast<std::uint32_t>(numbers[k + 1]),
              static_cast<std::uint32_t>(numbers[k + 2]),
              {}};
        std::copy_n(&numbers[k + 3], most_own_coefficients, o.values.begin());
        own_.push_back(o);
    }
}

void Materials::load(const Archive& archive) {
    for (std::size_t i = 0; i < list.size(); ++i) {
        get_fields(archive, path_of(i), fields(list[i]));
        if (archive.find(path_of_edges(i)) != nullptr)
            get_fields(archive, path_of_edges(i), fields_of_edges(list[i]));
        else
            fields_of_edges(list[i]) = std::tuple(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
    }
    get_fields(archive, "materials/policy", fields_of_policy(policy));
    overrides_.clear();
    const auto numbers = archive.get<double>("materials/overrides");
    for (std::size_t k = 0; k + 10 <= numbers.size(); k += 10) {
        const auto value = [&](std::size_t i) {
            return numbers[k + 2 * i] != 0 ? std::optional(numbers[k + 2 * i + 1]) : std::nullopt;
        };
        overrides_.push_back({static_cast<std::uint32_t>(numbers[k]),
                              static_cast<std::uint32_t>(numbers[k + 1]),
                              {value(1), value(2), value(3), value(4)}});
    }
    load_own(archive);
    weakened_.clear();
    mix();
}

double restitution_of(double damping_ratio, Tension tension) {
    const double b = damping_ratio;
    if (tension == Tension::allowed) return b < 1 ? std::exp(-pi * b / std::sqrt(1 - b * b)) : 0;
    if (b < 1) {
        const double root = std::sqrt(1 - b * b);
        return std::exp(-b / root * std::atan2(2 * b * root, 2 * b * b - 1));
    }
    const double root = std::sqrt(b * b - 1);
    return root > 0 ? std::exp(-2 * b / root * std::log(b + root)) : std::exp(-2.0);
}

double damping_ratio(double restitution, Tension tension) {
    if (restitution >= 1) return 0;
    if (tension != Tension::calibrated) {
        if (restitution <= 0) return 1;
        const double l = std::log(restitution);
        return -l / std::sqrt(pi * pi + l * l);
    }
    if (restitution <= 0) return std::numeric_limits<double>::infinity();
    double low = 0, high = 1;
    while (restitution_of(high, tension) > restitution) high *= 2;
    for (int k = 0; k < 200; ++k) {
        const double middle = 0.5 * (low + high);
        (restitution_of(middle, tension) > restitution ? low : high) = middle;
    }
    return 0.5 * (low + high);
}

} // namespace bris
