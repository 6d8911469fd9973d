#pragma once

#include "engine/archive.hpp"
#include "engine/math.hpp"

#include <string>
#include <vector>

namespace bris {

/// One material of the linear law. Two partners act with their stiffnesses in series, the lower
/// friction, and the mean of their damping.
struct Material {
    std::string name;
    double density = 0;          ///< kg/m3, > 0 for free bodies
    double normal_stiffness = 0; ///< N/m, > 0
    double shear_stiffness = 0;  ///< N/m, >= 0
    double friction = 0;         ///< Coulomb coefficient, >= 0
    double normal_damping = 0;   ///< 1/s times the reduced mass (rate law), or a fraction of critical (restitution law)
    double shear_damping = 0;    ///< 1/s times the reduced mass
};

/// Coefficients of one pair of materials, as the contact kernel reads them.
struct alignas(64) LawRow { double kn, ks, friction, normal_damping, shear_damping, unused[3]; };

/// The materials of a scene and the table of their pairs. Coefficients may
/// change between phases, so they are State.
struct Materials {
    static constexpr auto name = "materials";
    static constexpr bool is_state = true;

    std::vector<Material> list;
    std::vector<LawRow> pairs; ///< list.size() squared

    std::uint32_t add(const Material& material) {
        list.push_back(material);
        mix();
        return static_cast<std::uint32_t>(list.size() - 1);
    }
    std::uint32_t pair(std::uint32_t a, std::uint32_t b) const {
        return a * static_cast<std::uint32_t>(list.size()) + b;
    }
    /// Recomputes the table of pairs; after any change of `list`.
    void mix() {
        const auto series = [](double a, double b) { return a + b > 0 ? a * b / (a + b) : 0; };
        pairs.clear();
        for (const Material& a : list)
            for (const Material& b : list)
                pairs.push_back({series(a.normal_stiffness, b.normal_stiffness),
                                 series(a.shear_stiffness, b.shear_stiffness),
                                 std::min(a.friction, b.friction),
                                 0.5 * (a.normal_damping + b.normal_damping),
                                 0.5 * (a.shear_damping + b.shear_damping),
                                 {}});
    }
    void save(Archive& archive) const {
        std::vector<double> numbers;
        for (const Material& m : list)
            numbers.insert(numbers.end(), {m.friction, m.normal_stiffness, m.shear_stiffness,
                                           m.normal_damping, m.shear_damping});
        archive.put("materials/coefficients", std::span<const double>(numbers));
    }
    void load(const Archive& archive) {
        const auto numbers = archive.get<double>("materials/coefficients");
        for (std::size_t i = 0; i < list.size(); ++i) {
            list[i].friction = numbers.at(5 * i);
            list[i].normal_stiffness = numbers.at(5 * i + 1);
            list[i].shear_stiffness = numbers.at(5 * i + 2);
            list[i].normal_damping = numbers.at(5 * i + 3);
            list[i].shear_damping = numbers.at(5 * i + 4);
        }
        mix();
    }
};

} // namespace bris
