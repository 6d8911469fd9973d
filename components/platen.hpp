#pragma once

#include "components/load_ramp.hpp"
#include "components/pressure_aim.hpp"
#include "engine/archive.hpp"

#include <cstdint>
#include <tuple>

namespace bris {

/// The top platen: its plane and its control.
struct Platen {
    static constexpr auto name = "platen";
    static constexpr bool is_state = true;

    unsigned plane = 0;           ///< row in Planes
    bool controlled = false;      ///< true: pressure control; false: moves at the given `speed`
    double speed = 0;             ///< m/s, downwards
    double target_pressure = 0;   ///< Pa
    PressureAim aim;              ///< under pressure control: set point on the ramp to that target
    LoadRamp axial_load;          ///< beyond that pressure, in a cyclic test
    double damping = 0.7;         ///< local damping, as that of the membrane
    double contact_stiffness = 0; ///< N/m, of one grain contact on the platen
    double largest_step = 0;      ///< m, largest displacement in a step
    double area = 0;              ///< m2, mean area inside the membrane in the last step
    double pull = 0;              ///< N, downwards, of a sleeve that is clamped at the platen
    double pressure = 0;          ///< Pa, in the last step
    double wanted = 0;            ///< Pa, set point in the last step, while it is controlled
    std::int64_t contacts = 0;    ///< grains that touch it, while it is controlled
    /// N/m, largest sum of contact stiffnesses on the platen so far. It sets the platen's inertia.
    double stiffness = 0;

    static auto fields(auto& self) {
        return std::tie(self.controlled, self.speed, self.target_pressure, self.largest_step,
                        self.pressure, self.damping, self.contact_stiffness, self.stiffness,
                        self.aim.from, self.aim.to, self.aim.left);
    }
    void save(Archive& archive) const {
        put_fields(archive, "platen/settings", fields(*this));
        if (axial_load.duration > 0)
            put_fields(archive, "platen/load", LoadRamp::fields(axial_load));
    }
    void load(const Archive& archive) {
        get_fields(archive, "platen/settings", fields(*this));
        axial_load = {};
        if (archive.find("platen/load") != nullptr)
            get_fields(archive, "platen/load", LoadRamp::fields(axial_load));
    }
};

} // namespace bris
