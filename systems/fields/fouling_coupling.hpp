#pragma once

#include "components/kinds.hpp"
#include "engine/system.hpp"
#include "systems/fields/contact_factors.hpp"
#include "systems/fields/fouling.hpp"

namespace bris {

/// How fines and water act on contacts (CoupledField, coupled_fields.hpp).
struct FoulingCoupling {
    using Field = Fouling;
    static constexpr auto saved_as = "fields/settings";
    static void add(World& world) { add_fouling(world, {}); }
    static StepList systems() {
        return {when(fouling_is_due, system("update_fouling", update_fouling))};
    }
    static bool is_due(const World& world) { return fouling_is_due(world); }

    /// Two rocks have the mean of what surrounds them; at a boundary only the rock counts.
    class Factors {
    public:
        explicit Factors(const World& world)
            : law_(world.resource<FoulingLaw>()), around_(world.column<Bodies, FoulingAround>()) {}
        ContactFactors of(Row a, Row b, bool between_rocks) const {
            LocalFouling at = around_[a];
            if (between_rocks)
                at = {0.5 * (at.contaminant + around_[b].contaminant),
                      0.5 * (at.saturation + around_[b].saturation)};
            return {law_.friction_factor(at), law_.least_friction, law_.stiffness_factor(at)};
        }

    private:
        const FoulingLaw& law_;
        std::span<const LocalFouling> around_;
    };
};

} // namespace bris
