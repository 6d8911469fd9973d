#pragma once

#include "engine/lanes.hpp"

namespace bris {

/// Up to lane_count touching contacts, one a lane: what a law may know of them.
struct ContactLanes {
    Lane nx, ny, nz;      ///< unit normal, from the partner to the owner
    Lane overlap;         ///< m, >= 0
    Lane ux, uy, uz;      ///< m/s, velocity of the owner against the partner at the contact point
    Lane twist;           ///< rad/s, mean spin about the normal
    Lane inverse_mass;    ///< 1/kg, 1/m of the owner + 1/m of the partner
};

struct SpringLanes { Lane x, y, z; };
struct ForceLanes  { Lane x, y, z, normal, slip_work; };

/// Coefficients of LawRow, one a lane.
struct CoefficientLanes { Lane kn, ks, friction, normal_damping, shear_damping; };

/// The named laws, a closed list: systems/contact/laws/*.hpp has the pieces.
enum class LawName {
    linear,             ///< linear springs, Coulomb friction with history
    linear_frictionless,///< linear normal spring alone
    linear_viscous      ///< linear springs, Coulomb friction, dashpots of rate x reduced mass
};

} // namespace bris
