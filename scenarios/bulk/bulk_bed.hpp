#pragma once

#include "engine/archive.hpp"
#include "engine/options.hpp"
#include "engine/progress.hpp"
#include "engine/simulation.hpp"

#include <string>
#include <tuple>

namespace bris {

// Beds of the bulk cases of Dosta et al. (2024), Comput. Phys. Commun. 296:109066: their materials,
// and a procedure that brings a bed to rest, since the initial states of the paper are not
// available.

/// Indices of the materials in a scene.
struct BulkMaterials {
    std::uint32_t m1 = 0, m2 = 1, steel = 2;
};

/// Adds M1 (1 GPa, 2500 kg/m3), M2 (0.5 GPa, 2000) and steel (210 GPa, 7200), Poisson's ratio 0.2,
/// with the restitution and friction that the paper gives for each pair.
BulkMaterials add_bulk_materials(World& world);

/// Factors and limits on the contact properties.
struct BulkContacts {
    double stiffness = 1;        ///< factor on Young's moduli
    double friction = 1;         ///< factor on the friction coefficients of the pairs
    double most_restitution = 1; ///< upper limit of the coefficients of restitution
};
void set_bulk_contacts(World& world, const BulkContacts& contacts);

enum class BedPhase : std::uint32_t {
    pour,   ///< soft grains fall from a perturbed lattice until they hardly move
    harden, ///< stiffness rises stage by stage, slowly enough for the bed as a whole to follow
    rest,   ///< contacts have the properties of the run, until the bed is at rest
    ready   ///< the run has begun or may begin
};

/// How far the making of a bed has come; State, so that it resumes from a checkpoint.
struct BedState {
    static constexpr auto name = "bed";
    static constexpr bool is_state = true;
    BedPhase phase = BedPhase::pour;
    unsigned stage = 0;       ///< of hardening
    double phase_began = 0;   ///< s
    double kinetic_ratio = 0; ///< at the last check, see BedSettings
    double unbalanced_ratio = 1;
    double coordination = 0;
    std::uint64_t steps = 0; ///< taken until the bed was ready
    double time = 0;         ///< s, at which the bed was ready

    void save(Archive& archive) const;
    void load(const Archive& archive);
};

struct BedSettings {
    double step = 0;             ///< s, time step of the run
    double stiffness = 1;        ///< factor on Young's moduli, in the run
    double friction = 1;         ///< factor on the friction coefficients of the pairs, in the run
    double fill_friction = 1;    ///< the same while the bed is poured and hardened
    double softness = 0.01;      ///< fraction of the true Young's moduli while pouring; (0, 1]
    double least_pour = 0.1;     ///< s
    double longest_pour = 1.5;   ///< s
    unsigned harden_steps = 300; ///< of a stage, in which stiffness rises by a tenth
    double longest_rest = 0.15;  ///< s
    /// Kinetic energy over weight times mean radius, summed over grains, below which a bed rests.
    double kinetic_ratio = 1e-5;
    /// Mean unbalanced force over mean force below which a bed rests.
    double unbalanced_ratio = 0.02;

    void declare_options(auto& option);
};

/// Makes the bed in a simulation whose World holds a BedState and grains on a lattice.
class BedMaker {
public:
    BedMaker(Simulation& simulation, const BedSettings& settings);
    /// Runs one block of steps; returns false when the bed is ready.
    bool advance();
    PhaseProgress progress() const;
    /// Whether the bed was at rest, as the settings define it, at the last check. A bed that took
    /// too long is used as it is.
    bool at_rest() const;
    /// Sets the contact properties to those of the present phase.
    void apply_phase();

private:
    BedState& state();
    const BedState& state() const;
    void enter(BedPhase phase, unsigned stage);
    double stage_stiffness() const;
    void check_state();

    Simulation& simulation_;
    BedSettings settings_;
};

/// Begins the run: sets the time to 0 and the time step to `step` (s).
void start_clock(World& world, double step);

void BedSettings::declare_options(auto& option) {
    option("stiffness_factor", stiffness, "",
           "Factor on all Young's moduli; 1: those of the paper.", above(0, 1));
    option("friction_factor", friction, "",
           "Factor on all friction coefficients; 0 is the negative control.", within(0, 10));
    option("fill_friction_factor", fill_friction, "",
           "Factor on all friction coefficients while the bed is made; a larger factor gives a "
           "looser bed.",
           within(0, 100));
    option("fill_softness", softness, "",
           "Factor on all Young's moduli of the paper while the bed is poured.", within(1e-4, 1));
    option("longest_rest", longest_rest, "s",
           "Longest time that the bed is given to come to rest with the contact properties of the "
           "run.",
           within(0, 1e6));
    option("rest_kinetic_ratio", kinetic_ratio, "",
           "Ratio of kinetic energy to weight times mean radius below which a bed is at rest.",
           above(0, 1e6));
    option("rest_unbalanced_ratio", unbalanced_ratio, "",
           "Ratio of mean unbalanced force to mean force below which a bed is at rest.",
           above(0, 1e6));
}

} // namespace bris
