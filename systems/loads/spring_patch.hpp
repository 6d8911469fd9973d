#pragma once

#include "systems/loads/element.hpp"

#include <algorithm>
#include <cstdint>

namespace bris {

/// A spring and a dashpot along an axis fixed in space, between a point of a body and the ground: a
/// patch of the subgrade, a rail pad, a guide or a stop.
struct SpringPatch {
    Vec3 point = Vec3::Zero();  ///< m, in the axes of the body
    Vec3 anchor = Vec3::Zero(); ///< m, where the point is while the spring is unloaded
    Vec3 axis = Vec3::UnitZ();  ///< unit vector
    double stiffness = 0;       ///< N/m
    double damping = 0;         ///< N s/m
    /// True: a support that pushes along the axis and never pulls.
    bool one_sided = false;

    /// m, along the axis, of the point when it is at `x`; negative: the spring is pressed.
    double displacement(const Vec3& x) const { return (x - anchor).dot(axis); }
    /// Force (N) along the axis on the body; `speed`: m/s, of the point along the axis.
    double force(double displaced, double speed) const {
        const double f = -(stiffness * displaced + damping * speed);
        if (!one_sided) return f;
        return displaced < 0 ? std::max(f, 0.0) : 0;
    }
    /// Elastic energy, J.
    double energy(double displaced) const {
        return one_sided && displaced >= 0 ? 0 : 0.5 * stiffness * displaced * displaced;
    }

    static auto fields(auto& self) {
        return std::tie(self.point, self.anchor, self.axis, self.stiffness, self.damping,
                        self.one_sided);
    }
};

/// 1 + index in SpringPatches::of_body; 0: none.
struct PatchesOf : State<std::uint32_t> {
    static constexpr auto name = "patches", unit = "";
};
/// Sum of the forces of patches on a body in this step.
struct PatchForce : Derived<Wrench> {
    static constexpr auto name = "patch_force", unit = "N, N m";
};
/// Energy dissipated by the dashpots of the body's patches.
struct PatchWork : State<double> {
    static constexpr auto name = "patch_work", unit = "J";
};

/// The springs and dashpots between bodies and the ground.
struct SpringPatches : ElementLists<SpringPatch>, ElementDefaults {
    static constexpr auto name = "spring_patches", plural = "spring-dashpot patches";
    static constexpr bool is_state = true;
    void save(Archive& archive) const { save_elements(archive, "spring_patches", of_body); }
    void load(const Archive& archive) { load_elements(archive, "spring_patches", of_body); }

    using Acting = PatchForce;
    using Loss = PatchWork;
    static StepList force_systems();
    static StepList work_systems();
    static double energy(const World& world);
    static void add_springs(const World& world, std::vector<BodySpring>& springs);
};

/// Adds a spring and a dashpot between a free body in a scene of clumps and the ground. Throws
/// InputError.
void add_patch(World& world, EntityId body, const SpringPatch& patch);
/// Adds a patch that holds a point of a body (m, in its axes, which must be those of the world)
/// where it is now, along an axis.
void add_guide(World& world, EntityId body, const Vec3& point, const Vec3& axis, double stiffness,
               double damping);

/// Elastic energy (J) of the springs between a body and the ground, at its present position.
double patch_energy(const World& world, Row body);

} // namespace bris
