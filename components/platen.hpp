#pragma once

#include "components/pressure_aim.hpp"
#include "engine/archive.hpp"

#include <tuple>

namespace bris {

/// The top platen: its plane, and how it is driven.
struct Platen {
    static constexpr auto name = "platen";
    static constexpr bool is_state = true;

    unsigned plane = 0;           ///< row in Planes
    bool controlled = false;      ///< true: pressure is the aim; false: `speed` is given
    double speed = 0;             ///< m/s, downwards
    double target_pressure = 0;   ///< Pa
    PressureAim aim;              ///< on the way to that target, where controlled
    double damping = 0.7;         ///< local, as the membrane's
    double contact_stiffness = 0; ///< N/m, of one grain contact on it
    double largest_step = 0;      ///< m, in a step
    double pressure = 0;          ///< Pa, in the last step
    double stiffness = 0;         ///< N/m, the largest that it has touched: sets its inertia

    static auto fields(auto& self) {
        return std::tie(self.controlled, self.speed, self.target_pressure, self.largest_step,
                        self.pressure, self.damping, self.contact_stiffness, self.stiffness,
                        self.aim.from, self.aim.to, self.aim.left);
    }
    void save(Archive& archive) const { put_fields(archive, "platen/settings", fields(*this)); }
    void load(const Archive& archive) { get_fields(archive, "platen/settings", fields(*this)); }
};

} // namespace bris
