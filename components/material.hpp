#pragma once

#include "components/law.hpp"
#include "engine/archive.hpp"
#include "engine/math.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace bris {

/// What a body is made of. A contact takes what its law reads: stiffnesses (linear laws) or elastic
/// constants (Hertz), friction, restitution or rates, rolling and twisting friction (rolling laws).
struct Material {
    std::string name;
    double density = 0;          ///< kg/m3, > 0 for free bodies
    double normal_stiffness = 0; ///< N/m, > 0: linear laws; two partners act in series
    double shear_stiffness = 0;  ///< N/m, >= 0: linear laws
    double friction = 0;         ///< Coulomb coefficient, >= 0; a pair has the lower one
    double normal_damping =
        0; ///< 1/s times the reduced mass, >= 0, besides that of restitution; a pair has the mean
    double shear_damping = 0; ///< 1/s times the reduced mass, >= 0, likewise
    double restitution = 1; ///< of a normal impact, in [0, 1], 0 excluded where calibrated; a pair
                            ///< has the geometric mean
    double young_modulus = 0; ///< Pa, > 0: Hertz
    double poisson_ratio = 0; ///< in (-1, 0.5]: Hertz, Mindlin
    double rolling_friction =
        0; ///< torque limit over radius and normal force, >= 0; a pair has the lower one
    double twisting_friction = 0; ///< likewise, about the normal
};

/// What replaces the mixing rules for one pair of materials.
struct PairProperties {
    std::optional<double> friction = {}, restitution = {}, rolling_friction = {},
                          twisting_friction = {};
};

/// The law of a scene's contacts; set when its lists are added.
struct ContactLaw {
    static constexpr auto name = "contact_law";
    LawName law = LawName::linear;
};

/// Whether a dashpot may pull at the end of a contact, and what that does to restitution.
enum class Tension : std::uint32_t {
    allowed, ///< it may: restitution is exactly the one asked for
    cut, ///< the normal force ends at zero, with the same dashpot: restitution is higher than asked
         ///< for
    calibrated ///< the normal force ends at zero, with a stronger dashpot: restitution as asked for
};

/// How the tangential spring of Mindlin follows a stiffness that changes with the normal force.
enum class ShearHistory : std::uint32_t {
    rescaled,    ///< its force shrinks with the stiffness, and does not grow with it: never gives
                 ///< energy
    incremental, ///< its force changes by stiffness times displacement only
    total        ///< its force is stiffness times stretch
};

/// What the spheres of one clump that touch the same partner, a patch, oppose to it.
enum class PatchStiffness : std::uint32_t {
    per_sphere, ///< each its whole stiffness: a patch is the stiffer, the more spheres it has
    shared ///< each its share by overlap of one stiffness: the same however many spheres stand for
           ///< the surface
};

/// Choices that all contacts of a scene share.
struct ContactPolicy {
    Tension tension = Tension::allowed;
    ShearHistory shear_history = ShearHistory::rescaled;
    PatchStiffness patch = PatchStiffness::per_sphere; ///< spheres against spheres and planes
    bool shear_dashpot =
        false; ///< restitution damps the tangential spring too, by the same ratio of critical
    double rolling_stiffness_ratio =
        1; ///< rolling spring over tangential spring (both at the surface), > 0
    double rolling_damping_ratio = 0; ///< of critical, while the rolling spring sticks, >= 0
};

/// Coefficients of one pair of materials, as the contact kernels read them. Linear laws: kn, ks are
/// N/m. Hertz: kn is E*, ks is 4 G* (Pa), so that the tangent stiffnesses are 2 kn a and 2 ks a at
/// contact radius a.
struct alignas(64) LawRow {
    double kn, ks, friction;
    double normal_rate, shear_rate;   ///< 1/s, times reduced mass
    double normal_ratio, shear_ratio; ///< times the root of normal tangent stiffness and reduced
                                      ///< mass; no shear without normal
    double unused;
};
struct alignas(32) RollingRow {
    double rolling_friction, twisting_friction, stiffness_ratio, damping_ratio;
};

/// The materials of a scene and the table of their pairs. Coefficients may
/// change between phases, so they are State.
struct Materials {
    static constexpr auto name = "materials";
    static constexpr bool is_state = true;

    std::vector<Material> list;
    ContactPolicy policy;
    std::vector<LawRow> linear_pairs; ///< list.size() squared
    std::vector<LawRow> hertz_pairs;  ///< likewise
    std::vector<RollingRow> rolling_pairs;
    std::vector<OwnRow> own_pairs;   ///< likewise, of laws with coefficients of their own; else 0
    std::vector<double> restitution; ///< of each pair, as mixed

    std::uint32_t add(const Material& material);
    std::uint32_t pair(std::uint32_t a, std::uint32_t b) const {
        return a * static_cast<std::uint32_t>(list.size()) + b;
    }
    const std::vector<LawRow>& pairs(LawName law) const { return traits(law).rows(*this); }
    /// Sets properties of one pair, in both orders; what was set for it before is gone.
    void set_pair(std::uint32_t a, std::uint32_t b, const PairProperties& properties);
    /// Sets the coefficients that only `law` reads for one pair, in both orders, as its file lists
    /// them (LawTraits::of_pairs); what was set for the pair before is gone.
    void set_own(LawName law, std::uint32_t a, std::uint32_t b, const OwnCoefficients& values);
    /// As set; zeros if nothing was set for this law.
    OwnCoefficients own(LawName law, std::uint32_t a, std::uint32_t b) const;
    /// Recomputes the tables of pairs; after any change of `list` or `policy`.
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

    std::vector<Override> overrides_;
    std::vector<Own> own_;
};

/// Ratio of critical damping that gives a restitution in (0, 1]: -ln e / sqrt(pi^2 + ln^2 e), the
/// same for linear and Hertz contacts (Tsuji, Tanaka and Ishida 1992); 1 for 0. Tension::calibrated
/// solves restitution_of for it: any restitution above 0, by 1/(2 sqrt e) where it is small, with
/// which contacts last as much longer and the stable step is as much shorter (1e-2: a tenth of the
/// undamped one, 1e-4: a hundredth); 0 by no dashpot: infinite.
double damping_ratio(double restitution, Tension tension);

/// Restitution of a contact damped by a ratio of critical: exp(-pi b / sqrt(1 - b^2)) if the force
/// may pull, or the closed form of Schwager and Poeschel (2007) for a force that ends at zero.
double restitution_of(double damping_ratio, Tension tension);

} // namespace bris
