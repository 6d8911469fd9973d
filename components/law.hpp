#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace bris {

struct EdgeRow;
struct Elasticity;
struct LawRow;
struct Material;
struct Materials;

/// Names of the contact laws. Each law is defined in its own file, components/laws/<name>.hpp; the
/// list of all laws is in components/laws/table.hpp. Checkpoints store the number, so new names are
/// appended.
enum class LawName : std::uint32_t {
    linear_frictionless,
    linear,
    linear_viscous,
    linear_rolling,
    hertz_frictionless,
    hertz_mindlin,
    hertz_mindlin_viscous,
    hertz_mindlin_rolling,
    linear_bridge,
    linear_edges,
    hertz_edges
};

/// A coefficient that a law reads: its name, its unit and its valid range.
struct Coefficient {
    const char* name;
    const char* unit;
    double low = 0, high = std::numeric_limits<double>::infinity();
    bool low_accepted = true, high_accepted = true;
    /// Member of each material that holds it; null: it is set for pairs of materials
    /// (Materials::set_own).
    double Material::*of_material = nullptr;
};

/// Coefficients of one pair of materials that only one law reads, as the user sets them.
inline constexpr std::size_t most_own_coefficients = 4;
using OwnCoefficients = std::array<double, most_own_coefficients>;

/// The same coefficients, converted for the kernel of that law (Law::own_row).
struct alignas(32) OwnRow {
    double value[most_own_coefficients];
};

/// Properties of a law for all code other than the contact kernels, as defined in the law's file.
struct LawTraits {
    const char* name;    ///< name by which a user chooses the law
    const char* summary; ///< one sentence for --help
    std::span<const Coefficient> of_materials;
    /// Coefficients that only this law reads, at most most_own_coefficients.
    std::span<const Coefficient> of_pairs;

    bool hertz;    ///< Hertz normal force from elastic constants; otherwise a linear spring
    bool springs;  ///< tangential spring with Coulomb's limit, so that pairs have a history
    bool dashpots; ///< dashpots, which read velocities predicted for the present instant
    bool rolling;  ///< resistance to rolling and twisting
    bool reaches;  ///< acts beyond touch once a pair has touched
    bool edges;    ///< reads the edges of materials (Materials::edge_pairs)
    bool wears;    ///< edges yield, so that pairs have a radius of their own (Worn)

    const char *normal_stiffness, *shear_stiffness; ///< names of kn and ks of its LawRow
    const char* stiffness_unit;
    const std::vector<LawRow>& (*rows)(const Materials&); ///< coefficients by pair of materials

    /// Tangent stiffnesses and energy of the normal spring at an overlap (m) and an effective
    /// radius (m).
    Elasticity (*elasticity)(const LawRow&, double overlap, double radius);
    /// Overlap (m) at which the stiffness is evaluated before anything touches: the largest one to
    /// be expected if two equal bodies of `mass` (kg) and `radius` (m) meet at `speed` (m/s); 0 if
    /// the stiffness is constant.
    double (*overlap_to_expect)(const LawRow&, double mass, double radius, double speed);
    /// Arm (m) of the couple of a contact with an effective radius (m); 0 without rolling.
    double (*couple_arm)(const EdgeRow&, double radius);
    /// Converts the law's own coefficients for its kernel.
    OwnRow (*own_row)(const OwnCoefficients&);
    /// Gap between the surfaces (m) up to which the law acts on a pair that has touched; 0 for most
    /// laws. It must not decrease as the effective radius (m) grows.
    double (*reach)(const OwnRow&, double radius);
    /// Potential energy (J) of the force that acts beyond touch, zero out of reach; the overlap (m)
    /// is negative for surfaces that are apart. `radius` is the effective radius (m).
    double (*potential)(const OwnRow&, double overlap, double radius);
};

/// Properties of a law from the table of laws.
const LawTraits& traits(LawName law);
/// Names of all laws in the order of LawName, as the choices of an option.
const std::vector<std::string>& texts_of(LawName);

inline bool is_hertz(LawName law) { return traits(law).hertz; }
inline bool has_springs(LawName law) { return traits(law).springs; }
inline bool has_dashpots(LawName law) { return traits(law).dashpots; }
inline bool has_rolling(LawName law) { return traits(law).rolling; }
inline bool has_wear(LawName law) { return traits(law).wears; }

/// Upper bound of the reach (m) of all pairs: the largest value over the pairs of materials at the
/// largest effective radius (m).
double largest_reach(LawName law, const Materials& materials, double largest_radius);

} // namespace bris
