#pragma once

#include "components/material.hpp"
#include "engine/lanes.hpp"

namespace bris {

/// Input of a law: up to lane_count touching contacts, one per lane. Velocities are those of the
/// owner relative to the partner in the last step.
struct ContactLanes {
    Lane nx, ny, nz;       ///< unit normal, from the partner to the owner
    Lane overlap;          ///< m, >= 0; for laws with reach also negative: minus the gap
    Lane inverse_mass;     ///< 1/kg, 1/m of the owner + 1/m of the partner
    Lane radius{};         ///< m, 1 / (1/r of the owner + 1/r of the partner)
    Lane share = lanes(1); ///< share of the stiffness of the contact's patch
    Lane ux{}, uy{}, uz{}; ///< m/s, velocity at the contact point; tangential laws
    Lane closing{};        ///< m/s, speed of approach of the surfaces
    Lane twist{};          ///< rad/s, mean angular velocity about the normal; tangential laws
    Lane vx{}, vy{}, vz{}; ///< m/s, predicted present velocity there; laws with dashpots
    Lane wx{}, wy{}, wz{}; ///< rad/s, relative angular velocity; rolling laws
};

struct SpringLanes {
    Lane x, y, z, stiffness;
};
struct RollLanes {
    Lane x, y, z, twist;
};
struct WorkLanes {
    Lane friction{}, viscous{}, rolling{}, wear{};
};

/// Output of a law: force on the owner, its normal component, rolling torque on the owner, and the
/// work that the contact dissipates in the step.
struct ForceLanes {
    Lane x, y, z, normal;
    Lane torque_x{}, torque_y{}, torque_z{};
    WorkLanes work;
};

/// Coefficients of EdgeRow, one contact per lane.
struct EdgeLanes {
    Lane yield_ratio{}, blunting{}, radius{}, rise{}, easing_pressure{}, easing_force{}, arm{},
        couple_easing{};
};
/// Coefficients of LawRow, one contact per lane.
struct CoefficientLanes {
    Lane kn, ks, friction, normal_rate, shear_rate, normal_ratio, shear_ratio;
    EdgeLanes edges{}; ///< laws with edges
};
/// Coefficients of OwnRow, one contact per lane.
struct OwnLanes {
    std::array<Lane, most_own_coefficients> value;
};
/// Coefficients of RollingRow, one contact per lane.
struct RollingLanes {
    Lane rolling_friction, twisting_friction, stiffness_ratio, damping_ratio;
};

/// Settings that all contacts of a step share.
struct LawStep {
    double dt;          ///< s
    double least_force; ///< N, lower limit of the normal force: 0 where tension is cut
    /// Limits of the ratio of spring stretch kept when the stiffness changes (ShearHistory).
    double least_ratio, largest_ratio;
    bool shared;          ///< patches share one stiffness, so that of a contact changes
    bool accumulate_work; ///< the energy budget needs the work

    LawStep(const ContactPolicy& policy, double step, bool energy_budget);
};

/// Elastic normal force and the tangent stiffnesses, N and N/m.
struct StiffnessLanes {
    Lane force, normal, shear;
};

/// Damping coefficients, N s/m.
struct DashpotLanes {
    Lane normal{}, shear{};
};

} // namespace bris
