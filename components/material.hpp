#pragma once

#include "components/law.hpp"
#include "engine/archive.hpp"
#include "engine/math.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace bris {

/// Properties of a material. Each law reads some of them: stiffnesses (linear laws) or elastic
/// constants (Hertz), friction, restitution or damping rates, rolling and twisting friction
/// (rolling laws).
struct Material {
    std::string name;
    double density = 0;          ///< kg/m3, > 0 for free bodies
    double normal_stiffness = 0; ///< N/m, > 0, linear laws; two partners act in series
    double shear_stiffness = 0;  ///< N/m, >= 0, linear laws; two partners act in series
    double friction = 0;         ///< Coulomb coefficient, >= 0; a pair has the lower one
    /// Damping rate, 1/s, >= 0: damping coefficient over reduced mass, in addition to the damping
    /// by restitution. A pair has the mean of both materials.
    double normal_damping = 0;
    /// Damping rate of the tangential spring, 1/s, >= 0, defined and mixed as the normal one.
    double shear_damping = 0;
    /// Coefficient of restitution of a normal impact, in [0, 1]; 0 is excluded for
    /// Tension::calibrated. A pair has the geometric mean of both materials.
    double restitution = 1;
    double young_modulus = 0; ///< Pa, > 0: Hertz
    double poisson_ratio = 0; ///< in (-1, 0.5]: Hertz, Mindlin
    /// Limit of the rolling torque over effective radius and normal force, >= 0. A pair has the
    /// lower one.
    double rolling_friction = 0;
    /// Limit of the torque about the normal over effective radius and normal force, >= 0. A pair
    /// has the lower one.
    double twisting_friction = 0;

    // What the edges of a rock do at a contact (components/laws/edges.hpp). A boundary has none.

    /// Pa, >= 0: contact pressure at which an edge yields; 0: it does not. A pair has the lower one
    /// of those above 0.
    double contact_strength = 0;
    /// rad, in [0, pi/2): half-angle of the cone that an edge is. A pair has the lower one of those
    /// above 0.
    double cone_half_angle = 0;
    /// m, >= 0: radius of the unworn tip of an edge; 0: that of the spheres, or flat against a
    /// material that has one. Two edges count in series.
    double edge_radius = 0;
    /// >= 0: friction at low load above `friction`. A pair has the lower one.
    double friction_rise = 0;
    /// Load of a contact at which half of friction_rise is left: the mean pressure (Pa, Hertz) or
    /// the normal force (N, linear laws); >= 0, 0: it does not fall. A pair has the lower one of
    /// those above 0.
    double friction_half_pressure = 0, friction_half_force = 0;
    /// m, >= 0: arm of the couple with which faces and edges resist rolling and twisting. A pair
    /// has the lower one.
    double couple_arm = 0;
    /// N, >= 0: normal force at which the couple's limit is half of that in proportion to the
    /// force, and which it approaches as the force grows; 0: it stays in proportion. A pair has the
    /// lower one of those above 0.
    double couple_force = 0;
};

/// Values that replace those of the mixing rules for one pair of materials.
struct PairProperties {
    std::optional<double> friction = {}, restitution = {}, rolling_friction = {},
                          twisting_friction = {};
};

/// Contact law of a scene; set when the neighbour lists are added.
struct ContactLaw {
    static constexpr auto name = "contact_law";
    LawName law = LawName::linear;
};

/// Whether the dashpot may make the normal force attractive at the end of a contact, and the
/// restitution that follows.
enum class Tension : std::uint32_t {
    /// The normal force may be attractive; restitution is exactly the prescribed one.
    allowed,
    /// The normal force is cut off at zero, with the same dashpot; restitution is higher than
    /// prescribed.
    cut,
    /// The normal force is cut off at zero, with a stronger dashpot; restitution is the prescribed
    /// one.
    calibrated
};

/// How the tangential spring of Mindlin follows a stiffness that changes with the normal force.
enum class ShearHistory : std::uint32_t {
    /// The force decreases with the stiffness but does not increase with it, so the spring never
    /// creates energy.
    rescaled,
    incremental, ///< the force changes only by stiffness times displacement
    total        ///< the force is stiffness times stretch
};

/// Stiffness of a patch, that is, of the spheres of one clump that touch the same partner.
enum class PatchStiffness : std::uint32_t {
    /// Each sphere has the full stiffness, so a patch is stiffer the more spheres it has.
    per_sphere,
    /// The spheres share one stiffness in proportion to their overlaps, so the stiffness does not
    /// depend on how many spheres represent the surface.
    shared
};

/// Settings that all contacts of a scene share.
struct ContactPolicy {
    Tension tension = Tension::allowed;
    ShearHistory shear_history = ShearHistory::rescaled;
    PatchStiffness patch = PatchStiffness::per_sphere; ///< spheres against spheres and planes
    /// Restitution damps the tangential spring too, by the same ratio of critical damping.
    bool shear_dashpot = false;
    /// Stiffness of the rolling spring over that of the tangential spring (both at the surface), >
    /// 0.
    double rolling_stiffness_ratio = 1;
    /// Ratio of critical damping while the rolling spring sticks, >= 0.
    double rolling_damping_ratio = 0;
};

/// Coefficients of one pair of materials, as the contact kernels read them. Linear laws: kn and ks
/// are stiffnesses in N/m. Hertz: kn is E* and ks is 4 G* (Pa), so that the tangent stiffnesses at
/// contact radius a are 2 kn a and 2 ks a.
struct alignas(64) LawRow {
    double kn, ks, friction;
    double normal_rate, shear_rate; ///< 1/s, damping coefficient over reduced mass
    /// Damping coefficient over the square root of normal tangent stiffness times reduced mass. The
    /// shear ratio is zero where the normal one is.
    double normal_ratio, shear_ratio;
    double unused;
};
struct alignas(32) RollingRow {
    double rolling_friction, twisting_friction, stiffness_ratio, damping_ratio;
};

/// Coefficients of the edges of one pair of materials (components/laws/edges.hpp).
struct alignas(64) EdgeRow {
    /// pi s / (2 E*) of the strength s: root of overlap over radius at which a contact yields.
    double yield_ratio = never_yields;
    double blunting = 0;        ///< (1 - sin a) / sin a of the cone's half-angle a
    double radius = 0;          ///< m, of the unworn contact; 0: that of the spheres
    double rise = 0;            ///< of the friction at low load
    double easing_pressure = 0; ///< 1/Pa, 1 over the pressure at which half of the rise is left
    double easing_force = 0;    ///< 1/N, as easing_pressure
    double arm = 0;             ///< m, of the couple
    double couple_easing = 0;   ///< 1/N

    static constexpr double never_yields = 1e100;
};

/// Contacts of two bodies that fines weaken: factors of the coefficients that their materials have.
struct WeakenedPair {
    std::uint32_t pair = 0;    ///< row of the pair of materials
    double friction = 1;       ///< factor of the friction coefficient, in [0, 1]
    double least_friction = 0; ///< lower limit of the product, unless the materials have less
    double stiffness = 1;      ///< factor of normal and tangential stiffness, in (0, 1]
};

/// The materials of a scene and the tables of their pairs. Coefficients may change between phases,
/// so they are State.
struct Materials {
    static constexpr auto name = "materials";
    static constexpr bool is_state = true;

    std::vector<Material> list;
    ContactPolicy policy;

    // Tables of list.size() squared rows, of which `pair` gives the row, and after them a row for
    // each weakened pair of bodies.
    std::vector<LawRow> linear_pairs;
    std::vector<LawRow> hertz_pairs;
    std::vector<RollingRow> rolling_pairs;
    std::vector<EdgeRow> edge_pairs;
    std::vector<OwnRow> own_pairs;   ///< coefficients that only one law reads; otherwise 0
    std::vector<double> restitution; ///< as mixed

    std::uint32_t add(const Material& material);
    std::uint32_t pair(std::uint32_t a, std::uint32_t b) const {
        return a * static_cast<std::uint32_t>(list.size()) + b;
    }
    /// Number of rows that belong to pairs of materials.
    std::size_t pairs_of_materials() const { return list.size() * list.size(); }
    const std::vector<LawRow>& pairs(LawName law) const { return traits(law).rows(*this); }
    /// Replaces the weakened pairs; the k-th gets the row pairs_of_materials() + k. Derived: not
    /// saved, and forgotten when the materials are loaded.
    void weaken(std::vector<WeakenedPair> pairs);
    const std::vector<WeakenedPair>& weakened() const { return weakened_; }
    /// Sets the properties of one pair, in both orders, and discards those set before.
    void set_pair(std::uint32_t a, std::uint32_t b, const PairProperties& properties);
    /// Sets the coefficients that only `law` reads (LawTraits::of_pairs, in that order) for one
    /// pair, in both orders, and discards those set for the pair before.
    void set_own(LawName law, std::uint32_t a, std::uint32_t b, const OwnCoefficients& values);
    /// The coefficients as set; zeros if none were set for this law.
    OwnCoefficients own(LawName law, std::uint32_t a, std::uint32_t b) const;
    /// Recomputes the tables of pairs; to be called after any change of `list` or `policy`.
    void mix();
    void save(Archive& archive) const;
    void load(const Archive& archive);

private:
    struct Override {
        std::uint32_t a, b;
        PairProperties properties;
    };
    struct Own {
        LawName law;
        std::uint32_t a, b;
        OwnCoefficients values;
        bool is_of(std::uint32_t i, std::uint32_t j) const {
            return (a == i && b == j) || (a == j && b == i);
        }
    };
    void save_own(Archive& archive) const;
    void load_own(const Archive& archive);
    void mix_weakened();

    std::vector<Override> overrides_;
    std::vector<Own> own_;
    std::vector<WeakenedPair> weakened_;
};

/// Ratio of critical damping that gives the restitution e in (0, 1]: -ln e / sqrt(pi^2 + ln^2 e),
/// the same for linear and Hertz contacts (Tsuji, Tanaka and Ishida 1992); 1 for e = 0. For
/// Tension::calibrated the ratio is found by inverting restitution_of. It exists for every e above
/// 0 and approaches 1/(2 sqrt e) for small e; the duration of contacts grows, and the stable step
/// shrinks, in proportion to it (for e = 1e-2 the step is a tenth of the undamped one, for 1e-4 a
/// hundredth). No finite ratio gives e = 0, so the result is infinite.
double damping_ratio(double restitution, Tension tension);

/// Restitution of a contact with a ratio b of critical damping: exp(-pi b / sqrt(1 - b^2)) if the
/// force may be attractive, or the closed form of Schwager and Poeschel (2007) for a force that is
/// cut off at zero.
double restitution_of(double damping_ratio, Tension tension);

} // namespace bris
