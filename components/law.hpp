#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace bris {

struct Elasticity;
struct LawRow;
struct Material;
struct Materials;

/// The contact laws by name. What a law is stands in its own file, components/laws/<name>.hpp; the
/// list of all is in components/laws/table.hpp. Checkpoints store the number: append only.
enum class LawName : std::uint32_t {
    linear_frictionless,
    linear,
    linear_viscous,
    linear_rolling,
    hertz_frictionless,
    hertz_mindlin,
    hertz_mindlin_viscous,
    hertz_mindlin_rolling,
    linear_bridge
};

/// A number that a law reads: its name, its unit, and the range in which it makes sense.
struct Coefficient {
    const char* name;
    const char* unit;
    double low = 0, high = std::numeric_limits<double>::infinity();
    bool low_accepted = true, high_accepted = true;
    double Material::*of_material = nullptr; ///< where each material states it; null: stated for
                                             ///< pairs of materials (Materials::set_own)
};

/// Coefficients of one pair of materials that a single law reads, as the user states them.
inline constexpr std::size_t most_own_coefficients = 4;
using OwnCoefficients = std::array<double, most_own_coefficients>;

/// The same, prepared for the kernel of that law (Law::own_row).
struct alignas(32) OwnRow {
    double value[most_own_coefficients];
};

/// What everybody but the contact kernels may ask about a law; all of it is stated in its file.
struct LawTraits {
    const char* name;    ///< by which a user chooses it
    const char* summary; ///< one sentence for --help
    std::span<const Coefficient> of_materials;
    std::span<const Coefficient> of_pairs; ///< the law's own, at most most_own_coefficients

    bool hertz;    ///< normal force by Hertz, from elastic constants; else a linear spring
    bool springs;  ///< tangential spring with Coulomb's limit: pairs have a history
    bool dashpots; ///< reads velocities predicted for the present instant
    bool rolling;  ///< resistance to rolling and twisting
    bool reaches;  ///< acts beyond touch, once a pair has touched

    const char *normal_stiffness, *shear_stiffness; ///< what kn and ks of its LawRow are called
    const char* stiffness_unit;
    const std::vector<LawRow>& (*rows)(const Materials&); ///< coefficients by pair of materials

    /// Stiffnesses and energy of the springs at an overlap (m) and an effective radius (m).
    Elasticity (*elasticity)(const LawRow&, double overlap, double radius);
    /// Overlap (m) up to which a stiffness is to be expected where a body of `mass` (kg) and
    /// `radius` (m) meets another like it at `speed` (m/s); 0 if the stiffness is constant.
    double (*overlap_to_expect)(const LawRow&, double mass, double radius, double speed);
    OwnRow (*own_row)(const OwnCoefficients&);
    /// Distance of the surfaces (m) up to which a pair that has touched is held; 0 for most laws.
    /// It must not shrink as the effective radius (m) grows.
    double (*reach)(const OwnRow&, double radius);
    /// Potential energy (J, zero where nothing acts) of what acts beyond touch; the overlap (m) is
    /// negative for surfaces that are apart.
    double (*potential)(const OwnRow&, double overlap, double radius);
};

/// From the table of laws.
const LawTraits& traits(LawName law);
/// All names, in the order of LawName: choices of an option.
const std::vector<std::string>& law_names();

inline bool is_hertz(LawName law) { return traits(law).hertz; }
inline bool has_springs(LawName law) { return traits(law).springs; }
inline bool has_dashpots(LawName law) { return traits(law).dashpots; }
inline bool has_rolling(LawName law) { return traits(law).rolling; }

/// Reach (m) that no pair exceeds: of all pairs of materials, at the largest effective radius (m).
double largest_reach(LawName law, const Materials& materials, double largest_radius);

} // namespace bris
