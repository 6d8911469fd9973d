#pragma once

#include "components/material.hpp"
#include "engine/lanes.hpp"

namespace bris {

/// Up to lane_count touching contacts, one a lane: what a law may know of them. Motion is that of
/// the last step, the owner against the partner.
struct ContactLanes {
    Lane nx, ny, nz;       ///< unit normal, from the partner to the owner
    Lane overlap;          ///< m, >= 0; negative, the gap, where a law reaches beyond touch
    Lane inverse_mass;     ///< 1/kg, 1/m of the owner + 1/m of the partner
    Lane radius{};         ///< m, 1 / (1/r of the owner + 1/r of the partner)
    Lane share = lanes(1); ///< of the stiffness of its patch
    Lane ux{}, uy{}, uz{}; ///< m/s, velocity at the contact point; tangential laws
    Lane closing{};        ///< m/s, at which the surfaces approached
    Lane twist{};          ///< rad/s, mean spin about the normal; tangential laws
    Lane vx{}, vy{}, vz{}; ///< m/s, velocity at the contact point now; laws with dashpots
    Lane wx{}, wy{}, wz{}; ///< rad/s, relative spin; rolling laws
};

struct SpringLanes {
    Lane x, y, z, stiffness;
};
struct RollLanes {
    Lane x, y, z, twist;
};
struct WorkLanes {
    Lane friction{}, viscous{}, rolling{};
};

/// What a law gives: force on the owner, its normal part, rolling torque on the owner, work taken.
struct ForceLanes {
    Lane x, y, z, normal;
    Lane torque_x{}, torque_y{}, torque_z{};
    WorkLanes work;
};

/// Coefficients of LawRow and RollingRow, one a lane.
struct CoefficientLanes {
    Lane kn, ks, friction, normal_rate, shear_rate, normal_ratio, shear_ratio;
};
/// Coefficients of OwnRow, one contact a lane.
struct OwnLanes {
    std::array<Lane, most_own_coefficients> value;
};
struct RollingLanes {
    Lane rolling_friction, twisting_friction, stiffness_ratio, damping_ratio;
};

/// What all contacts of a step share.
struct LawStep {
    double dt;          ///< s
    double least_force; ///< N, of the normal force: 0 where tension is cut
    double least_ratio,
        largest_ratio;    ///< of spring stretch kept when the stiffness changes (ShearHistory)
    bool shared;          ///< patches share one stiffness: that of a contact changes
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
