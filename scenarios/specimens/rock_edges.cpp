#include "scenarios/specimens/rock_edges.hpp"

#include "engine/errors.hpp"

#include <fmt/format.h>

namespace bris {

bool RockEdges::are_given() const {
    return contact_strength > 0 || friction_rise > 0 || couple_arm > 0;
}

void RockEdges::give_to(Material& rock) const {
    rock.contact_strength = contact_strength;
    rock.cone_half_angle = cone_half_angle;
    rock.edge_radius = edge_radius;
    rock.friction_rise = friction_rise;
    rock.friction_half_pressure = friction_half_pressure;
    rock.friction_half_force = friction_half_force;
    rock.couple_arm = couple_arm;
    rock.couple_force = couple_force;
    rock.rolling_friction = rock.twisting_friction =
        1; // the arm alone says how large the couple is
}

void require_edges_are_read(const RockEdges& edges, LawName law) {
    require(!edges.are_given() || traits(law).edges,
            fmt::format("--law: expected linear_edges or hertz_edges, as --contact-strength, "
                        "--friction-rise or --couple-arm is given, found {}",
                        traits(law).name));
    require(edges.contact_strength == 0 || traits(law).wears,
            fmt::format("--contact-strength: expected --law hertz_edges, as other contacts do not "
                        "yield, found {}",
                        traits(law).name));
}

} // namespace bris
