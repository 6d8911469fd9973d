#pragma once

#include "components/body.hpp"
#include "engine/archive.hpp"

#include <algorithm>
#include <tuple>

namespace bris {

/// Fouling of the voids around a body.
struct LocalFouling {
    double contaminant = 0; ///< void contaminant index VCI as a fraction, >= 0
    double saturation = 0;  ///< share of the voids left by the fines that water fills, in [0, 1]
};
/// Of bodies of a scene with fines.
struct FoulingAround : State<LocalFouling> {
    static constexpr auto name = "fouling", unit = "";
};
/// Pose of the body when the fields were last brought up to date.
struct SampledPose : State<Pose> {
    static constexpr auto name = "sampled_pose", unit = "m";
};

/// How fines in the voids weaken contacts: with the void contaminant index VCI (a fraction), the
/// saturation s and g = VCI / (VCI + half_effect), friction is multiplied by
/// (1 - friction_loss g) (1 - moisture_loss g s), and normal and tangential stiffness by
/// 1 - stiffness_loss g, and divided by 1 + c g, where c goes from dry_cushion to wet_cushion with
/// s: a film of fines between the rocks, in series with their contact. Moisture therefore acts only
/// where there are fines. The form is an assumption, and the default losses are not fitted to any
/// test.
struct FoulingLaw {
    static constexpr auto name = "fouling_law";
    static constexpr bool is_state = true;
    double friction_loss = 0.4;  ///< in [0, 1)
    double moisture_loss = 0.3;  ///< in [0, 1)
    double stiffness_loss = 0.5; ///< in [0, 1)
    double half_effect = 0.5;    ///< VCI at which g = 1/2, > 0
    /// Friction does not fall below this, or below that without fines if that is lower.
    double least_friction = 0.3;
    double least_stiffness = 1.0 / 3; ///< lower limit of 1 - stiffness_loss g, in (0, 1]
    /// Stiffness of a contact over that of the film of fines in it, >= 0.
    double dry_cushion = 0, wet_cushion = 0;

    double effect(double contaminant) const { return contaminant / (contaminant + half_effect); }
    double friction_factor(const LocalFouling& at) const {
        const double g = effect(at.contaminant);
        return (1 - friction_loss * g) * (1 - moisture_loss * g * at.saturation);
    }
    double stiffness_factor(const LocalFouling& at) const {
        const double g = effect(at.contaminant),
                     cushion = dry_cushion + (wet_cushion - dry_cushion) * at.saturation;
        return std::max(1 - stiffness_loss * g, least_stiffness) / (1 + cushion * g);
    }

    static auto fields(auto& self) {
        return std::tie(self.friction_loss, self.moisture_loss, self.stiffness_loss,
                        self.half_effect, self.least_friction, self.least_stiffness,
                        self.dry_cushion, self.wet_cushion);
    }
    void save(Archive& archive) const { put_fields(archive, "fields/law", fields(*this)); }
    void load(const Archive& archive) { get_fields(archive, "fields/law", fields(*this)); }
};

} // namespace bris
