#pragma once

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
    double gain = 0.3;            ///< as the membrane's
    double contact_stiffness = 0; ///< N/m, of one grain contact on it
    double largest_step = 0;      ///< m, in a step
    double pressure = 0;          ///< Pa, in the last step

    static auto fields(auto& self) {
        return std::tie(self.controlled, self.speed, self.target_pressure, self.largest_step, self.pressure, self.gain, self.contact_stiffness);
    }
    void save(Archive& archive) const { put_fields(archive, "platen/settings", fields(*this)); }
    void load(const Archive& archive) { get_fields(archive, "platen/settings", fields(*this)); }
};

} // namespace bris
